// faults.mjs MODULE MODEL - what a caller can do wrong is said, and does no harm.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Engine, FaceTracker } from '../posewise.js';

const [bytes, model] = process.argv.slice(2).map((path) => readFileSync(path));
const compiled = await WebAssembly.compile(bytes);

/** A frame of grey without a face. */
function grey(width, height) {
  return { data: new Uint8Array(width * height).fill(90), width, height };
}

/** An engine whose memory can be made to grow no more. */
async function bounded() {
  const { exports } = await WebAssembly.instantiate(compiled, {});
  const limit = { isReached: false };
  const memory = {
    get buffer() {
      return exports.memory.buffer;
    },
    grow(pages) {
      if (limit.isReached) throw new RangeError('memory cannot grow');
      return exports.memory.grow(pages);
    },
  };
  return { engine: new Engine({ exports: { ...exports, memory } }, model), limit };
}

async function newTracker() {
  return new Engine(await WebAssembly.instantiate(compiled, {}), model).createTracker();
}

test('a frame for which memory cannot grow leaves the module as it is', async () => {
  for (const earlier of [[], [grey(64, 48)]]) {
    const { engine, limit } = await bounded();
    const tracker = engine.createTracker();
    for (const frame of earlier) tracker.step(frame, 0);
    const before = engine.bytes(0, engine.scratch).slice();
    limit.isReached = true;
    for (const width of [640, 640, 320]) {
      assert.throws(() => tracker.step(grey(width, 480), 1), /memory cannot grow/);
    }
    assert.deepEqual(engine.bytes(0, engine.scratch).slice(0, 65536), before.slice(0, 65536));
    limit.isReached = false;
    assert.equal(tracker.step(grey(640, 480), 2).state, 'searching');
  }
});

test('a tracker for which memory cannot grow is none', async () => {
  const { engine, limit } = await bounded();
  limit.isReached = true;
  assert.throws(() => engine.createTracker(), /memory cannot grow/);
  limit.isReached = false;
  assert.equal(engine.createTracker().step(grey(64, 48), 0).state, 'searching');
});

/** A worker that answers each call, and one that a test looks into. */
function fakeWorker() {
  const worker = {
    ended: false,
    postMessage(message, transfer) {
      const { id } = structuredClone(message, { transfer });
      setTimeout(() => worker.ended || worker.onmessage({ data: { id, value: {} } }));
    },
    terminate() {
      worker.ended = true;
    },
  };
  return worker;
}

/** What a promise is after a while. */
function settled(promise) {
  const none = new Promise((resolve) => setTimeout(resolve, 200, 'pending'));
  return Promise.race([promise.then(() => 'resolved', (error) => error), none]);
}

test('what cannot be sent is not waited for', async () => {
  const tracker = new FaceTracker(fakeWorker());
  const wrong = { ...grey(8, 8), mirrored: () => true };
  await assert.rejects(tracker.track(wrong, 0), /could not be cloned/);
  assert.equal(tracker.pending, 0);
  assert.equal(await settled(tracker.track(grey(8, 8), 1)), 'resolved');
  assert.equal(tracker.pending, 0);
});

test('calls after close are rejected', async () => {
  const tracker = new FaceTracker(fakeWorker());
  const last = tracker.track(grey(8, 8), 0);
  const closing = tracker.close();
  const late = settled(tracker.track(grey(8, 8), 1));
  assert.equal(await settled(last), 'resolved');
  assert.equal(await settled(closing), 'resolved');
  assert.match(String(await late), /closed/);
  assert.match(String(await settled(tracker.reset())), /closed/);
  assert.equal(await settled(tracker.close()), 'resolved');
  assert.equal(tracker.pending, 0);
});

test('a picture that is not sent is closed', async () => {
  const tracker = new FaceTracker(fakeWorker());
  await tracker.close();
  globalThis.HTMLElement ??= class {};
  const picture = { isClosed: false, close() { this.isClosed = true; } };
  await assert.rejects(tracker.track(picture, 0), /closed/);
  assert.ok(picture.isClosed);
});

test('excluded boxes have four numbers', async () => {
  const { engine } = await bounded();
  const tracker = engine.createTracker();
  tracker.step(grey(64, 48), 0);
  const behind = () => engine.bytes(engine.scratch + 16384, 8192).slice();
  const before = behind();
  const row = new Array(1500).fill(7);
  for (const boxes of [[row], [[1, 2, 30]], [[1, 2, 30, 40], [1, 2, 30, 40, 5]], [7]]) {
    assert.throws(() => tracker.setExcluded(boxes), TypeError);
  }
  assert.deepEqual(behind(), before);
  const box = [1, 2, 30, 40];
  assert.throws(() => tracker.setExcluded(new Array(400).fill(box)), /more than 16/);
  tracker.setExcluded([box, box]);
  tracker.setExcluded([]);
});

