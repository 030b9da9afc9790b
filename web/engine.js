// The library in WebAssembly: no worker and no DOM, so it runs in Node and in any worker too.
// Each method calls the function of the same name in include/posewise.h, which has the details.

import {
  ABI, ALIGN, ANIMATIONS, CONFIG, EVENT, EYE_LOOKS, FACE, FORMATS, FRAME, HINT, INTRINSICS,
  LANDMARK, LANDMARKS, LENS, MODEL_DETAILS, PARTS, RESULT, ROI, STATUS, UNREAD_EVENTS,
} from './layout.js';
import { clearStruct, readStruct, writeStruct } from './struct.js';

/** @typedef {import('./layout.js').Config} Config */
/** @typedef {import('./layout.js').Face} Face */
/** @typedef {import('./layout.js').FaceEvent} FaceEvent */
/** @typedef {import('./layout.js').Hint} Hint */
/** @typedef {import('./layout.js').Intrinsics} Intrinsics */
/** @typedef {import('./layout.js').Landmark} Landmark */
/** @typedef {import('./layout.js').Lens} Lens */
/** @typedef {import('./layout.js').Result} Result */
/** @typedef {import('./layout.js').Roi} Roi */
/** @typedef {import('./struct.js').Layout} Layout */

/** @typedef {keyof typeof FORMATS} Format */

/**
 * The pixels of one camera frame.
 * @typedef {object} Frame
 * @property {Uint8Array | Uint8ClampedArray} data From the first byte of the first row on.
 * @property {number} width Stored width [px].
 * @property {number} height Stored height [px].
 * @property {Format} [format] `GREY` unless it is given; a canvas has `AB24`.
 * @property {number} [stride] Bytes from row to row; without it, rows have no gaps.
 * @property {number} [rotationDeg] Clockwise rotation that makes it upright: 0, 90, 180 or 270.
 * @property {boolean} [mirrored] Whether rows are stored reversed, as in a selfie view.
 *
 * @typedef {object} LoadOptions
 * @property {WebAssembly.Module | BufferSource | string | URL} [wasm] The module, its bytes or its
 *   address. Without it: the one beside this file that suits the browser.
 * @property {BufferSource | string | URL} [model] A .posewise model or its address. Without it:
 *   posewise.posewise beside this file.
 */

/**
 * What a model says of itself.
 * @typedef {object} ModelInfo
 * @property {string} name As `posewise.posewise`; empty where it has none.
 * @property {import('./layout.js').Terms} terms What the terms of its training data allow.
 * @property {string} sheet Its data sheet, in Markdown.
 * @property {number} formatVersion Version of the model format.
 * @property {number} length Length [bytes].
 * @property {number} checksum CRC-32 by which models are told apart.
 * @property {string[]} sections Names of its sections.
 */

/** A call that the library rejected. */
export class PosewiseError extends Error {
  /**
   * @param {number} status
   * @param {string} text
   */
  constructor(status, text) {
    super(text);
    this.name = 'PosewiseError';
    /** The status by number, as in STATUS. */
    this.status = status;
  }
}

// Bytes for arguments and results: more than any list of structs takes.
const SCRATCH = 4096;

// A module with one instruction of 128-bit SIMD.
const SIMD_PROBE = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
  253, 98, 11,
];

/** Whether this browser has SIMD in WebAssembly. */
export function hasSimd() {
  return WebAssembly.validate(new Uint8Array(SIMD_PROBE));
}

/** The name of the module that suits this browser. */
export function moduleName() {
  return hasSimd() ? 'posewise-simd128.wasm' : 'posewise.wasm';
}

/**
 * The four characters of a section's name.
 * @param {number} number
 */
function sectionName(number) {
  return String.fromCharCode(...[0, 8, 16, 24].map((shift) => (number >>> shift) & 0xff));
}

/**
 * @param {string | URL} url
 * @returns {Promise<Response>}
 */
async function get(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response;
}

