// bundle.mjs APP - opens an app that has the package, as in app/, in Chromium: as Vite bundles it,
// and as its server for development gives it. A face is tracked, and the monitor says what it saw.

import assert from 'node:assert/strict';
import { build, createServer, preview } from 'vite';
import { launch } from './browser.mjs';

const [root] = process.argv.slice(2);
const host = { host: '127.0.0.1', port: 0 };
const browser = await launch();

/** What the app says in the end, at an address. */
async function seen(url) {
  const page = await browser.newPage();
  const faults = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) faults.push(message.text());
  });
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('response', (response) => {
    if (!response.ok()) faults.push(`${response.url()}: ${response.status()}`);
  });
  await page.goto(url);
  const done = page.waitForFunction(() => globalThis.seen, null, { timeout: 60_000 });
  const value = await done.then((handle) => handle.jsonValue(), (error) => error);
  assert.deepEqual(faults, []);
  await page.close();
  return value;
}

/** Looks at what a server gives. */
async function check(server) {
  const { faces, tracked, version, ...rest } = await seen(server.resolvedUrls.local[0]);
  assert.ok(faces >= 1 && tracked >= 46, `${faces} faces, ${tracked} frames`);
  assert.equal(version[0], version[1]);
  assert.deepEqual(rest, {
    events: ['blink', 'blink'],
    eyes: 'open',
    blinks: 2,
    excluded: 'excluded',
    errors: [
      ['PosewiseError', 'E_TIME', true],
      ['RangeError', undefined, false],
      ['TypeError', undefined, false],
    ],
    here: 'tracking',
    model: 'posewise.posewise',
  });
  await server.close();
}

await build({ root });
await check(await preview({ root, preview: host }));
await check(await (await createServer({ root, server: host })).listen());
await browser.close();
