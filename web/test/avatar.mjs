// avatar.mjs URL FOLDER OUT - shows the avatar on the page in Chromium, retargets it, and fails
// where it does not follow the face. URL serves FOLDER. In OUT it leaves screenshots.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, folder, out] = process.argv.slice(2);
const browser = await launch();
const { open, faults } = visits(browser, url);

/** Shows the avatar, and waits until the tracker that has a gaze follows the face. */
async function show(page) {
  await untilTracked(page, 3);
  await page.check('#show-avatar');
  await page.waitForSelector('#avatar-picture:not([hidden])');
  await page.waitForFunction(() => seen.last.result.gazeStatus.some((s) => s !== 'not-seen'));
  await untilTracked(page, 5);
}

/** The share of the canvas that the avatar covers. */
function drawn(page) {
  return page.evaluate(() => {
    const canvas = document.getElementById('avatar-picture');
    const { width, height } = canvas;
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    let covered = 0;
    for (let i = 3; i < data.length; i += 4) covered += Number(data[i] > 0);
    return covered / (width * height);
  });
}

/** Gives the page a retargeting file. */
async function retarget(page, file, name = 'a.json') {
  const buffer = Buffer.from(typeof file === 'string' ? file : JSON.stringify(file));
  await page.setInputFiles('#retargeting', { name, mimeType: 'application/json', buffer });
}

const says = (page, text) => page.waitForFunction((text) =>
  document.getElementById('avatar-note').textContent === text, text);

/** The head of the file, without a tracker: what each shape moves, and how. */
async function shapes() {
  const page = await open(url);
  const found = await page.evaluate(async () => {
    const { AvatarHead } = await import('/demo/avatar/head.js');
    const { AVATAR_SHAPES } = await import('/demo/avatar/retargeting.js');
    const bytes = await (await fetch('/demo/avatar/head.bin')).arrayBuffer();
    const head = new AvatarHead(bytes);
    const ahead = [0, 0, 0, 1];
    const posed = (weights, rotation = ahead) => {
      const all = Object.fromEntries(AVATAR_SHAPES.map((name) => [name, weights[name] ?? 0]));
      head.pose(all, rotation);
      return head.places.slice();
    };
    const neutral = posed({});
    const moved = Object.fromEntries(AVATAR_SHAPES.map((name) => {
      const places = posed({ [name]: 1 });
      let [most, by, at] = [0, [0, 0, 0], [0, 0, 0]];
      for (let v = 0; v < places.length; v += 3) {
        const d = [0, 1, 2].map((i) => places[v + i] - neutral[v + i]);
        if (Math.hypot(...d) > most) {
          [most, by, at] = [Math.hypot(...d), d, [...neutral.slice(v, v + 3)]];
        }
      }
      return [name, { most, by, at }];
    }));
    // To the image right by half a turn's sixth: the nose, nearest to the camera, goes there.
    const nose = (places) => {
      let least = 0;
      for (let v = 0; v < places.length; v += 3) if (places[v + 2] < places[least + 2]) least = v;
      return places[least];
    };
    const turned = nose(posed({}, [0, -Math.sin(0.25), 0, Math.cos(0.25)]));
    return { moved, turned, bytes: bytes.byteLength, corners: head.corners.length };
  });
  assert(found.bytes < 150 * 1024, `${found.bytes} bytes`);
  assert(found.turned > 20, `the nose is at ${found.turned} mm`);
  const { moved } = found;
  for (const [name, { most }] of Object.entries(moved)) {
    assert(name === 'tongueOut' ? most === 0 : most > 1 && most < 45, `${name}: ${most} mm`);
  }
  // The person's left is at +x, and y is down.
  const left = ['eyeBlinkLeft', 'mouthSmileLeft', 'browOuterUpLeft', 'cheekSquintLeft'];
  for (const name of left) {
    assert(moved[name].at[0] > 0, name);
    assert(moved[name.replace('Left', 'Right')].at[0] < 0, name);
  }
  assert(moved.jawOpen.by[1] > 15 && moved.browInnerUp.by[1] < -1);
  assert(moved.mouthLeft.by[0] > 5 && moved.mouthRight.by[0] < -5 && moved.jawLeft.by[0] > 2);
  await page.context().close();
}

