// report.mjs PAGE.html OUT - opens a page of `posewise-lab report` in Chromium, light and dark and
// on a phone's screen, uses it, and fails where it does not work. In OUT it leaves screenshots.

import assert from 'node:assert/strict';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';

const [file, out] = process.argv.slice(2);
const url = pathToFileURL(resolve(file)).href;

const browser = await launch();

/** Everything that must not happen. */
const faults = [];

/** The page, with what goes wrong in it noted. */
async function open(options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) faults.push(message.text());
  });
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('request', (request) => {
    const isOwn = request.url() === url || request.url().startsWith('data:');
    if (!isOwn) faults.push(`${request.url()} is asked for`);
  });
  await page.goto(url);
  await page.waitForSelector('#ced path.series');
  return page;
}

/** How the page looks, and whether axe finds fault with it. */
async function looks(name, options) {
  const page = await open(options);
  await checkLooks(page, name, out);
  await page.context().close();
}

/** Scrubber, legend, table of one clip, values at the pointer. */
async function controls() {
  const page = await open({ viewport: { width: 1280, height: 900 } });
  const image = () => page.getAttribute('#scrub-picture img', 'src');
  const text = () => page.textContent('#scrub-number');
  const dots = () => page.locator('#scrub-picture circle').count();
  const first = [await image(), await text()];
  assert.equal(await dots(), 2 * 68, 'the landmarks are drawn');
  await page.focus('#scrub-frame');
  await page.keyboard.press('End');
  assert.notEqual(await image(), first[0]);
  assert.notEqual(await text(), first[1]);
  // The last tracker of the test did not find the last frame.
  await page.selectOption('#scrub-system', { index: 1 });
  assert.match(await text(), /not tracked/);
  assert.equal(await dots(), 68, 'the true ones are');

  const paths = () => page.locator('#ced path.series').count();
  assert.equal(await paths(), 2);
  await page.locator('#legend input').nth(1).uncheck();
  assert.equal(await paths(), 1);
  await page.locator('#robustness svg').hover();
  assert.match(await page.textContent('#robustness .tip'), /posewise/);

  await page.click('summary');
  const before = await page.textContent('#by-clip');
  await page.selectOption('#clip', { index: 1 });
  assert.notEqual(await page.textContent('#by-clip'), before);
  assert(await page.locator('#worst-list img').count() >= 2, 'worst frames are shown');
  await page.context().close();
}

await looks('light', { viewport: { width: 1280, height: 900 } });
await looks('dark', { viewport: { width: 1280, height: 900 }, colorScheme: 'dark' });
await looks('phone', { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true,
  deviceScaleFactor: 2, colorScheme: 'dark' });
await controls();
await browser.close();
assert.deepEqual(faults, []);
console.log('the page works');
