// live.mjs POSEWISE CLIP OUT - starts `posewise view CLIP`, watches it in Chromium, and ends it as
// Ctrl-C does. Fails where something is wrong. In OUT it leaves screenshots and live.csv.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';
import { untilTracked, visits } from './visits.mjs';

const [program, clip, out] = process.argv.slice(2);

const command = spawn(program, ['view', clip, '--monitor', '--bind', '127.0.0.1:0'], {
  stdio: ['ignore', 'pipe', 'inherit'],
});
const ended = once(command, 'exit');
const [url] = await once(createInterface(command.stdout), 'line');
const browser = await launch();

const { open, faults } = visits(browser, url);

try {
  const page = await open(url, { colorScheme: 'light' });
  await untilTracked(page, 60);
  assert.equal(await page.textContent('#status'), 'Face found');
  const isDrawn = await page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return new Set(data).size > 100;
  });
  assert(isDrawn, 'the picture is shown');
  await checkLooks(page, 'live', out);
  const phone = await open(url, { viewport: { width: 360, height: 740 }, isMobile: true });
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
