// camera.mjs VIDEO.y4m - what a program says about its camera, and what it can ask of a tracker.

import { load } from 'posewise';
import { framesOf } from './frames.mjs';

const engine = await load();
const { name, terms, sections } = engine.model;
console.log(`${name}: terms ${terms}, sections ${sections.join(' ')}`);
console.log(`library ${engine.version} with ${engine.parts.join(', ')}`);
const { minFacePx, scanBudget } = engine.defaultConfig();
const tracker = engine.createTracker({
  minFacePx: minFacePx + 8,
  scanBudget: 2 * scanBudget,
  intrinsics: { fx: 277, fy: 277, cx: 159.5, cy: 119.5 },
  lens: { model: 'brown', coefficients: [0.01, 0, 0, 0, 0] },
  gaze: 'on',
});
// Faces are found in the middle of the picture only.
tracker.setRoi({ x: 40, y: 20, width: 240, height: 200 });
let result;
let count = 0;
/** @type {Uint8Array} */
let person;
for (const { frame, timestampUs } of framesOf(process.argv[2])) {
  result = tracker.step(frame, timestampUs);
  if (++count === 10) {
    // The camera zooms out, somebody else sits down, and faces are found everywhere.
    tracker.setLens(null);
    tracker.setIntrinsics(null);
    tracker.setRoi(null);
    person = tracker.saveIdentity();
    tracker.forgetIdentity();
    // Somebody else looks like the person before, until more is seen.
    tracker.restoreIdentity(person);
  }
  for (const { timestampUs: time, kind, loss } of tracker.events().events) {
    console.log(`${time} us: ${kind}, ${loss}`);
  }
}
console.log(`a head of the same shape as before: ${tracker.compareIdentity(person)}`);
console.log(`yaw ${result.yawDeg.toFixed(1)}, smoothed ${tracker.smoothed().yawDeg.toFixed(1)}`);
const direction = result.gaze.map((number) => number.toFixed(2)).join(' ');
console.log(`gaze ${result.gazeStatus[2]}: along ${direction}`);
const [nose, steady] = [tracker.landmarks()[30], tracker.smoothedLandmarks()[30]];
console.log(`nose ${nose.x.toFixed(1)} ${nose.y.toFixed(1)}, smoothed ${steady.x.toFixed(1)}`);
const weights = tracker.animation();
const strongest = weights.indexOf(Math.max(...weights));
const smoothed = tracker.smoothedAnimation()[strongest];
console.log(`${engine.animationNames[strongest]} ${smoothed.toFixed(2)}`);
console.log(`${engine.eyeLookNames[0]} ${result.eyeLook[0].toFixed(2)}`);
const { triangles } = tracker.meshTables();
console.log(`${tracker.mesh('camera').length / 4} vertices, ${triangles.length / 3} triangles`);
// The person's own head, and how an open jaw changes it: a morph target.
const [neutral, open] = [tracker.meshShape(), tracker.meshShape('jawOpen')];
const lowest = (/** @type {Float32Array} */ mesh) =>
  mesh.reduce((most, y, i) => (i % 4 === 1 ? Math.max(most, y) : most), -Infinity);
console.log(`the jaw opens by ${(lowest(open) - lowest(neutral)).toFixed(0)} mm`);
// For another video.
tracker.reset();
tracker.free();
