// What a program does with the package, here bundled: the clip in a worker, with a monitor, and the
// library in this thread. What came of it is in globalThis.seen.

import { FaceTracker, PosewiseError, load } from 'posewise';

const bytes = new Uint8Array(await (await fetch('./demo.y4m')).arrayBuffer());
const [width, height, frameUs] = [320, 240, 50_000];
const header = bytes.indexOf(10) + 1;
const framed = 'FRAME\n'.length + width * height;

/** @param {number} i */
function frame(i) {
  const at = header + i * framed + 'FRAME\n'.length;
  return { data: bytes.slice(at, at + width * height), width, height };
}

const tracker = await FaceTracker.create({
  config: { gaze: 'natural' },
  monitor: { preset: 'euro-ncap' },
  zones: [{ kind: 'angles', yawDeg: [-20, 20], pitchDeg: [-15, 15], isRoad: true }],
});
const { faces } = await tracker.detect(frame(0));
const events = [];
let tracked = 0;
let last;
for (let i = 0; i < 48; i++) {
  last = await tracker.track(frame(i), i * frameUs);
  tracked += last.result.state === 'tracking' ? 1 : 0;
  events.push(...last.monitor.events.map(({ kind }) => kind));
}
const { state } = last.monitor;
const errors = await Promise.all([
  tracker.track(frame(0), 0),
  tracker.track(frame(0), 2 ** 70),
  tracker.setZones([{ kind: 'sphere' }]),
].map((promise) => promise.catch((error) => error)));
await tracker.forgetDriver();
await tracker.setExcluded([last.result.faceBox]);
const excluded = await tracker.track(frame(48), 48 * frameUs);
await tracker.close();

const engine = await load();
const here = engine.createTracker().step(frame(0), 0);
globalThis.seen = {
  faces: faces.length,
  tracked,
  events,
  eyes: state.eyes,
  blinks: state.blinks,
  excluded: excluded.result.loss,
  errors: errors.map((error) => [error.name, error.code, error instanceof PosewiseError]),
  here: here.state,
  model: tracker.model.name,
  version: [tracker.version, engine.version],
};