/** @param {LoadOptions['wasm']} wasm */
async function compile(wasm) {
  if (wasm instanceof WebAssembly.Module) return wasm;
  if (typeof wasm !== 'string' && !(wasm instanceof URL) && wasm) return WebAssembly.compile(wasm);
  const response = await get(wasm ?? new URL(moduleName(), import.meta.url));
  const isWasm = response.headers.get('content-type') === 'application/wasm';
  // A server that does not know the type would make the streaming compiler fail.
  if (isWasm) return WebAssembly.compileStreaming(response);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** @param {LoadOptions['model']} model */
async function modelBytes(model) {
  if (model instanceof ArrayBuffer) return new Uint8Array(model);
  if (ArrayBuffer.isView(model)) {
    return new Uint8Array(model.buffer, model.byteOffset, model.byteLength);
  }
  const response = await get(model ?? new URL('posewise.posewise', import.meta.url));
  return new Uint8Array(await response.arrayBuffer());
}

/**
 * Loads the library and a model.
 * @param {LoadOptions} [options]
 */
export async function load(options = {}) {
  const [module, model] = await Promise.all([compile(options.wasm), modelBytes(options.model)]);
  return new Engine(await WebAssembly.instantiate(module, {}), model);
}

/** The library with a model, which all of its trackers share. */
export class Engine {
  /** @type {any} */
  #exports;
  /** First byte that is not in use. */
  #end;
  #model;
  #modelLength;
  #frame = 0;
  #frameLength = 0;
  /** @type {number[]} */
  #freed = [];

  /**
   * @param {WebAssembly.Instance} instance
   * @param {Uint8Array} model
   */
  constructor(instance, model) {
    this.#exports = instance.exports;
    if (this.#exports.posewise_abi() !== ABI) throw new Error('module and layout.js differ');
    // What the module itself uses ends where its memory ends now.
    this.#end = this.memory.byteLength;
    this.#model = this.allocate(model.length);
    this.#modelLength = model.length;
    this.bytes(this.#model, model.length).set(model);
    /** Address of a place for one argument or result. */
    this.scratch = this.allocate(SCRATCH);
    /** @type {ModelInfo} What the model says of itself. */
    this.model = this.#checkedModel();
    /** The optional parts that the module was built with. */
    this.parts = Object.entries(PARTS)
      .filter(([, bit]) => this.call('parts') & bit)
      .map(([name]) => name);
    /** Names of the animation weights, ARKit's. */
    this.animationNames = Array.from({ length: ANIMATIONS }, (_, i) =>
      this.text(this.call('animation_name', i)));
    /** Names of the weights of the gaze, Result.eyeLook, ARKit's. */
    this.eyeLookNames = Array.from({ length: EYE_LOOKS }, (_, i) =>
      this.text(this.call('eye_look_name', i)));
  }

  /** WebAssembly's memory, which moves when it grows. */
  get memory() {
    return /** @type {ArrayBuffer} */ (this.#exports.memory.buffer);
  }

  /** @returns {DataView} */
  get view() {
    return new DataView(this.memory);
  }

  /**
   * @param {number} at
   * @param {number} length
   */
  bytes(at, length) {
    return new Uint8Array(this.memory, at, length);
  }

  /**
   * Takes memory that is never given back.
   * @param {number} size
   */
  allocate(size) {
    const start = Math.ceil(this.#end / ALIGN) * ALIGN;
    const lack = start + size - this.memory.byteLength;
    if (lack > 0) this.#exports.memory.grow(Math.ceil(lack / 65536));
    this.#end = start + size;
    return start;
  }

  /**
   * Calls a function of the C header.
   * @param {string} name
   * @param {...number} args
   * @returns {number}
   */
  call(name, ...args) {
    return this.#exports[`posewise_${name}`](...args);
  }

  /** @param {number} status */
  check(status) {
    if (status !== STATUS.OK) {
      throw new PosewiseError(status, this.text(this.call('strerror', status)));
    }
  }

  /** @returns {ModelInfo} */
  #checkedModel() {
    clearStruct(this.view, this.scratch, MODEL_DETAILS);
    this.check(this.call('model_info', this.#model, this.#modelLength, this.scratch));
    const info = readStruct(this.view, this.scratch, MODEL_DETAILS);
    /** @type {(at: number, length: number) => string} */
    const text = (at, length) => new TextDecoder().decode(this.bytes(at, length).slice());
    const status = this.call('model_check', this.#model, this.#modelLength);
    if (status !== STATUS.OK) {
      const section = info.wrongSection ? `${sectionName(info.wrongSection)}: ` : '';
      const check = `${section}${text(info.check, info.checkLen)}`;
      throw new PosewiseError(status, `${this.text(this.call('strerror', status))}: ${check}`);
    }
    const { terms, formatVersion, length, checksum } = info;
    return {
      name: text(info.name, info.nameLen),
      terms,
      sheet: text(info.sheet, info.sheetLen),
      formatVersion,
      length,
      checksum,
      sections: info.sections.slice(0, info.sectionCount).map(sectionName),
    };
  }

  /**
   * The C string at an address.
   * @param {number} at
   */
  text(at) {
    const rest = new Uint8Array(this.memory, at);
    return new TextDecoder().decode(rest.slice(0, rest.indexOf(0)));
  }

  /**
   * Writes a frame and its pixels, and gives its address.
   * @param {Frame} frame
   * @param {number} timestampUs
   */
  writeFrame(frame, timestampUs) {
    const { data, width, height, rotationDeg = 0 } = frame;
    const format = FORMATS[frame.format ?? 'GREY'];
    if (data.length > this.#frameLength) {
      // Twice the size, so that growing frames do not leave much unused memory behind.
      const length = this.#frameLength ? 2 * data.length : data.length;
      this.#frame = this.allocate(FRAME.size + length);
      // Only now: there may not be so much.
      this.#frameLength = length;
    }
    const pixels = this.#frame + FRAME.size;
    this.bytes(pixels, data.length).set(data);
    writeStruct(this.view, this.#frame, FRAME, {
      format, timestampUs, width, height, stride: frame.stride ?? width * bytesPerPixel(frame),
      rotationDeg, flags: frame.mirrored ? 1 : 0, dataLen: data.length, data: pixels,
    });
    return this.#frame;
  }

  /**
   * Makes a tracker.
   * @param {Config} [config]
   */
  createTracker(config = {}) {
    const size = this.call('memory_size', 0);
    writeStruct(this.view, this.scratch + 8, CONFIG, config);
    const memory = this.#freed.pop() ?? this.allocate(size);
    const status = this.call(
      'init', this.scratch, memory, size, this.#model, this.#modelLength, this.scratch + 8);
    if (status !== STATUS.OK) this.#freed.push(memory);
    this.check(status);
    return new Tracker(this, memory, () => this.#freed.push(memory));
  }
}

/** @param {Frame} frame */
function bytesPerPixel({ format = 'GREY' }) {
  if (/^(Y10|Y16|YUYV|UYVY)$/.test(format)) return 2;
  if (/^(RGB3|BGR3)$/.test(format)) return 3;
  return /24$/.test(format) ? 4 : 1;
}

/** Follows one face. Made by {@link Engine.createTracker}. */
export class Tracker {
  #engine;
  #at;
  #release;

  /**
   * @param {Engine} engine
   * @param {number} at
   * @param {() => void} release
   */
  constructor(engine, at, release) {
    this.#engine = engine;
    this.#at = at;
    this.#release = release;
  }

  /**
   * @param {string} name
   * @param {...number} args
   */
  #call(name, ...args) {
    this.#engine.check(this.#engine.call(name, this.#at, ...args));
  }

  /**
   * @param {Layout} layout
   * @param {number} at
   * @param {number} count
   * @returns {any[]}
   */
  #list(layout, at, count) {
    const view = this.#engine.view;
    return Array.from({ length: count }, (_, i) => readStruct(view, at + i * layout.size, layout));
  }

  /**
   * Writes a struct into the scratch memory, behind where results go, and gives its address.
   * @param {Layout} layout
   * @param {Record<string, any>} object
   */
  #write(layout, object) {
    const at = this.#engine.scratch + RESULT.size;
    writeStruct(this.#engine.view, at, layout, object);
    return at;
  }

  /**
   * @param {string} name
   * @param {...number} args
   * @returns {Result}
   */
  #result(name, ...args) {
    const at = this.#engine.scratch;
    clearStruct(this.#engine.view, at, RESULT);
    this.#call(name, ...args, at);
    return readStruct(this.#engine.view, at, RESULT);
  }

  /**
   * Processes one frame. Timestamps are the camera's, and increase.
   * @param {Frame} frame
   * @param {number} timestampUs
   */
  step(frame, timestampUs) {
    return this.#result('step', this.#engine.writeFrame(frame, timestampUs));
  }

  /**
   * As {@link step}, for a caller who knows about where a face is.
   * @param {Frame} frame
   * @param {number} timestampUs
   * @param {Hint} hint
   */
  stepAt(frame, timestampUs, hint) {
    const at = this.#engine.writeFrame(frame, timestampUs);
    return this.#result('step_at', at, this.#write(HINT, hint));
  }

  /**
   * Lists faces of a frame, the largest first; bounded work, so that several calls may be needed.
   * @param {Frame} frame
   * @returns {{ faces: Face[], finished: boolean }}
   */
  detect(frame) {
    const capacity = 16;
    const at = this.#engine.writeFrame(frame, 0);
    const out = this.#engine.scratch;
    this.#call('detect', at, out + 16, capacity, out, out + 4);
    const { view } = this.#engine;
    const faces = this.#list(FACE, out + 16, view.getUint32(out, true));
    return { faces, finished: view.getUint32(out + 4, true) === 1 };
  }

  /** The last result, smoothed. */
  smoothed() {
    return this.#result('smoothed');
  }

  /**
   * @param {string} name
   * @returns {Landmark[]}
   */
  #landmarks(name) {
    this.#call(name, this.#engine.scratch, LANDMARKS);
    return this.#list(LANDMARK, this.#engine.scratch, LANDMARKS);
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
    this.#call(name, this.#engine.scratch, ANIMATIONS);
    return new Float32Array(this.#engine.memory, this.#engine.scratch, ANIMATIONS).slice();
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
    const out = this.#engine.scratch;
    this.#call('events', out + 16, UNREAD_EVENTS, out, out + 4);
    const { view } = this.#engine;
    const events = this.#list(EVENT, out + 16, view.getUint32(out, true));
    return { events, overwritten: view.getUint32(out + 4, true) };
  }

  /**
   * Keeps this tracker from faces that others follow.
   * @param {[number, number, number, number][]} boxes x, y, width, height [px].
   */
  setExcluded(boxes) {
    const at = this.#engine.scratch;
    if (boxes.some((box) => box.length !== 4)) throw new TypeError('a box must have 4 numbers');
    // The library refuses more than it has room for, whatever they are.
    const numbers = boxes.slice(0, SCRATCH / 16).flat();
    new Float32Array(this.#engine.memory, at, numbers.length).set(numbers);
    this.#call('set_excluded', at, boxes.length);
  }

  /** @param {Roi | null} roi null: the whole frame. */
  setRoi(roi) {
    this.#call('set_roi', roi ? this.#write(ROI, roi) : 0);
  }

  /** @param {Intrinsics | null} intrinsics null: a field of view of 60 degrees. */
  setIntrinsics(intrinsics) {
    this.#call('set_intrinsics', intrinsics ? this.#write(INTRINSICS, intrinsics) : 0);
  }

  /** @param {Lens | null} lens null: none. */
  setLens(lens) {
    this.#call('set_lens', lens ? this.#write(LENS, lens) : 0);
  }

  /** Forgets the face, its identity and the time, as for another video. */
  reset() {
    this.#call('reset');
  }

  /** Forgets the identity, as when somebody else sits down. */
  forgetIdentity() {
    this.#call('forget_identity');
  }

  /** Gives the tracker's memory back to the engine. */
  free() {
    if (this.#at) this.#release();
    this.#at = 0;
  }
}
