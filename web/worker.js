// Runs a tracker in a worker. Messages are { id, call, args }; answers { id, value } or
// { id, error }. Calls are carried out one after the other.

// engine.js imports these too. Named here, they are fetched while engine.js arrives, not after.
import './layout.js';
import './struct.js';
import { load } from './engine.js';
import { frameOf } from './luma.js';

/** @typedef {import('./engine.js').Engine} Engine */
/** @typedef {import('./engine.js').Tracker} Tracker */
/** @typedef {import('./engine.js').Frame} Frame */

/**
 * What a frame gave.
 * @typedef {object} Tracked
 * @property {import('./layout.js').Result} result
 * @property {import('./layout.js').Result} smoothed
 * @property {import('./layout.js').Landmark[]} landmarks
 * @property {import('./layout.js').Landmark[]} smoothedLandmarks
 * @property {Float32Array} animation
 * @property {Float32Array} smoothedAnimation
 * @property {import('./layout.js').FaceEvent[]} events Those since the last frame.
 * @property {number} width Width of the frame [px].
 * @property {number} height Height of the frame [px].
 * @property {number} stepMs Time that the tracker took [ms].
 * @property {number} pixelsMs Time until its pixels were there [ms].
 * @property {import('./layout.js').Intrinsics} [camera] Where it is not the one that the tracker
 *   assumes.
 */

/** @type {Engine} */
let engine;
/** @type {Tracker} */
let tracker;

/**
 * The pixels of a picture, which is closed: browsers have few frames of a camera.
 * @param {VideoFrame | ImageBitmap} picture
 */
async function pixelsOf(picture) {
  try {
    return await frameOf(picture);
  } finally {
    picture.close();
  }
}

/** @type {Record<string, (...args: any[]) => any>} */
const CALLS = {
  /**
   * @param {import('./engine.js').LoadOptions} options
   * @param {import('./layout.js').Config} config
   */
  async create(options, config) {
    engine = await load(options);
    tracker = engine.createTracker(config);
    const { animationNames, model, parts } = engine;
    return { animationNames, model, parts };
  },

  /**
   * @param {Frame | VideoFrame | ImageBitmap} picture
   * @param {number} timestampUs
   * @returns {Promise<Tracked>}
   */
  async track(picture, timestampUs) {
    const start = performance.now();
    const frame = 'data' in picture ? picture : await pixelsOf(picture);
    const ready = performance.now();
    const result = tracker.step(frame, timestampUs);
    const stepMs = performance.now() - ready;
    const turned = (frame.rotationDeg ?? 0) % 180 !== 0;
    return {
      result,
      smoothed: tracker.smoothed(),
      landmarks: tracker.landmarks(),
      smoothedLandmarks: tracker.smoothedLandmarks(),
      animation: tracker.animation(),
      smoothedAnimation: tracker.smoothedAnimation(),
      events: tracker.events().events,
      width: turned ? frame.height : frame.width,
      height: turned ? frame.width : frame.height,
      stepMs,
      pixelsMs: ready - start,
    };
  },

  /** Answered after everything before it. */
  close() {},
  reset: () => tracker.reset(),
  forgetIdentity: () => tracker.forgetIdentity(),
  setRoi: (roi) => tracker.setRoi(roi),
  setIntrinsics: (intrinsics) => tracker.setIntrinsics(intrinsics),
  setLens: (lens) => tracker.setLens(lens),
};

/** @type {Promise<void>} */
let last = Promise.resolve();

addEventListener('message', ({ data: { id, call, args } }) => {
  last = last.then(async () => {
    try {
      postMessage({ id, value: await CALLS[call](...args) });
    } catch (error) {
      const { message = String(error), status } = /** @type {any} */ (error);
      postMessage({ id, error: { message, status } });
    }
  });
});
