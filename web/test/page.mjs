// page.mjs URL FOLDER CAMERA.y4m OUT - opens the page in Chromium with a fake camera, uses it as a
// person would, and fails where it does not work. URL serves FOLDER. In OUT it leaves screenshots,
// page.csv and frames.bin; tests/shipping/web.rs compares these.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';
import { launch } from './browser.mjs';
import { checkLooks } from './looks.mjs';
import { untilTracked, visits } from './visits.mjs';

const [url, folder, camera, out] = process.argv.slice(2);
/** What loading the page may transfer, uncompressed and from a server that compresses. */
const MOST_BYTES = 1_760_000;
const MOST_PACKED_BYTES = 1_240_000;

const browser = await launch(
  '--use-fake-ui-for-media-stream',
  '--use-fake-device-for-media-stream',
  `--use-file-for-fake-video-capture=${camera}`,
);

const { open, faults } = visits(browser, url);

/** What the demo clip gives, how the page looks, and whether axe finds fault with it. */
async function looks(name, options) {
  const page = await open(url, options);
  await untilTracked(page, 40);
  assert.equal(await page.textContent('#status'), 'Face found');
  const figures = await page.evaluate(() => ({
    firstMs: seen.firstMs,
    files: ['navigation', 'resource'].flatMap((kind) => performance.getEntriesByType(kind))
      .map(({ name, decodedBodySize }) => ({ name, bytes: decodedBodySize })),
  }));
  await checkLooks(page, name, out);
  await page.context().close();
  return figures;
}

/** Bytes of the files that were loaded, by gzip -9 and without it. */
function sizes(files) {
  const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);
  const packed = files.map(({ name }) => {
    const path = new URL(name).pathname.slice(1) || 'index.html';
    return gzipSync(readFileSync(join(folder, path)), { level: 9 }).length;
  });
  return { bytes: sum(files.map(({ bytes }) => bytes)), packed: sum(packed) };
}

/** Uses the controls, by mouse and by keyboard. */
async function controls() {
  const page = await open(url);
  await untilTracked(page, 5);
  const reached = new Set();
  for (let i = 0; i < 24; i++) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement?.id
      || document.activeElement?.value));
  }
  for (const id of ['use-clip', 'use-camera', 'file', 'pause', 'model', 'points', 'mesh', 'axes',
    'box', 'smooth', 'mirror', 'none', 'record']) {
    assert(reached.has(id), `${id} is reached by keyboard`);
  }
  await page.focus('#record');
  await page.keyboard.press('Space');
  await untilTracked(page, 10);
  const download = page.waitForEvent('download');
  await page.keyboard.press('Space');
  await (await download).saveAs(join(out, 'page.csv'));

  await page.click('#pause');
  await page.waitForFunction(() => document.getElementById('video').paused);
  await page.click('#pause');
  await untilTracked(page, 3);
  await page.selectOption('#model', 'research');
  const says = (text) => document.getElementById('model-note').textContent.includes(text);
  await page.waitForFunction(says, 'check its terms');
  await untilTracked(page, 10);
  await page.setInputFiles('#file', join(folder, 'demo/clip.webm'));
  await untilTracked(page, 10);
  const broken = { name: 'a.webm', mimeType: 'video/webm', buffer: Buffer.from('no') };
  await page.setInputFiles('#file', broken);
  await page.waitForSelector('#status.error');
  await page.click('#use-camera');
  await untilTracked(page, 30);
  assert(await page.isChecked('#mirror'), 'a camera is a mirror');
  await page.screenshot({ path: join(out, 'camera.png') });
  await page.context().close();
}

/** Watches the driver of the demo clip, and records what is seen. */
async function driver() {
  const page = await open(url);
  await untilTracked(page, 5);
  assert(await page.isHidden('#driver'), 'no driver is watched');
  await page.check('#watch-driver');
  const watches = () => /^(open|closed), /.test(
    document.querySelector('#driver-readings dd')?.textContent ?? '');
  await page.waitForFunction(watches);
  await page.click('#record');
  // Four seconds of the clip have two blinks.
  await untilTracked(page, 80);
  const download = page.waitForEvent('download');
  await page.click('#record');
  await (await download).saveAs(join(out, 'driver.csv'));
  assert.match(await page.textContent('#driver-events'), /blink for 0\.\d s/);
  assert.match(await page.getAttribute('#driver-plan', 'aria-label'), /^Zones\. Looks at: /);
  await checkLooks(page, 'driver', out);
  await page.uncheck('#watch-driver');
  await page.waitForSelector('#driver', { state: 'hidden' });
  await untilTracked(page, 5);
  await page.context().close();
}

