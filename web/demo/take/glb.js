// An animated head as binary glTF 2.0 (.glb), as `posewise track --gltf` writes it. Everything here
// is in glTF's terms: metres, y up, z out of the face and towards the camera, v downwards.

/**
 * @typedef {object} Surface
 * @property {Float32Array} places x, y, z of each vertex [m].
 * @property {Float32Array} normals
 *
 * @typedef {object} Head
 * @property {Surface} neutral
 * @property {{ name: string, surface: Surface }[]} shapes The head with each weight at 1.
 * @property {Float32Array} uvs
 * @property {Uint16Array} triangles Three vertices each, counter-clockwise as seen from outside.
 *
 * @typedef {object} Motion One key for each frame, and at least one frame.
 * @property {Float32Array} times Increasing [s].
 * @property {Float32Array} translations For each time x, y, z [m].
 * @property {Float32Array} rotations For each time a quaternion x, y, z, w.
 * @property {Float32Array} weights For each time one of each shape.
 *
 * @typedef {object} Camera
 * @property {number} yfov Vertical field of view [rad].
 * @property {number} aspectRatio
 */

const FLOAT = 5126;
const UNSIGNED_SHORT = 5123;
const VERTICES = 34962;
const INDICES = 34963;
/** "glTF", "JSON" and "BIN", as little-endian numbers. */
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
/** Of viewers' shading: grey, as rough as plaster. */
const PLASTER = { baseColorFactor: [0.8, 0.8, 0.8, 1], metallicFactor: 0, roughnessFactor: 0.7 };
/** Nearest that a viewer has to draw [m]. */
const NEAREST_M = 0.01;

/** The binary part of a file, and what describes it. */
class Binary {
  /** @type {(Float32Array | Uint16Array)[]} */
  parts = [];
  byteLength = 0;
  /** @type {object[]} */
  views = [];
  /** @type {object[]} */
  accessors = [];

  /**
   * Adds numbers, and gives the index of their accessor.
   * @param {Float32Array | Uint16Array} values
   * @param {number} size Numbers of one element.
   * @param {{ target?: number, isBounded?: boolean }} [use] What a graphics processor uses them
   *   for; whether the file says their least and greatest.
   */
  add(values, size, { target, isBounded = false } = {}) {
    const { byteLength } = values;
    this.accessors.push({
      bufferView: this.views.length,
      componentType: values instanceof Float32Array ? FLOAT : UNSIGNED_SHORT,
      count: values.length / size,
      type: size === 1 ? 'SCALAR' : `VEC${size}`,
      ...isBounded && { min: bound(values, size, Math.min), max: bound(values, size, Math.max) },
    });
    this.views.push({ buffer: 0, byteOffset: this.byteLength, byteLength, target });
    this.parts.push(values);
    // Each list begins at a multiple of four.
    this.byteLength += 4 * Math.ceil(byteLength / 4);
    return this.accessors.length - 1;
  }
}

/**
 * The least or the greatest of each number of the elements.
 * @param {Float32Array | Uint16Array} values
 * @param {number} size
 * @param {(a: number, b: number) => number} choose
 */
function bound(values, size, choose) {
  const found = Array.from(values.subarray(0, size));
  values.forEach((value, i) => (found[i % size] = choose(found[i % size], value)));
  return found;
}

/**
 * @param {Float32Array} of
 * @param {Float32Array} from
 */
function difference(of, from) {
  return of.map((value, i) => value - from[i]);
}

/**
 * The neutral face with a morph target for each shape.
 * @param {Binary} binary
 * @param {Head} head
 */
function meshOf(binary, { neutral, shapes, uvs, triangles }) {
  const target = VERTICES;
  const places = { target, isBounded: true };
  const indices = binary.add(triangles, 1, { target: INDICES });
  const attributes = {
    POSITION: binary.add(neutral.places, 3, places),
    NORMAL: binary.add(neutral.normals, 3, { target }),
    TEXCOORD_0: binary.add(uvs, 2, { target }),
  };
  const targets = shapes.map(({ surface }) => ({
    POSITION: binary.add(difference(surface.places, neutral.places), 3, places),
    NORMAL: binary.add(difference(surface.normals, neutral.normals), 3, { target }),
  }));
  return {
    name: 'head',
    primitives: [{ attributes, indices, material: 0, targets }],
    extras: { targetNames: shapes.map(({ name }) => name) },
  };
}

/**
 * Place, rotation and weights of node 0.
 * @param {Binary} binary
 * @param {Motion} motion
 */
function animationOf(binary, { times, translations, rotations, weights }) {
  const input = binary.add(times, 1, { isBounded: true });
  const outputs = /** @type {const} */ ([
    ['translation', translations, 3], ['rotation', rotations, 4], ['weights', weights, 1],
  ]);
  return {
    name: 'track',
    samplers: outputs.map(([, values, size]) => ({ input, output: binary.add(values, size) })),
    channels: outputs.map(([path], sampler) => ({ sampler, target: { node: 0, path } })),
  };
}

/**
 * The file's bytes.
 * @param {Head} head
 * @param {Motion} motion
 * @param {Camera} camera At the origin.
 * @param {string} generator What made the file.
 */
export function glb(head, motion, camera, generator) {
  const binary = new Binary();
  const first = (/** @type {Float32Array} */ values, /** @type {number} */ size) =>
    Array.from(values.subarray(0, size));
  const text = JSON.stringify({
    asset: { version: '2.0', generator },
    scene: 0,
    scenes: [{ name: 'scene', nodes: [0, 1] }],
    nodes: [
      {
        name: 'head',
        mesh: 0,
        translation: first(motion.translations, 3),
        rotation: first(motion.rotations, 4),
        weights: first(motion.weights, head.shapes.length),
      },
      { name: 'camera', camera: 0 },
    ],
    cameras: [
      { name: 'camera', type: 'perspective', perspective: { ...camera, znear: NEAREST_M } },
    ],
    meshes: [meshOf(binary, head)],
    // It is a mask: seen from behind it has an inside.
    materials: [{ name: 'head', pbrMetallicRoughness: PLASTER, doubleSided: true }],
    animations: [animationOf(binary, motion)],
    buffers: [{ byteLength: binary.byteLength }],
    bufferViews: binary.views,
    accessors: binary.accessors,
  });
  const json = new TextEncoder().encode(text);
  const jsonLength = 4 * Math.ceil(json.length / 4);
  const file = new Uint8Array(12 + 8 + jsonLength + 8 + binary.byteLength);
  const view = new DataView(file.buffer);
  const words = (/** @type {number} */ at, /** @type {number[]} */ ...values) =>
    values.forEach((value, i) => view.setUint32(at + 4 * i, value, true));
  words(0, MAGIC, 2, file.length, jsonLength, JSON_CHUNK);
  // JSON is filled up with spaces.
  file.fill(0x20, 20, 20 + jsonLength);
  file.set(json, 20);
  words(20 + jsonLength, binary.byteLength, BINARY_CHUNK);
  let at = 28 + jsonLength;
  for (const part of binary.parts) {
    file.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), at);
    at += 4 * Math.ceil(part.byteLength / 4);
  }
  return file;
}
