// avatar-picture.mjs URL OUT.png - frames of the demo clip as the page shows them, and the avatar
// below each.

import { writeFileSync } from 'node:fs';
import { launch } from './browser.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, out] = process.argv.slice(2);
/** Side of a frame [px], and which frames: by what of the result. */
const SIDE = 240;
const FRAMES = [
  ({ yawDeg, eyeOpen }) => Math.abs(yawDeg) < 5 && Math.min(...eyeOpen) > 0.7,
  ({ yawDeg }) => yawDeg > 25,
  ({ yawDeg }) => yawDeg < -20,
  ({ eyeOpen }) => Math.max(...eyeOpen) < 0.2,
];

const browser = await launch();
try {
  const page = await visits(browser, url).open(url);
  await untilTracked(page, 1);
  for (const name of ['points', 'mesh', 'axes']) await page.uncheck(`input[value=${name}]`);
  await page.check('#show-avatar');
  await page.waitForSelector('#avatar-picture:not([hidden])');
  await untilTracked(page, 10);
  await page.evaluate(([side, columns]) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [side * columns, side * 2];
    globalThis.gallery = canvas.getContext('2d');
    gallery.fillStyle = '#6b7684';
    gallery.fillRect(0, 0, canvas.width, canvas.height);
    gallery.imageSmoothingQuality = 'high';
  }, [SIDE, FRAMES.length]);
  for (const [column, wanted] of FRAMES.entries()) {
    await page.evaluate(`globalThis.isWanted = ${wanted}`);
    const shown = page.evaluate(([column, side]) => new Promise((resolve) => {
      document.addEventListener('posewise:tracked', function look({ detail }) {
        const { state, faceBox: [x, y, width, height] } = detail.result;
        if (state !== 'tracking' || !isWanted(detail.result)) return;
        document.removeEventListener('posewise:tracked', look);
        const picture = document.getElementById('picture');
        const scale = picture.width / detail.width;
        const across = 1.8 * Math.max(width, height) * scale;
        const [left, top] = [x + width / 2, y + 0.4 * height].map((v) => v * scale - across / 2);
        gallery.drawImage(picture, left, top, across, across, column * side, 0, side, side);
        // The avatar follows at once.
        queueMicrotask(() => {
          const avatar = document.getElementById('avatar-picture');
          gallery.drawImage(avatar, column * side, side, side, side);
          resolve();
        });
      });
    }), [column, SIDE]);
    const late = new Promise((resolve) => setTimeout(resolve, 20_000, 'late'));
    if (await Promise.race([shown, late]) === 'late') console.log(`no frame ${column}`);
  }
  const png = await page.evaluate(() => gallery.canvas.toDataURL('image/png').split(',')[1]);
  writeFileSync(out, Buffer.from(png, 'base64'));
} finally {
  await browser.close();
}
