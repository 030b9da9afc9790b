// replay.mjs MODULE MODEL CLIP.y4m - tracks a mono clip of 20 frames a second, and prints the hash
// of all results that tests/golden.rs computes. Standard error gets the time of a step.

import { readFileSync } from 'node:fs';
import { load } from '../engine.js';

const [module, model, clip] = process.argv.slice(2).map((path) => readFileSync(path));
const FRAME_US = 50_000;

/** FNV-1a, 64 bits. */
let hash = 0xcbf29ce484222325n;
function add(bytes) {
  for (const byte of bytes) {
    hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  }
}

function addResult(engine, tracker, result) {
  const { STATES, LOSSES } = engine;
  add([STATES.indexOf(result.state), LOSSES.indexOf(result.loss), result.cameraAssumed]);
  const times = [result.timestampUs, result.ageUs].map(BigInt);
  add(new Uint8Array(BigInt64Array.from(times).buffer));
  const landmarks = tracker.landmarks();
  const numbers = [
    result.confidence, result.yawDeg, result.pitchDeg, result.rollDeg, result.visibleShare,
    ...result.faceBox, ...result.rotation, ...result.translationMm, ...result.eyeOpen,
    ...result.rotationSigmaDeg, ...result.translationSigmaMm,
    ...landmarks.flatMap((l) => [l.x, l.y, l.confidence, l.visibility]),
    ...landmarks.flatMap((l) => [l.xMm, l.yMm, l.zMm]),
    ...tracker.animation(),
    result.facingYawDeg, result.facingPitchDeg, result.facingRollDeg, result.focalPx,
    ...result.facingSigmaDeg,
  ];
  add(new Uint8Array(Float32Array.from(numbers).buffer));
}

const layout = await import('../layout.js');
const engine = await load({ wasm: module, model });
const tracker = engine.createTracker();
const headerEnd = clip.indexOf('\n');
const [, width, height] = clip.toString('latin1', 0, headerEnd).match(/ W(\d+) H(\d+) .*Cmono/);
const size = width * height;
let [tracked, count, ms] = [0, 0, 0];
for (let at = headerEnd + 1; at < clip.length; count++) {
  at = clip.indexOf('\n', at) + 1;
  const data = clip.subarray(at, at + size);
  at += size;
  const start = performance.now();
  const result = tracker.step({ data, width: +width, height: +height }, count * FRAME_US);
  ms += performance.now() - start;
  tracked += result.state === 'tracking';
  addResult(layout, tracker, result);
}
console.error(`${(ms / count).toFixed(2)} ms a step`);
console.log(`${hash.toString(16).padStart(16, '0')} ${tracked}/${count} tracked`);
