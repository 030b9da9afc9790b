// face.mjs URL FOLDER OUT - draws the dense mesh on the page in Chromium in each way, and fails
// where something else is drawn than the face. URL serves FOLDER. In OUT it leaves screenshots and
// the template.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, folder, out] = process.argv.slice(2);
// WebGL without a graphics processor, to compare what it draws with what the page draws.
const browser = await launch('--enable-unsafe-swiftshader');
const { open, faults } = visits(browser, url);

/** The points of the face that the checks look at, by the landmarks that they lie between. */
const PLACES = {
  rightCheek: [2, 31], leftCheek: [14, 35], chin: [8, 57], bridge: [27, 28],
  lowerLip: [57, 66], upperLip: [51, 62], rightLid: [37, 19], leftLid: [44, 24],
  rightEye: [37, 38, 40, 41], leftEye: [43, 44, 46, 47],
};

/** A page that shows one frame of a face from in front, and nothing over it. */
async function stillFace(address, options) {
  const page = await open(address, options);
  for (const name of ['points', 'mesh', 'axes']) await page.uncheck(`input[value=${name}]`);
  await page.evaluate(() => new Promise((resolve) => {
    document.addEventListener('posewise:tracked', ({ detail: { result, landmarks } }) => {
      const isFrontal = result.state === 'tracking'
        && Math.max(Math.abs(result.yawDeg), Math.abs(result.pitchDeg)) < 15;
      const isOpen = landmarks[66].y - landmarks[62].y < 1 && Math.min(...result.eyeOpen) > 0.8;
      const video = document.getElementById('video');
      if (isFrontal && isOpen && !video.paused) {
        document.getElementById('pause').click();
        setTimeout(resolve, 500);
      }
    });
  }));
  return page;
}

/** Keeps the pixels that the page shows, as `name` in the page. */
async function keep(page, name) {
  await page.evaluate((name) => {
    const picture = document.getElementById('picture');
    const { width, height } = picture;
    const canvas = Object.assign(document.createElement('canvas'), { width, height });
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(picture, 0, 0);
    (globalThis.kept ??= {})[name] = context.getImageData(0, 0, width, height).data;
  }, name);
}

/** Chooses how the mesh is drawn, and keeps what is drawn then. */
async function draw(page, mode) {
  await page.check(`input[name=face][value=${mode}]`);
  await page.waitForTimeout(300);
  await keep(page, mode);
}

/**
 * What a drawing changed of the picture without it: the share of the frame, what of that lies
 * outside of the face, and by how much at each of the places.
 */
function changes(page, name, places = PLACES) {
  return page.evaluate(([name, places]) => {
    const { width, height } = document.getElementById('picture');
    const { last: { landmarks, result: { faceBox }, width: frameWidth } } = seen;
    const scale = width / frameWidth;
    const [before, after] = [kept.none, kept[name]];
    const differs = (pixel) => Math.max(...[0, 1, 2].map((i) =>
      Math.abs(after[4 * pixel + i] - before[4 * pixel + i])));
    // The landmarks end at the brows; the mesh reaches up to the hair.
    const [left, top, across, down] = faceBox.map((v) => v * scale);
    const isFace = (x, y) => x > left - 0.12 * across && x < left + 1.12 * across
      && y > top - 0.45 * down && y < top + 1.08 * down;
    let [changed, outside] = [0, 0];
    for (let pixel = 0; pixel < width * height; pixel++) {
      if (differs(pixel) < 3) continue;
      changed++;
      if (!isFace(pixel % width, Math.floor(pixel / width))) outside++;
    }
    const at = Object.entries(places).map(([place, indices]) => {
      const mean = (of) => indices.reduce((sum, i) => sum + of(landmarks[i]), 0) / indices.length;
      const [x, y] = [mean((l) => l.x), mean((l) => l.y)].map((v) => Math.floor(scale * (v + 0.5)));
      const pixel = y * width + x;
      const [red, green, blue] = after.slice(4 * pixel, 4 * pixel + 3);
      return [place, { by: differs(pixel), red, green, blue }];
    });
    return { changed: changed / (width * height), outside, at: Object.fromEntries(at) };
  }, [name, places]);
}

