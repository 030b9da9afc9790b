// The library in WebAssembly: no worker and no DOM, so it runs in Node and in any worker too.
// Each method calls the function of the same name in include/posewise.h, which has the details.

import {
  ABI, ANIMATIONS, CONFIG, EYE_LOOKS, FORMATS, FRAME, MODEL_DETAILS, MONITOR_CONFIG, PARTS, PRESETS,
  STATUS,
} from './layout.js';
import { Group } from './group.js';
import { Monitor } from './monitor.js';
import { changeStruct, clearStruct, readStruct, writeStruct } from './struct.js';
import { Tracker } from './tracker.js';

/** @typedef {import('./layout.js').Config} Config */
/** @typedef {import('./layout.js').MonitorConfig} MonitorConfig */
/** @typedef {import('./layout.js').Preset} Preset */
/** @typedef {import('./monitor.js').Zone} Zone */
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
    /** Its name in the C header, as `E_TIME`. */
    this.code = Object.entries(STATUS).find(([, known]) => known === status)?.[0] ?? `${status}`;
  }
}

// Bytes for arguments and results: more than any list of structs takes.
const SCRATCH = 16384;

// A module with one instruction of 128-bit SIMD.
const SIMD_PROBE = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
  253, 98, 11,
];

// A module with a dot product of relaxed SIMD.
const RELAXED_PROBE = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 19, 1, 17, 0, 65, 0, 253, 15,
  65, 0, 253, 15, 65, 0, 253, 15, 253, 147, 2, 11,
];

/** Whether this browser has SIMD in WebAssembly. */
export function hasSimd() {
  return WebAssembly.validate(new Uint8Array(SIMD_PROBE));
}

/**
 * Whether this browser has relaxed SIMD in WebAssembly. What its dot products are on this machine,
 * the module finds out.
 */
export function hasRelaxedSimd() {
  return WebAssembly.validate(new Uint8Array(RELAXED_PROBE));
}

/** The name of the module that suits this browser. */
export function moduleName() {
  if (hasRelaxedSimd()) return 'posewise-relaxed.wasm';
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
  const response = String(url).startsWith('file:') ? await file(url) : await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response;
}

/**
 * A file of this machine, which Node does not fetch.
 * @param {string | URL} url
 */
async function file(url) {
  // Not as a constant: bundlers for browsers would look for it.
  const name = ['node', 'fs/promises'].join(':');
  const { readFile } = await import(/* @vite-ignore */ /* webpackIgnore: true */ name);
  return new Response(await readFile(new URL(url)));
}

/** The address of the module that suits this browser. Bundlers look for whole addresses. */
function moduleUrl() {
  if (hasRelaxedSimd()) return new URL('./posewise-relaxed.wasm', import.meta.url);
  return hasSimd()
    ? new URL('./posewise-simd128.wasm', import.meta.url)
    : new URL('./posewise.wasm', import.meta.url);
}

/** @param {LoadOptions['wasm']} wasm */
async function compile(wasm) {
  if (wasm instanceof WebAssembly.Module) return wasm;
  if (typeof wasm !== 'string' && !(wasm instanceof URL) && wasm) return WebAssembly.compile(wasm);
  const response = await get(wasm ?? moduleUrl());
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
  const response = await get(model ?? new URL('./posewise.posewise', import.meta.url));
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
  /**
   * Memory that was given back, by what was in it.
   * @type {Record<string, number[]>}
   */
  #freed = { init: [], monitor_init: [], group_init: [] };

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
    const version = this.call('version');
    /** Version of the library. */
    this.version = [version >> 16, (version >> 8) & 255, version & 255].join('.');
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
    const align = this.call('memory_align');
    const start = Math.ceil(this.#end / align) * align;
    const lack = start + size - this.memory.byteLength;
    if (lack > 0) this.#exports.memory.grow(Math.ceil(lack / 65536));
    this.#end = start + size;
    return start;
  }

  /**
   * Calls a function of the C header.
   * @param {string} name
   * @param {...(number | bigint)} args
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
    const settings = this.#writeDefaults(CONFIG, 'config_default');
    changeStruct(this.view, settings, CONFIG, config);
    return this.#create(Tracker, 'init', size, this.#model, this.#modelLength, settings);
  }

  /**
   * Makes a monitor of a driver.
   * @param {MonitorConfig} [config]
   * @param {Zone[]} [zones] Without them: those of the preset.
   */
  createMonitor(config = {}, zones) {
    const size = this.call('monitor_memory_size', 0);
    const settings = this.#writePreset(config.preset);
    changeStruct(this.view, settings, MONITOR_CONFIG, config);
    const monitor = this.#create(Monitor, 'monitor_init', size, settings);
    try {
      if (zones) monitor.setZones(zones);
    } catch (error) {
      monitor.free();
      throw error;
    }
    return monitor;
  }

  /** Makes a group, for several trackers. */
  createGroup() {
    return this.#create(Group, 'group_init', this.call('group_memory_size'));
  }

  /**
   * The settings of a tracker where none are given.
   * @returns {Required<Config>}
   */
  defaultConfig() {
    return readStruct(this.view, this.#writeDefaults(CONFIG, 'config_default'), CONFIG);
  }

  /**
   * The settings of a preset.
   * @param {Preset} [preset]
   * @returns {Required<MonitorConfig>}
   */
  defaultMonitorConfig(preset) {
    return readStruct(this.view, this.#writePreset(preset), MONITOR_CONFIG);
  }

  /** @param {Preset} [preset] */
  #writePreset(preset = 'general') {
    const index = PRESETS.indexOf(preset);
    if (index < 0) throw new TypeError(`preset must be one of ${PRESETS}, not ${preset}`);
    return this.#writeDefaults(MONITOR_CONFIG, 'monitor_config_default', index);
  }

  /**
   * Has the library write settings, in which 0 is 0, and gives their address.
   * @param {Layout} layout
   * @param {string} name
   * @param {...number} args
   */
  #writeDefaults(layout, name, ...args) {
    const at = this.scratch + 8;
    clearStruct(this.view, at, layout);
    this.check(this.call(name, ...args, at));
    return at;
  }

  /**
   * Makes an object of the library, in memory that an earlier one gave back where there is such.
   * @template T
   * @param {new (engine: Engine, at: number, release: () => void) => T} kind
   * @param {string} init
   * @param {number} size
   * @param {...number} args
   */
  #create(kind, init, size, ...args) {
    const memory = this.#freed[init].pop() ?? this.allocate(size);
    const release = () => this.#freed[init].push(memory);
    const status = this.call(init, this.scratch, memory, size, ...args);
    if (status !== STATUS.OK) release();
    this.check(status);
    return new kind(this, memory, release);
  }
}

/** @param {Frame} frame */
function bytesPerPixel({ format = 'GREY' }) {
  if (/^(Y10|Y16|YUYV|UYVY)$/.test(format)) return 2;
  if (/^(RGB3|BGR3)$/.test(format)) return 3;
  return /24$/.test(format) ? 4 : 1;
}