/** Frames of the camera: luma, time and results, for tests/shipping/web.rs to track again. */
async function frames(count) {
  const page = await open(url);
  const records = await page.evaluate(async (count) => {
    const { FaceTracker, frameOf } = await import('/posewise.js');
    const video = document.createElement('video');
    document.body.append(video);
    video.muted = true;
    video.srcObject = await navigator.mediaDevices.getUserMedia({ video: true });
    await video.play();
    const [a, b] = await Promise.all([1, 2].map(() =>
      FaceTracker.create({ model: 'posewise.posewise' })));
    const records = [];
    while (records.length < count) {
      await new Promise((resolve) => video.requestVideoFrameCallback(resolve));
      const timestampUs = Math.trunc(1000 * performance.now());
      const picture = new VideoFrame(video, { timestamp: timestampUs });
      const { data, width, height, stride, format } = await frameOf(picture);
      if (format !== 'GREY') throw new Error(`the camera gives ${picture.format}`);
      const luma = new Uint8Array(width * height);
      for (let y = 0; y < height; y++) {
        luma.set(data.subarray(y * stride, y * stride + width), y * width);
      }
      const { result, landmarks } = await a.track({ data: luma, width, height }, timestampUs);
      const whole = await b.track(picture, timestampUs);
      const isSame = JSON.stringify(whole.result) === JSON.stringify(result);
      if (!isSame) throw new Error('a VideoFrame gives another result than its luma');
      const { yawDeg, pitchDeg, rollDeg } = result;
      const numbers = [yawDeg, pitchDeg, rollDeg, ...landmarks.flatMap(({ x, y }) => [x, y])];
      const text = Array.from(luma, (byte) => String.fromCharCode(byte)).join('');
      records.push({ timestampUs, width, height, luma: btoa(text), numbers });
    }
    return records;
  }, count);
  const parts = records.map(({ timestampUs, width, height, luma, numbers }) => Buffer.concat([
    Buffer.from(BigInt64Array.of(BigInt(timestampUs)).buffer),
    Buffer.from(Uint32Array.of(width, height).buffer),
    Buffer.from(luma, 'base64'),
    Buffer.from(Float32Array.from(numbers).buffer),
  ]));
  writeFileSync(join(out, 'frames.bin'), Buffer.concat(parts));
  await page.context().close();
}

/** Browsers with relaxed SIMD, with SIMD and without it get a module each, and only that. */
async function modules() {
  const kinds = {
    'posewise-relaxed.wasm': () => {},
    'posewise-simd128.wasm': () => {
      const { validate } = WebAssembly;
      // The dot product of relaxed SIMD: 253, 147, 2.
      WebAssembly.validate = (bytes) => !`${bytes}`.includes('253,147,2') && validate(bytes);
    },
    'posewise.wasm': () => {
      WebAssembly.validate = () => false;
    },
  };
  for (const [module, script] of Object.entries(kinds)) {
    const page = await open(url, {}, script);
    await untilTracked(page, 20);
    const names = await page.evaluate(() =>
      performance.getEntriesByType('resource').map(({ name }) => name.split('/').pop()));
    assert.deepEqual([...new Set(names.filter((name) => name.endsWith('.wasm')))], [module]);
    await page.context().close();
  }
}

/** The one-file page from the disk. */
async function fromDisk() {
  const page = await open(pathToFileURL(join(folder, 'standalone.html')).href);
  await untilTracked(page, 20);
  await page.screenshot({ path: join(out, 'standalone.png') });
  await page.context().close();
}

/** The page cannot send anything elsewhere, even if a script tried. */
async function sendsNothing() {
  const page = await open(url);
  await untilTracked(page, 1);
  const before = faults.length;
  const blocked = await page.evaluate(async () => {
    const violated = new Promise((resolve) => {
      document.addEventListener('securitypolicyviolation', (event) => resolve(event.blockedURI));
    });
    await fetch('https://example.org/').catch(() => {});
    return violated;
  });
  assert.match(blocked, /^https:\/\/example.org/);
  faults.length = before;
  await page.context().close();
}

try {
  const phone = { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true };
  const { firstMs, files } = await looks('light', { colorScheme: 'light' });
  const { bytes, packed } = sizes(files.filter(({ name }) => name.startsWith(url)));
  assert(bytes > 1_000_000 && bytes <= MOST_BYTES, `${bytes} bytes`);
  assert(packed > 900_000 && packed <= MOST_PACKED_BYTES, `${packed} bytes with gzip`);
  await looks('dark', { colorScheme: 'dark' });
  await looks('phone', { ...phone, colorScheme: 'dark' });
  await controls();
  await driver();
  await frames(40);
  await modules();
  await fromDisk();
  await sendsNothing();
  assert.deepEqual(faults, []);
  console.log(`${bytes} bytes, ${packed} with gzip`);
  console.log(`first tracked face after ${firstMs.toFixed(0)} ms`);
} finally {
  await browser.close();
}