/** Nothing of it is loaded before; then it follows, is retargeted, and goes away again. */
async function follows() {
  const page = await open(url, { colorScheme: 'light', viewport: { width: 1280, height: 900 } });
  await untilTracked(page, 5);
  const loaded = () => page.evaluate(() => performance.getEntriesByType('resource')
    .filter(({ name }) => name.includes('/avatar/')).length);
  assert.equal(await loaded(), 0, 'nothing is loaded before it is wanted');
  await show(page);
  assert.equal(await loaded(), 5);
  const covered = await drawn(page);
  assert(covered > 0.2 && covered < 0.75, `${covered} of the canvas`);
  await checkLooks(page, 'avatar', out);

  // One frame, at which another file shows another face.
  await page.click('#pause');
  await page.waitForTimeout(400);
  const before = await page.locator('#avatar-picture').screenshot();
  await retarget(page, { shapes: { jawOpen: { offset: 1, from: { jawOpen: 1 } } } });
  await says(page, 'Weights are those of a.json.');
  await page.waitForTimeout(200);
  const open_ = await page.locator('#avatar-picture').screenshot({ path: join(out, 'jaw.png') });
  assert.notDeepEqual(open_, before);
  await retarget(page, { shapes: { jawOpn: {} } }, 'b.json');
  await says(page, 'b.json: shapes.jawOpn: ARKit has no such shape');
  assert(await page.locator('#avatar-note.error').count() === 1);
  const after = await page.locator('#avatar-picture').screenshot();
  assert.deepEqual(after, open_, 'the one before stays');

  const download = page.waitForEvent('download');
  await page.click('#retargeting-template');
  const file = await download;
  assert.equal(file.suggestedFilename(), 'retargeting.json');
  const saved = join(out, 'retargeting.json');
  await file.saveAs(saved);
  assert.equal(JSON.parse(readFileSync(saved, 'utf8')).shapes.jawOpen.offset, 1);
  await page.click('#as-tracked');
  await says(page, 'Weights are as tracked.');
  assert(await page.locator('#avatar-note.error').count() === 0);
  await page.waitForTimeout(200);
  assert.deepEqual(await page.locator('#avatar-picture').screenshot(), before, 'as it was');

  await page.click('#pause');
  await page.uncheck('#show-avatar');
  await page.waitForSelector('#avatar-picture', { state: 'hidden' });
  await untilTracked(page, 5);
  await page.context().close();
}

/** A file that is dropped shows the avatar; on a phone, and of the page as one file. */
async function dropped(address, name, options) {
  const page = await open(address, options);
  await untilTracked(page, 3);
  await page.evaluate(() => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(['{"shapes": {}}'], 'c.json', { type: 'application/json' }));
    document.getElementById('stage').dispatchEvent(new DragEvent('drop', { dataTransfer }));
  });
  await says(page, 'Weights are those of c.json.');
  assert(await page.isChecked('#show-avatar'));
  await untilTracked(page, 5);
  assert(await drawn(page) > 0.2);
  await checkLooks(page, name, out);
  await page.context().close();
}

/** How long a picture of it takes, at least [ms]. */
async function cost() {
  const page = await open(url);
  await show(page);
  const ms = await page.evaluate(async () => {
    const { AvatarHead } = await import('/demo/avatar/head.js');
    const { AvatarCanvas } = await import('/demo/avatar/draw.js');
    const { AVATAR_SHAPES } = await import('/demo/avatar/retargeting.js');
    const bytes = await (await fetch('/demo/avatar/head.bin')).arrayBuffer();
    const head = new AvatarHead(bytes);
    const canvas = new AvatarCanvas(document.createElement('canvas'));
    const weights = Object.fromEntries(AVATAR_SHAPES.map((name) => [name, 0.3]));
    let least = Infinity;
    for (let i = 0; i < 60; i++) {
      const start = performance.now();
      head.pose(weights, [0, 0, 0, 1]);
      canvas.draw(head);
      least = Math.min(least, performance.now() - start);
    }
    return least;
  });
  await page.context().close();
  return ms;
}

try {
  await shapes();
  await follows();
  const phone = { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true };
  await dropped(url, 'avatar-phone', { ...phone, colorScheme: 'dark' });
  await dropped(pathToFileURL(join(folder, 'standalone.html')).href, 'avatar-standalone');
  const ms = await cost();
  assert.deepEqual(faults, []);
  console.log(`a picture of the avatar takes ${ms.toFixed(1)} ms`);
} finally {
  await browser.close();
}
