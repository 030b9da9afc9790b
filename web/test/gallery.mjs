// gallery.mjs URL OUT.png - six frames of the demo clip as the page shows them: wire, mask and
// make-up, from in front and from the side.

import { writeFileSync } from 'node:fs';
import { launch } from './browser.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, out] = process.argv.slice(2);
/** Side of a frame [px], and angles of yaw of the rows [deg]. */
const SIDE = 240;
const ROWS = [[-4, 4], [28, 40]];
const MODES = ['wire', 'mask', 'make-up'];

const browser = await launch();
try {
  const page = await visits(browser, url).open(url);
  await untilTracked(page, 1);
  await page.uncheck('input[value=axes]');
  await page.evaluate(([side, columns, rows]) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [side * columns, side * rows];
    globalThis.gallery = canvas.getContext('2d');
    gallery.imageSmoothingQuality = 'high';
  }, [SIDE, MODES.length, ROWS.length]);
  for (const [column, mode] of MODES.entries()) {
    await page.check(`input[name=face][value=${mode}]`);
    await untilTracked(page, 5);
    for (const [row, yaws] of ROWS.entries()) {
      await page.evaluate(([column, row, [low, high], side]) => new Promise((resolve) => {
        document.addEventListener('posewise:tracked', function look({ detail }) {
          const { yawDeg, pitchDeg, faceBox: [x, y, width, height], eyeOpen } = detail.result;
          const isWanted = yawDeg > low && yawDeg < high && Math.abs(pitchDeg) < 8
            && Math.min(...eyeOpen) > 0.7;
          if (!isWanted) return;
          document.removeEventListener('posewise:tracked', look);
          const picture = document.getElementById('picture');
          const scale = picture.width / detail.width;
          const shown = 1.7 * Math.max(width, height) * scale;
          const middle = [x + width / 2, y + 0.4 * height].map((v) => v * scale - shown / 2);
          gallery.drawImage(picture, ...middle, shown, shown,
            column * side, row * side, side, side);
          resolve();
        });
      }), [column, row, yaws, SIDE]);
    }
  }
  const png = await page.evaluate(() => gallery.canvas.toDataURL('image/png').split(',')[1]);
  writeFileSync(out, Buffer.from(png, 'base64'));
} finally {
  await browser.close();
}
