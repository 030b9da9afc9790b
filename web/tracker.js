// The tracker. Each method calls the function of the same name in include/posewise.h.

import { Handle } from './handle.js';
import {
  ANIMATIONS, EVENT, FACE, HINT, IDENTITY_RECORD_SIZE, INTRINSICS, LANDMARK, LANDMARKS, LENS,
  LIKENESSES, MESH_LINES, MESH_NEUTRAL, MESH_SPACES, MESH_TOPOLOGY, MESH_VERTEX, MESH_VERTICES,
  MONITOR_OBSERVATION, RESULT, ROI, UNREAD_EVENTS,
} from './layout.js';

/** @typedef {import('./engine.js').Frame} Frame */
/** @typedef {import('./layout.js').Face} Face */
/** @typedef {import('./layout.js').FaceEvent} FaceEvent */
/** @typedef {import('./layout.js').Hint} Hint */
/** @typedef {import('./layout.js').Intrinsics} Intrinsics */
/** @typedef {import('./layout.js').Landmark} Landmark */
/** @typedef {import('./layout.js').Lens} Lens */
/** @typedef {import('./layout.js').Likeness} Likeness */
/** @typedef {import('./layout.js').Observation} Observation */
/** @typedef {import('./layout.js').Result} Result */
/** @typedef {import('./layout.js').Roi} Roi */

/** @typedef {import('./layout.js').MeshLine} MeshLine */
/** @typedef {import('./layout.js').MeshSpace} MeshSpace */

/**
 * How the vertices of a mesh are joined, the same for every face.
 * @typedef {object} MeshTables
 * @property {Uint16Array} triangles Three vertices of each triangle, counter-clockwise as seen from
 *   outside of the face.
 * @property {Float32Array} uvs Place of each vertex in a texture of the face, 0..1: u to the right,
 *   v upwards.
 * @property {Record<MeshLine, Uint16Array>} lines Vertices of lines; `landmarks` are those of iBUG
 *   68. Of a loop the last is joined to the first.
 */

// Most faces of one call of detect().
const MOST_FACES = 16;

/** Follows one face. Made by {@link Engine.createTracker}. */
export class Tracker extends Handle {
  /**
   * Processes one frame. Timestamps are the camera's, and increase.
   * @param {Frame} frame
   * @param {number} timestampUs
   * @returns {Result}
   */
  step(frame, timestampUs) {
    return this.read(RESULT, 'step', this.engine.writeFrame(frame, timestampUs));
  }

  /**
   * As {@link step}, for a caller who knows about where a face is.
   * @param {Frame} frame
   * @param {number} timestampUs
   * @param {Hint} hint
   * @returns {Result}
   */
  stepAt(frame, timestampUs, hint) {
    const at = this.engine.writeFrame(frame, timestampUs);
    return this.read(RESULT, 'step_at', at, this.write(HINT, hint));
  }

  /**
   * Lists faces of a frame, the largest first; bounded work, so that several calls may be needed.
   * @param {Frame} frame
   * @returns {{ faces: Face[], finished: boolean }}
   */
  detect(frame) {
    const at = this.engine.writeFrame(frame, 0);
    const { found, other } = this.readList(FACE, 'detect', MOST_FACES, at);
    return { faces: found, finished: other === 1 };
  }

  /**
   * The last result, smoothed.
   * @returns {Result}
   */
  smoothed() {
    return this.read(RESULT, 'smoothed');
  }

  /**
   * The dense mesh of the face of the last step: x, y, z and visibility of each vertex. In the
   * picture z is in mm along the camera's axis. While searching, or with a model without a mesh, it
   * is an error.
   * @param {MeshSpace} [space]
   */
  mesh(space = 'picture') {
    const index = MESH_SPACES.indexOf(space);
    if (index < 0) throw new TypeError(`space must be one of ${MESH_SPACES}, not ${space}`);
    return this.#vertices('mesh', index);
  }

  /**
   * The person's own head in the head frame [mm], as {@link mesh}, with visibility 1: the neutral
   * face, or that face with one animation weight at 1. A face with any weights is the neutral one
   * plus each weight times what its shape differs by. The identity is that of the last fit, so it
   * outlives the loss of the face. Before the first face it is an error.
   * @param {string} [shape] `neutral`, or one of Engine.animationNames.
   */
  meshShape(shape = 'neutral') {
    const index = this.engine.animationNames.indexOf(shape);
    if (index < 0 && shape !== 'neutral') {
      throw new TypeError(`shape must be neutral or one of animationNames, not ${shape}`);
    }
    return this.#vertices('mesh_shape', index < 0 ? MESH_NEUTRAL : index);
  }

