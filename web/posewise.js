// A face tracker in a worker: pictures in, poses out. See README.md.

import { PosewiseError } from './engine.js';

export { Engine, PosewiseError, hasRelaxedSimd, hasSimd, load, moduleName } from './engine.js';
export { Group } from './group.js';
export { frameOf } from './luma.js';
export { Monitor } from './monitor.js';
export { Tracker } from './tracker.js';

/** @typedef {import('./engine.js').Frame} Frame */
/** @typedef {import('./engine.js').ModelInfo} ModelInfo */
/** @typedef {import('./layout.js').Config} Config */
/** @typedef {import('./layout.js').Face} Face */
/** @typedef {import('./layout.js').FaceEvent} FaceEvent */
/** @typedef {import('./layout.js').Hint} Hint */
/** @typedef {import('./layout.js').Intrinsics} Intrinsics */
/** @typedef {import('./layout.js').Landmark} Landmark */
/** @typedef {import('./layout.js').Lens} Lens */
/** @typedef {import('./layout.js').Likeness} Likeness */
/** @typedef {import('./layout.js').MonitorConfig} MonitorConfig */
/** @typedef {import('./layout.js').MonitorEvent} MonitorEvent */
/** @typedef {import('./layout.js').MonitorState} MonitorState */
/** @typedef {import('./layout.js').Observation} Observation */
/** @typedef {import('./layout.js').Result} Result */
/** @typedef {import('./layout.js').Roi} Roi */
/** @typedef {import('./layout.js').MeshSpace} MeshSpace */
/** @typedef {import('./monitor.js').Zone} Zone */
/** @typedef {import('./tracker.js').MeshTables} MeshTables */
/** @typedef {import('./worker.js').Tracked} Tracked */

/**
 * What can be tracked. A VideoFrame and an ImageBitmap are closed; a video is read where it is.
 * @typedef {Frame | VideoFrame | ImageBitmap | HTMLVideoElement | HTMLCanvasElement | ImageData}
 *   Picture
 *
 * @typedef {object} Options
 * @property {import('./engine.js').LoadOptions['wasm']} [wasm] As in load().
 * @property {import('./engine.js').LoadOptions['model']} [model] As in load().
 * @property {Worker} [worker] A worker that runs worker.js, from startWorker() or elsewhere.
 * @property {Config} [config] Settings of the tracker.
 * @property {MonitorConfig} [monitor] Settings of a driver monitor, `{}` for the usual ones.
 *   Without them there is none. Eyes are known best with the tracker's `gaze`.
 * @property {Zone[]} [zones] The monitor's zones, in place of those of its preset.
 */

/**
 * The error that a worker had.
 * @param {{ message: string, name: string, status?: number }} error
 */
function errorOf({ message, name, status }) {
  if (status !== undefined) return new PosewiseError(status, message);
  const kinds = { RangeError, TypeError };
  return new (kinds[/** @type {keyof typeof kinds} */ (name)] ?? Error)(message);
}

/** A worker that runs worker.js. It loads while the caller does something else. */
export function startWorker() {
  return new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
}

/** Follows one face in a worker. */
export class FaceTracker {
  #worker;
  #count = 0;
  /** @type {Promise<void> | undefined} Once there, no further call is sent. */
  #closing;
  /** @type {Map<number, { resolve: (value: any) => void, reject: (error: Error) => void }>} */
  #waiting = new Map();

  /**
   * Starts the worker and loads the model.
   * @param {Options} [options]
   */
  static async create({ worker, config = {}, monitor, zones, ...source } = {}) {
    worker ??= startWorker();
    const tracker = new FaceTracker(worker);
    // Addresses are those that the page would use.
    const absolute = Object.entries(source).map(([name, value]) =>
      [name, typeof value === 'string' ? new URL(value, document.baseURI).href : value]);
    const options = Object.fromEntries(absolute);
    const created = await tracker.#call('create', [options, config, monitor, zones]);
    Object.assign(tracker, created);
    return tracker;
  }