/** Each way of drawing changes the face where it should, and nothing else. */
async function modes() {
  const page = await stillFace(url);
  await draw(page, 'none');
  const skin = ['rightCheek', 'leftCheek', 'chin', 'bridge'];
  const lips = ['lowerLip', 'upperLip'];
  const lids = ['rightLid', 'leftLid'];
  const eyes = ['rightEye', 'leftEye'];
  const check = (found, names, isChanged) => {
    for (const name of names) {
      assert.equal(found.at[name].by > 8, isChanged, `${name}: ${JSON.stringify(found.at)}`);
    }
  };

  await draw(page, 'mask');
  const mask = await changes(page, 'mask');
  assert.equal(mask.outside, 0, 'a mask lies on the face');
  assert(mask.changed > 0.05 && mask.changed < 0.4, `the mask covers ${mask.changed}`);
  check(mask, [...skin, ...lips, ...lids], true);
  check(mask, eyes, false);

  await draw(page, 'wire');
  const wire = await changes(page, 'wire');
  assert.equal(wire.outside, 0, 'a wire lies on the face');
  assert(wire.changed > 0.2 * mask.changed && wire.changed < mask.changed, `${wire.changed}`);

  await draw(page, 'make-up');
  const makeUp = await changes(page, 'make-up');
  assert.equal(makeUp.outside, 0, 'make-up lies on the face');
  check(makeUp, [...lips, ...lids], true);
  check(makeUp, [...skin, ...eyes], false);
  assert(makeUp.at.lowerLip.red > makeUp.at.lowerLip.green + 20, 'the lips are red');
  // Another colour is seen at once, though the video stands still.
  await page.fill('#lips', '#00a000');
  await page.waitForTimeout(300);
  await keep(page, 'green');
  const green = await changes(page, 'green');
  assert(green.at.lowerLip.green > green.at.lowerLip.red + 20, 'the lips are green');
  await page.fill('#strength', '0');
  await page.waitForTimeout(300);
  await keep(page, 'bare');
  assert.equal((await changes(page, 'bare')).changed, 0, 'no strength, no make-up');

  await draw(page, 'none');
  await page.context().close();
}

/** A picture of four colours, as the browser writes it. */
function fourColours(page, type) {
  return page.evaluate((type) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [300, 200];
    const context = canvas.getContext('2d');
    // The middle of the face's eyes and mouth is a little above that of the texture.
    for (const [color, x, y] of [['#f00', 0, 0], ['#0f0', 150, 0], ['#00f', 0, 90],
      ['#ff0', 150, 90]]) {
      context.fillStyle = color;
      context.fillRect(x, y, 150, 110);
    }
    return canvas.toDataURL(type).split(',')[1];
  }, type);
}