  /**
   * @param {string} name
   * @param {number} index
   */
  #vertices(name, index) {
    const at = this.engine.scratch;
    this.call(name, index, at + 16, MESH_VERTICES, at);
    const count = this.engine.view.getUint32(at, true);
    return new Float32Array(this.engine.memory, at + 16, (count * MESH_VERTEX.size) / 4).slice();
  }

  /**
   * How the vertices of its mesh are joined.
   * @returns {MeshTables}
   */
  meshTables() {
    const tables = this.read(MESH_TOPOLOGY, 'mesh_tables');
    const { memory } = this.engine;
    const { lineStarts } = tables;
    const lines = new Uint16Array(memory, tables.lines, lineStarts[MESH_LINES.length]);
    const line = (/** @type {number} */ i) => lines.slice(lineStarts[i], lineStarts[i + 1]);
    return {
      triangles: new Uint16Array(memory, tables.triangles, 3 * tables.triangleCount).slice(),
      uvs: new Float32Array(memory, tables.uvs, 2 * tables.vertexCount).slice(),
      lines: /** @type {MeshTables['lines']} */ (
        Object.fromEntries(MESH_LINES.map((name, i) => [name, line(i)]))),
    };
  }

  /**
   * What a driver monitor needs of the last step.
   * @returns {Observation}
   */
  observation() {
    return this.read(MONITOR_OBSERVATION, 'monitor_observe');
  }

  /**
   * @param {string} name
   * @returns {Landmark[]}
   */
  #landmarks(name) {
    this.call(name, this.engine.scratch, LANDMARKS);
    return this.list(LANDMARK, this.engine.scratch, LANDMARKS);
  }

  /** The 68 landmarks of the last step. */
  landmarks() {
    return this.#landmarks('landmarks');
  }

  /** The same, smoothed. */
  smoothedLandmarks() {
    return this.#landmarks('smoothed_landmarks');
  }

  /** @param {string} name */
  #weights(name) {
    this.call(name, this.engine.scratch, ANIMATIONS);
    return new Float32Array(this.engine.memory, this.engine.scratch, ANIMATIONS).slice();
  }

  /** The animation weights of the last step; Engine.animationNames has their names. */
  animation() {
    return this.#weights('animation');
  }

  /** The same, smoothed. */
  smoothedAnimation() {
    return this.#weights('smoothed_animation');
  }

  /**
   * The events that were not read yet.
   * @returns {{ events: FaceEvent[], overwritten: number }}
   */
  events() {
    const { found, other } = this.readList(EVENT, 'events', UNREAD_EVENTS);
    return { events: found, overwritten: other };
  }

  /**
   * Keeps this tracker from faces that others follow.
   * @param {[number, number, number, number][]} boxes x, y, width, height [px].
   */
  setExcluded(boxes) {
    const at = this.engine.scratch;
    if (boxes.some((box) => box.length !== 4)) throw new TypeError('a box must have 4 numbers');
    // The library refuses more than it has room for, whatever they are.
    const numbers = boxes.slice(0, 64).flat();
    new Float32Array(this.engine.memory, at, numbers.length).set(numbers);
    this.call('set_excluded', at, boxes.length);
  }

  /** @param {Roi | null} roi null: the whole frame. */
  setRoi(roi) {
    this.call('set_roi', roi ? this.write(ROI, roi) : 0);
  }

  /** @param {Intrinsics | null} intrinsics null: a field of view of 60 degrees. */
  setIntrinsics(intrinsics) {
    this.call('set_intrinsics', intrinsics ? this.write(INTRINSICS, intrinsics) : 0);
  }

  /** @param {Lens | null} lens null: none. */
  setLens(lens) {
    this.call('set_lens', lens ? this.write(LENS, lens) : 0);
  }

  /** Forgets the face, its identity and the time, as for another video. */
  reset() {
    this.call('reset');
  }

  /** Forgets the identity, as when somebody else sits down. */
  forgetIdentity() {
    this.call('forget_identity');
  }

  /**
   * What was learnt of the person's head, for {@link restoreIdentity} when the person is back.
   * Before the first trusted frame it is an error.
   * @returns {Uint8Array}
   */
  saveIdentity() {
    return this.readRecord('save_identity', IDENTITY_RECORD_SIZE);
  }

  /**
   * Guesses that this face, and every new one, is that of a record, until enough was seen.
   * @param {Uint8Array} record
   */
  restoreIdentity(record) {
    this.callWithRecord('restore_identity', record, IDENTITY_RECORD_SIZE);
  }

  /**
   * Whether the head has the shape of that of a record. It is no identification: two people may
   * have heads of one shape.
   * @param {Uint8Array} record
   * @returns {Likeness}
   */
  compareIdentity(record) {
    const out = this.engine.scratch;
    this.callWithRecord('compare_identity', record, IDENTITY_RECORD_SIZE, out);
    return LIKENESSES[this.engine.view.getUint32(out, true)];
  }
}