test('a group steps trackers of its engine', async () => {
  const { engine } = await bounded();
  const group = engine.createGroup();
  const two = [engine.createTracker(), engine.createTracker()];
  const foreign = await newTracker();
  const results = group.step(two, grey(64, 48), 0);
  assert.deepEqual(results.map(({ state }) => state), ['searching', 'searching']);
  assert.deepEqual(two[1].smoothed().timestampUs, 0);
  assert.throws(() => group.step(two, grey(64, 48), 0), /timestamp/);
  assert.throws(() => group.step([], grey(64, 48), 1), /1\.\.16/);
  assert.throws(() => group.step(new Array(400).fill(two[0]), grey(64, 48), 1), /1\.\.16/);
  assert.throws(() => group.step([two[0], two[0]], grey(64, 48), 1), /memory/);
  assert.throws(() => group.step([foreign], grey(64, 48), 1), TypeError);
  two[0].free();
  assert.throws(() => group.step(two, grey(64, 48), 1), /free/);
});

test('a lens has a name', async () => {
  const tracker = await newTracker();
  const coefficients = [0, 0, 0, 0, 0];
  tracker.setIntrinsics({ fx: 500, fy: 500, cx: 320, cy: 240 });
  for (const model of ['fish-eye', 'Brown', 1, undefined]) {
    assert.throws(() => tracker.setLens({ model, coefficients }), TypeError, String(model));
  }
  assert.throws(() => tracker.setLens({ model: 'brown', coefficients: [0, 0] }), TypeError);
  tracker.setLens({ model: 'pinhole', coefficients });
  tracker.setLens({ model: 'fisheye', coefficients });
});

test('structs are whole', async () => {
  const tracker = await newTracker();
  assert.throws(() => tracker.setIntrinsics({ fx: 500, fy: 500 }), TypeError);
  assert.throws(() => tracker.setRoi({ x: 0, y: 0, width: 50 }), TypeError);
  for (const hint of [{}, { faceBox: [1, 2] }, { faceBox: [1, 2, 30, 40, 5] }]) {
    assert.throws(() => tracker.stepAt(grey(64, 48), 0, hint), TypeError);
  }
  tracker.stepAt(grey(64, 48), 0, { faceBox: [1, 2, 30, 40] });
});

test('integers do not wrap', async () => {
  const { engine } = await bounded();
  const tracker = engine.createTracker();
  const frame = grey(64, 48);
  for (const time of [2 ** 63, -(2 ** 63) - 2048, 2 ** 64 + 4096, NaN, Infinity, 'soon']) {
    assert.throws(() => tracker.step(frame, time), RangeError, String(time));
  }
  for (const [name, value] of [
    ['width', 2 ** 32 + 64], ['height', 2 ** 32 + 48], ['stride', 2 ** 32 + 64],
    ['rotationDeg', 2 ** 32 + 90], ['width', -1], ['height', NaN],
  ]) {
    assert.throws(() => tracker.step({ ...frame, [name]: value }, 0), RangeError, name);
  }
  for (const minFacePx of [2 ** 32 + 40, -1, NaN]) {
    assert.throws(() => engine.createTracker({ minFacePx }), RangeError);
  }
  const roi = { x: 2 ** 32, y: 0, width: 64, height: 48 };
  assert.throws(() => tracker.setRoi(roi), RangeError);
  // Clocks of browsers have fractions.
  assert.equal(tracker.step(frame, 33_333.6).timestampUs, 33_333);
});

test('a record needs a face, and is whole', async () => {
  const tracker = await newTracker();
  assert.throws(() => tracker.saveIdentity(), { code: 'E_NO_FACE' });
  for (const bytes of [new Uint8Array(0), new Uint8Array(15)]) {
    assert.throws(() => tracker.restoreIdentity(bytes), { code: 'E_RECORD_SIZE' });
  }
  for (const bytes of [new Uint8Array(288), new Uint8Array(9999)]) {
    assert.throws(() => tracker.compareIdentity(bytes), { code: 'E_RECORD' });
  }
});

test('a mesh needs a face and a space', async () => {
  const tracker = await newTracker();
  assert.throws(() => tracker.mesh(), { code: 'E_NO_FACE' });
  assert.throws(() => tracker.mesh('face'), TypeError);
  assert.throws(() => tracker.meshShape(), { code: 'E_NO_FACE' });
  assert.throws(() => tracker.meshShape('jawopen'), TypeError);
  const { triangles, uvs, lines } = tracker.meshTables();
  assert.ok(Math.max(...triangles) < uvs.length / 2 && uvs.length <= 1600);
  assert.equal(lines.landmarks.length, 68);
  assert.ok(Object.values(lines).every((line) => line.length > 2));
});

test('a model says its name, its terms and its faults', async () => {
  const { engine } = await bounded();
  assert.equal(engine.model.name, 'posewise.posewise');
  assert.equal(engine.model.terms, 'free');
  assert.equal(engine.model.length, model.length);
  assert.ok(engine.model.sections.includes('ALGN') && engine.model.sheet.includes('Trained on'));
  assert.ok(engine.parts.includes('keyframes'));
  const instance = await WebAssembly.instantiate(compiled, {});
  const spoilt = Uint8Array.from(model);
  spoilt[5000] ^= 1;
  const corrupt = /corrupt: the checksum does not match/;
  assert.throws(() => new Engine(instance, spoilt), corrupt);
});
