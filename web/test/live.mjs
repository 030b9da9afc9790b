// live.mjs POSEWISE CLIP OUT - starts `posewise view CLIP`, watches it in Chromium, and ends it as
// Ctrl-C does. Fails where something is wrong. In OUT it leaves screenshots and live.csv.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';

const [program, clip, out] = process.argv.slice(2);
const PATIENCE_MS = 60_000;

const command = spawn(program, ['view', clip, '--monitor', '--bind', '127.0.0.1:0'], {
  stdio: ['ignore', 'pipe', 'inherit'],
});
const ended = once(command, 'exit');
const [url] = await once(createInterface(command.stdout), 'line');
const browser = await launch();

/** Everything that must not happen. */
const faults = [];

/** A page that counts the tracked frames. */
async function open(options) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) faults.push(message.text());
  });
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('request', (request) => {
    const address = request.url();
    if (!address.startsWith(url) && !address.startsWith('data:')) faults.push(address);
  });
  await page.addInitScript(() => {
    globalThis.seen = 0;
    document.addEventListener('posewise:tracked', ({ detail }) => {
      if (detail.result.state === 'tracking') seen++;
    });
  });
  await page.goto(url);
  return page;
}

/** Waits until so many more frames were tracked. */
async function untilTracked(page, count) {
  const before = await page.evaluate(() => seen);
  await page.waitForFunction((n) => seen >= n, before + count);
}

try {
  const page = await open({ colorScheme: 'light' });
  await untilTracked(page, 60);
  assert.equal(await page.textContent('#status'), 'Face found');
  const isDrawn = await page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return new Set(data).size > 100;
  });
  assert(isDrawn, 'the picture is shown');
  await checkLooks(page, 'live', out);
  const phone = await open({ viewport: { width: 360, height: 740 }, isMobile: true });
  await untilTracked(phone, 10);
  const isWide = await phone.evaluate(() => document.documentElement.scrollWidth > innerWidth);
  assert(!isWide, 'nothing is cut off at the side');
  await phone.screenshot({ path: join(out, 'live-phone.png'), fullPage: true });

  await page.click('#record');
  await untilTracked(page, 10);
  const download = page.waitForEvent('download');
  await page.click('#record');
  await (await download).saveAs(join(out, 'live.csv'));
  assert.deepEqual(faults, []);

  command.kill('SIGINT');
  assert.deepEqual(await ended, [0, null]);
  for (const one of [page, phone]) {
    await one.waitForFunction(() =>
      document.getElementById('status').textContent === 'The command has ended.');
  }
} finally {
  command.kill();
  await browser.close();
}
