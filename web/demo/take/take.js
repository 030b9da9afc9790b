// A take: a keyframe of the tracked head for each frame, in the axes of 3D programs.

import { findNormals } from '../normals.js';
import { glb } from './glb.js';

/** @typedef {import('../../tracker.js').MeshTables} MeshTables */
/** @typedef {import('../../worker.js').Tracked} Tracked */

/** The longest take [s]. */
export const LONGEST_S = 600;

/**
 * Half a turn about x, from the tracker's axes to those of 3D programs.
 * @param {ArrayLike<number>} vector Or a quaternion x, y, z, w.
 */
function turned({ 0: x, 1: y, 2: z }) {
  return [x, -y, -z];
}

/**
 * A point in the axes of 3D programs [m].
 * @param {ArrayLike<number>} point [mm]
 */
function metres(point) {
  return turned(point).map((v) => v / 1000);
}

/**
 * Places and normals.
 * @param {Float32Array} mesh x, y, z [mm] and visibility of each vertex, head frame.
 * @param {Uint16Array} triangles
 */
function surfaceOf(mesh, triangles) {
  const count = mesh.length / 4;
  const places = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) places.set(metres(mesh.subarray(4 * i, 4 * i + 3)), 3 * i);
  const normals = new Float32Array(3 * count);
  findNormals(places, triangles, normals);
  return { places, normals };
}

/**
 * The person's own head, as a tracker gives it.
 * @typedef {object} Person
 * @property {Float32Array} neutral x, y, z and visibility of each vertex, head frame.
 * @property {{ name: string, mesh: Float32Array }[]} shapes With each weight at 1.
 * @property {MeshTables} tables
 *
 * @typedef {object} Key
 * @property {number[]} translation [m]
 * @property {number[]} rotation x, y, z, w
 * @property {Float32Array} weights
 */

export class Take {
  /** @type {number | undefined} */
  #startUs;
  /** @type {number[]} Since the first frame [s], increasing. */
  #times = [];
  /** @type {Key[]} As many as times, once there was a face. */
  #keys = [];

  /** From the first frame to the last [s]. */
  get seconds() {
    return this.#times.at(-1) ?? 0;
  }

  /** Whether a face was seen. */
  get hasFace() {
    return this.#keys.length > 0;
  }

  /** Whether a longer take is too long. */
  get isFull() {
    return this.seconds >= LONGEST_S;
  }

  /**
   * Adds a frame. Without a face the head stays where it was last; before the first face it waits
   * where that will be. What is too long is left out.
   * @param {Pick<Tracked, 'result' | 'animation'>} tracked
   */
  add({ result, animation }) {
    const { timestampUs } = result;
    this.#startUs ??= timestampUs;
    const time = Math.fround((timestampUs - this.#startUs) / 1e6);
    const last = this.#times.at(-1);
    if (time > LONGEST_S || (last !== undefined && time <= last)) return;
    this.#times.push(time);
    const isFace = result.state !== 'searching';
    const key = isFace ? this.#keyOf(result, animation) : this.#keys.at(-1);
    while (key && this.#keys.length < this.#times.length) this.#keys.push(key);
  }

  /**
   * @param {import('../../layout.js').Result} result
   * @param {Float32Array} weights
   * @returns {Key}
   */
  #keyOf({ rotation: ours, translationMm }, weights) {
    const rotation = [...turned(ours), ours[3]];
    // Of the two quaternions of a rotation, the one nearer to the last: all players then take the
    // short way.
    const last = this.#keys.at(-1)?.rotation ?? rotation;
    const isFar = rotation.reduce((sum, v, i) => sum + v * last[i], 0) < 0;
    return {
      translation: metres(translationMm),
      rotation: isFar ? rotation.map((v) => -v) : rotation,
      weights,
    };
  }

  /**
   * The take as a .glb. There was a face.
   * @param {Person} person
   * @param {{ width: number, height: number, fx: number, fy: number }} camera [px]
   * @param {string} version Of the library.
   */
  glb({ neutral, shapes, tables }, { width, height, fx, fy }, version) {
    const { triangles, uvs } = tables;
    const head = {
      neutral: surfaceOf(neutral, triangles),
      shapes: shapes.map(({ name, mesh }) => ({ name, surface: surfaceOf(mesh, triangles) })),
      // From the top of the texture downwards.
      uvs: uvs.map((v, i) => (i % 2 ? 1 - v : v)),
      triangles,
    };
    const flat = (/** @type {(key: Key) => ArrayLike<number>} */ part) =>
      Float32Array.from(this.#keys.flatMap((key) => Array.from(part(key))));
    const motion = {
      times: Float32Array.from(this.#times),
      translations: flat((key) => key.translation),
      rotations: flat((key) => key.rotation),
      weights: flat((key) => key.weights),
    };
    const yfov = 2 * Math.atan(height / (2 * fy));
    const lens = { yfov, aspectRatio: width / fx / (height / fy) };
    return glb(head, motion, lens, `posewise ${version}`);
  }
}