  /** @param {Worker} worker */
  constructor(worker) {
    this.#worker = worker;
    /** @type {string[]} Names of the animation weights, ARKit's. */
    this.animationNames = [];
    /** @type {string[]} Names of the weights of the gaze, Result.eyeLook, ARKit's. */
    this.eyeLookNames = [];
    /** @type {ModelInfo | undefined} What the model says of itself. */
    this.model = undefined;
    /** @type {string[]} The optional parts that the library was built with. */
    this.parts = [];
    /** Version of the library. */
    this.version = '';
    worker.onmessage = ({ data: { id, value, error } }) => {
      const waiting = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error) waiting?.reject(errorOf(error));
      else waiting?.resolve(value);
    };
    worker.onerror = (event) => this.#fail(new Error(event.message || 'the worker did not start'));
  }

  /** @param {Error} error */
  #fail(error) {
    for (const { reject } of this.#waiting.values()) reject(error);
    this.#waiting.clear();
  }

  /**
   * @param {string} call
   * @param {any[]} args
   * @param {Transferable[]} [transfer]
   * @returns {Promise<any>}
   */
  #call(call, args, transfer = []) {
    return new Promise((resolve, reject) => {
      if (this.#closing) throw new Error('the tracker is closed');
      const id = this.#count++;
      // First, because it throws for what cannot be sent. No answer comes before this has ended.
      this.#worker.postMessage({ id, call, args }, transfer);
      this.#waiting.set(id, { resolve, reject });
    });
  }

  /** Frames that were not answered yet. A caller with a camera drops frames while it is not 0. */
  get pending() {
    return this.#waiting.size;
  }

  /**
   * Sends a picture with a call.
   * @param {string} call
   * @param {Picture} picture
   * @param {number} timestampUs
   * @param {...any} args
   */
  async #send(call, picture, timestampUs, ...args) {
    if ('data' in picture) {
      const isCanvas = typeof ImageData !== 'undefined' && picture instanceof ImageData;
      const { data, width, height } = picture;
      const frame = isCanvas ? { data, width, height, format: 'AB24' } : picture;
      return this.#call(call, [frame, ...args]);
    }
    const isElement = picture instanceof HTMLElement;
    const sent = isElement ? await grabbed(picture, timestampUs) : picture;
    const answer = this.#call(call, [sent, ...args], [sent]);
    // What was sent is no longer here; what could not be sent is not needed.
    sent.close();
    return answer;
  }

  /**
   * Tracks the face in a picture. Timestamps increase from call to call.
   * @param {Picture} picture
   * @param {number} timestampUs When the camera took it, on any monotonic clock [us].
   * @param {Hint} [hint] Where a face is expected.
   * @returns {Promise<Tracked>}
   */
  track(picture, timestampUs, hint) {
    return this.#send('track', picture, timestampUs, timestampUs, hint);
  }

  /**
   * Lists faces of a picture, the largest first; bounded work, so that several calls may be needed.
   * @param {Picture} picture
   * @returns {Promise<{ faces: Face[], finished: boolean }>}
   */
  detect(picture) {
    return this.#send('detect', picture, 0);
  }

  /**
   * The dense mesh of the face of the last picture: x, y, z and visibility of each vertex.
   * @param {MeshSpace} [space]
   * @returns {Promise<Float32Array>}
   */
  mesh(space) {
    return this.#call('mesh', [space]);
  }

  /**
   * The person's own head in the head frame [mm], as {@link mesh}: the neutral face, or that face
   * with one animation weight at 1, for morph targets. It outlives the loss of the face.
   * @param {string} [shape] `neutral`, or one of animationNames.
   * @returns {Promise<Float32Array>}
   */
  meshShape(shape) {
    return this.#call('meshShape', [shape]);
  }

  /**
   * How the vertices of its mesh are joined.
   * @returns {Promise<MeshTables>}
   */
  meshTables() {
    return this.#call('meshTables', []);
  }

  /** Forgets the face, its identity and the time, as for another video. */
  async reset() {
    await this.#call('reset', []);
  }

  /** Forgets the identity, as when somebody else sits down. */
  async forgetIdentity() {
    await this.#call('forgetIdentity', []);
  }

  /**
   * What was learnt of the person's head, for {@link restoreIdentity} when the person is back.
   * @returns {Promise<Uint8Array>}
   */
  saveIdentity() {
    return this.#call('saveIdentity', []);
  }

  /**
   * Guesses that this face, and every new one, is that of a record, until enough was seen.
   * @param {Uint8Array} record
   */
  async restoreIdentity(record) {
    await this.#call('restoreIdentity', [record]);
  }

  /**
   * Whether the head has the shape of that of a record. It is no identification: two people may
   * have heads of one shape.
   * @param {Uint8Array} record
   * @returns {Promise<Likeness>}
   */
  compareIdentity(record) {
    return this.#call('compareIdentity', [record]);
  }

  /** @param {Roi | null} roi Where faces are looked for; null: the whole frame. */
  async setRoi(roi) {
    await this.#call('setRoi', [roi]);
  }

  /** @param {Intrinsics | null} intrinsics null: a field of view of 60 degrees. */
  async setIntrinsics(intrinsics) {
    await this.#call('setIntrinsics', [intrinsics]);
  }

  /** @param {Lens | null} lens null: none. */
  async setLens(lens) {
    await this.#call('setLens', [lens]);
  }

  /**
   * Keeps this tracker from faces that others follow.
   * @param {[number, number, number, number][]} boxes x, y, width, height [px].
   */
  async setExcluded(boxes) {
    await this.#call('setExcluded', [boxes]);
  }

  /**
   * Replaces the zones of the monitor; times in zones begin anew.
   * @param {Zone[]} zones
   */
  async setZones(zones) {
    await this.#call('setZones', [zones]);
  }

  /** Tells the monitor that another person drives. */
  async forgetDriver() {
    await this.#call('forgetDriver', []);
  }

  /** Ends the worker when it has answered what was asked before. Later calls are rejected. */
  close() {
    this.#closing ??= this.#call('close', []).then(() => this.#worker.terminate());
    return this.#closing;
  }
}

/**
 * The picture that an element shows now.
 * @param {HTMLVideoElement | HTMLCanvasElement} element
 * @param {number} timestampUs
 * @returns {Promise<VideoFrame | ImageBitmap>}
 */
export async function grabbed(element, timestampUs) {
  if (typeof VideoFrame === 'undefined') return createImageBitmap(element);
  return new VideoFrame(element, { timestamp: Math.trunc(timestampUs) });
}