/** Textures: chosen, dropped, broken; the template. */
async function textures() {
  const page = await stillFace(url);
  await draw(page, 'none');
  await page.check('#face-mask');
  await page.waitForSelector('#mask:not([hidden])');
  const places = { ul: [19, 37], ur: [24, 44], ll: [4, 48], lr: [12, 54] };
  const colors = async () => {
    await page.waitForTimeout(300);
    await keep(page, 'mask');
    const { at, outside } = await changes(page, 'mask', places);
    assert.equal(outside, 0);
    return Object.fromEntries(Object.entries(at).map(([place, color]) =>
      [place, ['red', 'green', 'blue'].map((name) => Number(color[name] > 128)).join('')]));
  };
  const expected = { ul: '100', ur: '010', ll: '001', lr: '110' };
  for (const type of ['png', 'jpeg', 'webp']) {
    const buffer = Buffer.from(await fourColours(page, `image/${type}`), 'base64');
    await page.setInputFiles('#texture', { name: `a.${type}`, mimeType: `image/${type}`, buffer });
    await page.waitForFunction((type) =>
      document.getElementById('texture-note').textContent === `The mask is a.${type}.`, type);
    assert.deepEqual(await colors(), expected, type);
  }
  await page.click('#painted');
  assert.notDeepEqual(await colors(), expected);

  const drop = (content, name, type) => page.evaluate(([content, name, type]) => {
    const bytes = Uint8Array.from(atob(content), (char) => char.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name, { type }));
    document.getElementById('stage').dispatchEvent(new DragEvent('drop', { dataTransfer }));
  }, [content, name, type]);
  await page.check('input[name=face][value=none]');
  await drop(await fourColours(page, 'image/png'), 'b.png', 'image/png');
  await page.waitForFunction(() =>
    document.getElementById('texture-note').textContent === 'The mask is b.png.');
  assert(await page.isChecked('#face-mask'), 'what is dropped is worn');
  assert.deepEqual(await colors(), expected, 'dropped');

  await drop(btoa('no picture'), 'c.png', 'image/png');
  await page.waitForSelector('#texture-note.error');
  assert.equal(await page.textContent('#texture-note'),
    'The browser cannot read c.png as a picture.');
  assert.deepEqual(await colors(), expected, 'the texture before stays');
  assert(await page.evaluate(() => document.getElementById('video').paused), 'the video stays');
  await page.screenshot({ path: join(out, 'texture.png'), fullPage: true });

  const download = page.waitForEvent('download');
  await page.click('#template');
  const template = join(out, 'template.png');
  await (await download).saveAs(template);
  await page.setInputFiles('#texture', template);
  await page.waitForFunction(() =>
    document.getElementById('texture-note').textContent === 'The mask is template.png.');
  await page.screenshot({ path: join(out, 'template-worn.png'), fullPage: true });
  // Width and height in a PNG's header.
  const header = readFileSync(template);
  assert.deepEqual([header.readUInt32BE(16), header.readUInt32BE(20)], [1024, 1024]);
  await page.context().close();
}

/** What WebGL draws, and what the page draws without it, differ little. */
async function surfaces() {
  const page = await open(url);
  const differences = await page.evaluate(async () => {
    const { load } = await import('/posewise.js');
    const { cornersOf } = await import('/demo/face/geometry.js');
    const { GpuSurface } = await import('/demo/face/gpu.js');
    const { RasterSurface } = await import('/demo/face/raster.js');
    const { paintedMask } = await import('/demo/face/textures.js');
    const { frameOf } = await import('/luma.js');
    const engine = await load({ model: '/posewise.posewise' });
    const tracker = engine.createTracker({ scanBudget: 200_000 });
    const video = document.createElement('video');
    document.body.append(video);
    video.muted = true;
    video.src = '/demo/clip.webm';
    const differences = [];
    let timestampUs = 0;
    for (const seconds of [0.1, 1.5, 2.5, 3.5, 4.5]) {
      await new Promise((resolve) => {
        video.onseeked = resolve;
        video.currentTime = seconds;
      });
      const picture = new VideoFrame(video, { timestamp: 0 });
      const frame = await frameOf(picture);
      for (let i = 0; i < 8; i++) tracker.step(frame, timestampUs += 50_000);
      picture.close();
      const [mesh, tables] = [tracker.mesh(), tracker.meshTables()];
      const corners = cornersOf(tables);
      const surfaces = [GpuSurface.create(corners, true), new RasterSurface(corners)];
      for (const look of [{ texture: paintedMask(tables) },
        { edge: [120, 175, 240], contour: [255, 190, 60], width: 2 }]) {
        const [a, b] = surfaces.map((surface) => {
          surface.draw(mesh, frame.width, frame.height, 2, look);
          const canvas = document.createElement('canvas');
          [canvas.width, canvas.height] = [surface.canvas.width, surface.canvas.height];
          const context = canvas.getContext('2d', { willReadFrequently: true });
          context.fillRect(0, 0, canvas.width, canvas.height);
          context.drawImage(surface.canvas, 0, 0);
          return context.getImageData(0, 0, canvas.width, canvas.height).data;
        });
        let [drawn, sum] = [0, 0];
        for (let i = 0; i < a.length; i += 4) {
          if (Math.max(a[i], b[i], a[i + 2], b[i + 2]) === 0) continue;
          drawn++;
          for (let k = 0; k < 3; k++) sum += Math.abs(a[i + k] - b[i + k]) / 3;
        }
        differences.push({ texture: 'texture' in look, drawn, mean: sum / drawn });
      }
    }
    return differences;
  });
  for (const { texture, drawn, mean } of differences) {
    assert(drawn > 5000, `${drawn} pixels are drawn`);
    assert(mean < 4, JSON.stringify(differences));
  }
  // Chromium says that reading back is slow; only this test has WebGL without a graphics processor.
  const isOther = (fault) => !fault.includes('ReadPixels');
  faults.splice(0, faults.length, ...faults.filter(isOther));
  await page.context().close();
  return differences;
}

