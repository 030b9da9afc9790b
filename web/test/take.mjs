// take.mjs MODULE MODEL CLIP.y4m COMMAND.glb OUT.glb - what the page saves of a mono clip of 20
// frames a second, compared with what `posewise track --gltf` wrote of it.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { Take } from '../demo/take/take.js';
import { cameraOf } from '../demo/overlay.js';
import { load } from '../engine.js';

const [wasm, model, clip, command] = process.argv.slice(2).map((path, i) =>
  (i < 4 ? readFileSync(path) : undefined));
const FRAME_US = 50_000;
/** Numbers of both files may differ by this part of the larger one, or of 1. */
const ROUNDING = 1e-6;
/** Components of normals may by this: the command computes them in 32 bits, the page in 64. */
const NORMAL_ROUNDING = 1e-4;

/** The frames of the clip, and their size. */
function framesOf(bytes) {
  const headerEnd = bytes.indexOf('\n');
  const [, ...size] = bytes.toString('latin1', 0, headerEnd).match(/ W(\d+) H(\d+) .*Cmono/);
  const [width, height] = size.map(Number);
  const frames = [];
  for (let at = headerEnd + 1; at < bytes.length;) {
    at = bytes.indexOf('\n', at) + 1;
    frames.push({ data: bytes.subarray(at, at + width * height), width, height });
    at += width * height;
  }
  return frames;
}

/** What is saved of frames. */
function saved(engine, frames) {
  // Each frame is searched as a whole, as the command does with files.
  const tracker = engine.createTracker({ scanBudget: 10_000_000 });
  const take = new Take();
  frames.forEach((frame, i) => {
    const result = tracker.step(frame, i * FRAME_US);
    take.add({ result, animation: tracker.animation() });
  });
  const shapes = engine.animationNames.map((name) => ({ name, mesh: tracker.meshShape(name) }));
  const person = { neutral: tracker.meshShape(), shapes, tables: tracker.meshTables() };
  const { width, height } = frames[0];
  const camera = { width, height, ...cameraOf({ width, height }) };
  return Buffer.from(take.glb(person, camera, engine.version));
}

/** The JSON of a .glb, and the numbers of its accessors. */
function parsed(file) {
  const length = file.readUInt32LE(12);
  const json = JSON.parse(file.toString('utf8', 20, 20 + length));
  const numbers = json.accessors.map(({ bufferView, componentType, count, type }) => {
    const { byteOffset } = json.bufferViews[bufferView];
    const size = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 }[type];
    const start = 28 + length + byteOffset;
    return Array.from({ length: count * size }, (_, i) => (componentType === 5123
      ? file.readUInt16LE(start + 2 * i) : file.readFloatLE(start + 4 * i)));
  });
  const { attributes, targets } = json.meshes[0].primitives[0];
  const normals = [attributes, ...targets].map(({ NORMAL }) => numbers.splice(NORMAL, 1, [])[0]);
  return { json, numbers, normals };
}

/** Fails where two values differ by more than rounding. */
function assertClose(a, b, path, rounding = ROUNDING) {
  if (typeof a === 'number' && typeof b === 'number') {
    const size = Math.max(1, Math.abs(a), Math.abs(b));
    assert(Math.abs(a - b) <= rounding * size, `${path}: ${a} here, ${b} of the command`);
  } else if (typeof a === 'object' && a && b) {
    assert.deepEqual(Object.keys(a).sort(), Object.keys(b).sort(), path);
    for (const key of Object.keys(a)) assertClose(a[key], b[key], `${path}.${key}`, rounding);
  } else {
    assert.equal(a, b, path);
  }
}

/** A take ends after ten minutes, and without a face there is none. */
function checkBounds() {
  const take = new Take();
  const animation = new Float32Array(3);
  const face = { state: 'tracking', rotation: [0, 0, 0, 1], translationMm: [0, 0, 500] };
  const add = (seconds, result) =>
    take.add({ result: { ...result, timestampUs: 1e6 * seconds }, animation });
  add(5, { state: 'searching' });
  assert(!take.hasFace);
  add(6, face);
  assert(take.hasFace && !take.isFull);
  add(605, face);
  assert(take.isFull);
  add(606, face);
  assert.equal(take.seconds, 600);
}

checkBounds();
const engine = await load({ wasm, model });
const file = saved(engine, framesOf(clip));
writeFileSync(process.argv[6], file);
const [ours, theirs] = [file, command].map(parsed);
assert.deepEqual(ours.json.meshes[0].extras.targetNames, engine.animationNames);
assertClose(ours.normals, theirs.normals, 'normals', NORMAL_ROUNDING);
assertClose(ours.numbers, theirs.numbers, 'numbers');
assertClose(ours.json, theirs.json, 'json');
