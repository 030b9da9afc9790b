// rates.mjs URL VIDEO - how many frames a second the page shows with each drawing of the dense
// mesh, in Chromium without a graphics processor, of a video with more frames than it can show.

import { launch } from './browser.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, video] = process.argv.slice(2);
const SECONDS = 10;
const browser = await launch();
try {
  const page = await visits(browser, url).open(url);
  await untilTracked(page, 1);
  await page.setInputFiles('#file', video);
  for (const name of ['points', 'mesh', 'axes']) await page.uncheck(`input[value=${name}]`);
  for (const mode of ['none', 'wire', 'mask', 'make-up']) {
    await page.check(`input[name=face][value=${mode}]`);
    await untilTracked(page, 20);
    // In the quickest second: other programs delay most of them.
    const rate = await page.evaluate(async (seconds) => {
      const rates = [];
      while (rates.length < seconds) {
        const [start, before] = [performance.now(), seen.tracked];
        await new Promise((resolve) => setTimeout(resolve, 1000));
        rates.push((1000 * (seen.tracked - before)) / (performance.now() - start));
      }
      return Math.max(...rates);
    }, SECONDS);
    console.log(`${mode}: ${rate.toFixed(0)} frames a second`);
  }
} finally {
  await browser.close();
}
