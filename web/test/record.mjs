// record.mjs URL FOLDER OUT - records takes on the page in Chromium, as a person would, and leaves
// their files in OUT: page.glb, and standalone.glb of the page as one file. URL serves FOLDER.

import assert from 'node:assert/strict';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, folder, out] = process.argv.slice(2);
const browser = await launch();
const { open, faults } = visits(browser, url);

/** Saves the take that was recorded last. */
async function save(page, name) {
  await page.waitForSelector('#save-take:not([disabled])');
  const download = page.waitForEvent('download');
  await page.click('#save-take');
  const file = await download;
  assert.equal(file.suggestedFilename(), 'posewise.glb');
  await file.saveAs(join(out, name));
}

/** Records, by keyboard, until frames were tracked. */
async function record(page, frames) {
  await page.focus('#record-take');
  await page.keyboard.press('Enter');
  await page.waitForSelector('#record-take[aria-pressed=true]');
  await untilTracked(page, frames);
}

try {
  const page = await open(url, { colorScheme: 'dark' });
  await untilTracked(page, 5);
  assert(await page.isDisabled('#save-take'), 'there is nothing to save');
  await record(page, 30);
  assert.match(await page.textContent('#take-time'), /^\d+ s$/);
  await checkLooks(page, 'recording', out);
  await page.keyboard.press('Enter');
  await page.waitForFunction(() =>
    /^\d+\.\d s, \d+ kB$/.test(document.getElementById('take-note').textContent));
  await save(page, 'page.glb');
  await checkLooks(page, 'recorded', out);

  // Another model or another video ends a take, while the face is still known.
  await record(page, 10);
  await page.selectOption('#model', 'research');
  await save(page, 'page.glb');
  await untilTracked(page, 10);
  await record(page, 10);
  await page.click('#use-clip');
  await save(page, 'page.glb');
  await untilTracked(page, 10);

  const standalone = await open(pathToFileURL(join(folder, 'standalone.html')).href);
  await untilTracked(standalone, 5);
  await record(standalone, 10);
  await standalone.click('#record-take');
  await save(standalone, 'standalone.glb');
  assert.deepEqual(faults, []);
} finally {
  await browser.close();
}