/** The controls by keyboard. */
async function keyboard() {
  const page = await open(url);
  await untilTracked(page, 3);
  await page.focus('input[name=face][value=none]');
  const chosen = () => page.evaluate(() =>
    document.querySelector('input[name=face]:checked').value);
  const tabs = async (count) => {
    const reached = [];
    for (let i = 0; i < count; i++) {
      await page.keyboard.press('Tab');
      reached.push(await page.evaluate(() => document.activeElement.id));
    }
    return reached;
  };
  assert.deepEqual(await tabs(1), ['show-avatar'], 'what does not matter is not there');
  await page.focus('input[name=face][value=none]');
  const landmarks = () => page.evaluate(() => ['points', 'mesh'].map((name) =>
    document.querySelector(`input[name=draw][value=${name}]`).checked));
  await page.keyboard.press('ArrowRight');
  assert.equal(await chosen(), 'wire');
  await page.waitForFunction(() => !document.querySelector('input[value=points]').checked);
  assert.deepEqual(await landmarks(), [false, false], 'the landmarks go');
  await page.keyboard.press('ArrowRight');
  assert.equal(await chosen(), 'mask');
  assert.deepEqual(await tabs(3), ['texture', 'painted', 'template']);
  await page.focus('#face-mask');
  await page.keyboard.press('ArrowRight');
  assert.equal(await chosen(), 'make-up');
  assert.deepEqual(await tabs(3), ['lips', 'lids', 'strength']);
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.inputValue('#strength'), '71');
  await page.check('input[name=face][value=none]');
  assert.deepEqual(await landmarks(), [true, true], 'the landmarks are there again');
  await untilTracked(page, 3);
  await page.context().close();
}

/** How the page looks with each mode. */
async function looks() {
  const phone = { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true };
  for (const [name, options] of Object.entries({
    light: { colorScheme: 'light' },
    dark: { colorScheme: 'dark' },
    phone: { ...phone, colorScheme: 'dark' },
  })) {
    const page = await stillFace(url, options);
    for (const mode of ['wire', 'mask', 'make-up']) {
      await draw(page, mode);
      await checkLooks(page, `${name}-${mode}`, out);
    }
    await page.context().close();
  }
}

/** The page as one file, from the disk. */
async function fromDisk() {
  const page = await stillFace(pathToFileURL(join(folder, 'standalone.html')).href);
  await draw(page, 'none');
  await draw(page, 'mask');
  const { changed, outside } = await changes(page, 'mask');
  assert(changed > 0.05 && outside === 0, `${changed}, ${outside}`);
  await page.context().close();
}

try {
  await modes();
  await textures();
  const differences = await surfaces();
  await keyboard();
  await looks();
  await fromDisk();
  assert.deepEqual(faults, []);
  console.log('WebGL and the page\'s own code, mean difference of what is drawn (of 255):');
  for (const { texture, mean } of differences) {
    console.log(`${texture ? 'mask' : 'wire'} ${mean.toFixed(2)}`);
  }
} finally {
  await browser.close();
}
