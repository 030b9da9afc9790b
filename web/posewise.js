// A face tracker in a worker: pictures in, poses out. See README.md.

import { PosewiseError } from './engine.js';

export { Engine, PosewiseError, Tracker, hasSimd, load, moduleName } from './engine.js';
export { frameOf } from './luma.js';

/** @typedef {import('./engine.js').Frame} Frame */
/** @typedef {import('./layout.js').Config} Config */
/** @typedef {import('./layout.js').Intrinsics} Intrinsics */
/** @typedef {import('./layout.js').Lens} Lens */
/** @typedef {import('./layout.js').Roi} Roi */
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
 */

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
  static async create({ worker, config = {}, ...source } = {}) {
    worker ??= startWorker();
    const tracker = new FaceTracker(worker);
    // Addresses are those that the page would use.
    const absolute = Object.entries(source).map(([name, value]) =>
      [name, typeof value === 'string' ? new URL(value, document.baseURI).href : value]);
    const created = await tracker.#call('create', [Object.fromEntries(absolute), config]);
    Object.assign(tracker, created);
    return tracker;
  }

  /** @param {Worker} worker */
  constructor(worker) {
    this.#worker = worker;
    /** @type {string[]} Names of the animation weights, ARKit's. */
    this.animationNames = [];
    /** @type {import('./engine.js').ModelInfo | undefined} What the model says of itself. */
    this.model = undefined;
    /** @type {string[]} The optional parts that the library was built with. */
    this.parts = [];
    worker.onmessage = ({ data: { id, value, error } }) => {
      const waiting = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error) waiting?.reject(new PosewiseError(error.status, error.message));
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
   * Tracks the face in a picture. Timestamps increase from call to call.
   * @param {Picture} picture
   * @param {number} timestampUs When the camera took it, on any monotonic clock [us].
   * @returns {Promise<Tracked>}
   */
  async track(picture, timestampUs) {
    if ('data' in picture) {
      const isCanvas = typeof ImageData !== 'undefined' && picture instanceof ImageData;
      const { data, width, height } = picture;
      const frame = isCanvas ? { data, width, height, format: 'AB24' } : picture;
      return this.#call('track', [frame, timestampUs]);
    }
    const isElement = picture instanceof HTMLElement;
    const sent = isElement ? await grabbed(picture, timestampUs) : picture;
    const answer = this.#call('track', [sent, timestampUs], [sent]);
    // What was sent is no longer here; what could not be sent is not needed.
    sent.close();
    return answer;
  }

  /** Forgets the face, its identity and the time, as for another video. */
  async reset() {
    await this.#call('reset', []);
  }

  /** Forgets the identity, as when somebody else sits down. */
  async forgetIdentity() {
    await this.#call('forgetIdentity', []);
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
