// Runs a tracker in a worker. Messages are { id, call, args }; answers { id, value } or
// { id, error }. Calls are carried out one after the other.

// engine.js imports these too. Named here, they are fetched while engine.js arrives, not after.
import './handle.js';
import './layout.js';
import './monitor.js';
import './struct.js';
import './tracker.js';
import { load } from './engine.js';
import { frameOf } from './luma.js';

/** @typedef {import('./monitor.js').Monitor} Monitor */
/** @typedef {import('./tracker.js').Tracker} Tracker */
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
 * @property {Watched} [monitor] What the monitor says, where there is one.
 * @property {number} width Width of the frame [px].
 * @property {number} height Height of the frame [px].
 * @property {number} stepMs Time that the tracker took [ms].
 * @property {number} pixelsMs Time until its pixels were there [ms].
 * @property {import('./layout.js').Intrinsics} [camera] Where it is not the one that the tracker
 *   assumes.
 */

/**
 * What a driver monitor says of a frame.
 * @typedef {object} Watched
 * @property {import('./layout.js').MonitorState} state
 * @property {import('./layout.js').MonitorEvent[]} events Those since the last frame.
 */

/** @type {Tracker} */
let tracker;
/** @type {Monitor | undefined} */
let monitor;

/** The monitor, for a call that needs one. */
function needed() {
  if (!monitor) throw new Error('the tracker was made without a monitor');
  return monitor;
}

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
   * @param {import('./layout.js').MonitorConfig} [watch] Without it there is no monitor.
   * @param {import('./monitor.js').Zone[]} [zones]
   */
  async create(options, config, watch, zones) {
    const engine = await load(options);
    tracker = engine.createTracker(config);
    monitor = watch && engine.createMonitor(watch, zones);
    const { animationNames, eyeLookNames, model, parts, version } = engine;
    return { animationNames, eyeLookNames, model, parts, version };
  },

  /**
   * @param {Frame | VideoFrame | ImageBitmap} picture
   * @param {number} timestampUs
   * @param {import('./layout.js').Hint} [hint]
   * @returns {Promise<Tracked>}
   */
  async track(picture, timestampUs, hint) {
    const start = performance.now();
    const frame = 'data' in picture ? picture : await pixelsOf(picture);
    const ready = performance.now();
    const result = hint
      ? tracker.stepAt(frame, timestampUs, hint)
      : tracker.step(frame, timestampUs);
    const stepMs = performance.now() - ready;
    monitor?.update(tracker.observation(), timestampUs);
    const turned = (frame.rotationDeg ?? 0) % 180 !== 0;
    return {
      result,
      smoothed: tracker.smoothed(),
      landmarks: tracker.landmarks(),
      smoothedLandmarks: tracker.smoothedLandmarks(),
      animation: tracker.animation(),
      smoothedAnimation: tracker.smoothedAnimation(),
      events: tracker.events().events,
      monitor: monitor && { state: monitor.state(), events: monitor.events().events },
      width: turned ? frame.height : frame.width,
      height: turned ? frame.width : frame.height,
      stepMs,
      pixelsMs: ready - start,
    };
  },

  /** @param {Frame | VideoFrame | ImageBitmap} picture */
  async detect(picture) {
    return tracker.detect('data' in picture ? picture : await pixelsOf(picture));
  },

  /** Answered after everything before it. */
  close() {},
  reset: () => tracker.reset(),
  forgetIdentity: () => tracker.forgetIdentity(),
  saveIdentity: () => tracker.saveIdentity(),
  restoreIdentity: (record) => tracker.restoreIdentity(record),
  compareIdentity: (record) => tracker.compareIdentity(record),
  setRoi: (roi) => tracker.setRoi(roi),
  setIntrinsics: (intrinsics) => tracker.setIntrinsics(intrinsics),
  setLens: (lens) => tracker.setLens(lens),
  setExcluded: (boxes) => tracker.setExcluded(boxes),
  mesh: (space) => tracker.mesh(space),
  meshShape: (shape) => tracker.meshShape(shape),
  meshTables: () => tracker.meshTables(),
  setZones: (zones) => needed().setZones(zones),
  forgetDriver: () => needed().forgetDriver(),
};

/** @type {Promise<void>} */
let last = Promise.resolve();

addEventListener('message', ({ data: { id, call, args } }) => {
  last = last.then(async () => {
    try {
      postMessage({ id, value: await CALLS[call](...args) });
    } catch (error) {
      const { message = String(error), name, status } = /** @type {any} */ (error);
      postMessage({ id, error: { message, name, status } });
    }
  });
});
