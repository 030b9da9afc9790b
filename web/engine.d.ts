/** Whether this browser has SIMD in WebAssembly. */
export function hasSimd(): boolean;
/** The name of the module that suits this browser. */
export function moduleName(): "posewise-simd128.wasm" | "posewise.wasm";
/**
 * Loads the library and a model.
 * @param {LoadOptions} [options]
 */
export function load(options?: LoadOptions): Promise<Engine>;
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
 *   default.posewise beside this file.
 */
/** A call that the library rejected. */
export class PosewiseError extends Error {
    /**
     * @param {number} status
     * @param {string} text
     */
    constructor(status: number, text: string);
    /** The status by number, as in STATUS. */
    status: number;
}
/** The library with a model, which all of its trackers share. */
export class Engine {
    /**
     * @param {WebAssembly.Instance} instance
     * @param {Uint8Array} model
     */
    constructor(instance: WebAssembly.Instance, model: Uint8Array);
    /** Address of a place for one argument or result. */
    scratch: number;
    /** Names of the animation weights, ARKit's. */
    animationNames: string[];
    /** WebAssembly's memory, which moves when it grows. */
    get memory(): ArrayBuffer;
    /** @returns {DataView} */
    get view(): DataView;
    /**
     * @param {number} at
     * @param {number} length
     */
    bytes(at: number, length: number): Uint8Array<ArrayBuffer>;
    /**
     * Takes memory that is never given back.
     * @param {number} size
     */
    allocate(size: number): number;
    /**
     * Calls a function of the C header.
     * @param {string} name
     * @param {...number} args
     * @returns {number}
     */
    call(name: string, ...args: number[]): number;
    /** @param {number} status */
    check(status: number): void;
    /**
     * The C string at an address.
     * @param {number} at
     */
    text(at: number): string;
    /**
     * Writes a frame and its pixels, and gives its address.
     * @param {Frame} frame
     * @param {number} timestampUs
     */
    writeFrame(frame: Frame, timestampUs: number): number;
    /**
     * Makes a tracker.
     * @param {Config} [config]
     */
    createTracker(config?: Config): Tracker;
    #private;
}
/** Follows one face. Made by {@link Engine.createTracker}. */
export class Tracker {
    /**
     * @param {Engine} engine
     * @param {number} at
     * @param {() => void} release
     */
    constructor(engine: Engine, at: number, release: () => void);
    /**
     * Processes one frame. Timestamps are the camera's, and increase.
     * @param {Frame} frame
     * @param {number} timestampUs
     */
    step(frame: Frame, timestampUs: number): import("./layout.js").Result;
    /**
     * As {@link step}, for a caller who knows about where a face is.
     * @param {Frame} frame
     * @param {number} timestampUs
     * @param {Hint} hint
     */
    stepAt(frame: Frame, timestampUs: number, hint: Hint): import("./layout.js").Result;
    /**
     * Lists faces of a frame, the largest first; bounded work, so that several calls may be needed.
     * @param {Frame} frame
     * @returns {{ faces: Face[], finished: boolean }}
     */
    detect(frame: Frame): {
        faces: Face[];
        finished: boolean;
    };
    /** The last result, smoothed. */
    smoothed(): import("./layout.js").Result;
    /** The 68 landmarks of the last step. */
    landmarks(): import("./layout.js").Landmark[];
    /** The same, smoothed. */
    smoothedLandmarks(): import("./layout.js").Landmark[];
    /** The animation weights of the last step; Engine.animationNames has their names. */
    animation(): Float32Array<ArrayBuffer>;
    /** The same, smoothed. */
    smoothedAnimation(): Float32Array<ArrayBuffer>;
    /**
     * The events that were not read yet.
     * @returns {{ events: FaceEvent[], overwritten: number }}
     */
    events(): {
        events: FaceEvent[];
        overwritten: number;
    };
    /**
     * Keeps this tracker from faces that others follow.
     * @param {[number, number, number, number][]} boxes x, y, width, height [px].
     */
    setExcluded(boxes: [number, number, number, number][]): void;
    /** @param {Roi | null} roi null: the whole frame. */
    setRoi(roi: Roi | null): void;
    /** @param {Intrinsics | null} intrinsics null: a field of view of 60 degrees. */
    setIntrinsics(intrinsics: Intrinsics | null): void;
    /** @param {Lens | null} lens null: none. */
    setLens(lens: Lens | null): void;
    /** Forgets the face, its identity and the time, as for another video. */
    reset(): void;
    /** Forgets the identity, as when somebody else sits down. */
    forgetIdentity(): void;
    /** Gives the tracker's memory back to the engine. */
    free(): void;
    #private;
}
export type Config = import("./layout.js").Config;
export type Face = import("./layout.js").Face;
export type FaceEvent = import("./layout.js").FaceEvent;
export type Hint = import("./layout.js").Hint;
export type Intrinsics = import("./layout.js").Intrinsics;
export type Landmark = import("./layout.js").Landmark;
export type Lens = import("./layout.js").Lens;
export type Result = import("./layout.js").Result;
export type Roi = import("./layout.js").Roi;
export type Layout = import("./struct.js").Layout;
export type Format = keyof typeof FORMATS;
/**
 * The pixels of one camera frame.
 */
export type Frame = {
    /**
     * From the first byte of the first row on.
     */
    data: Uint8Array | Uint8ClampedArray;
    /**
     * Stored width [px].
     */
    width: number;
    /**
     * Stored height [px].
     */
    height: number;
    /**
     * `GREY` unless it is given; a canvas has `AB24`.
     */
    format?: "NV12" | "GREY" | "Y10" | "Y16" | "YUYV" | "UYVY" | "NV21" | "YU12" | "RGB3" | "BGR3" | "XB24" | "AB24" | "XR24" | "AR24" | "BX24" | "BA24" | "RX24" | "RA24" | undefined;
    /**
     * Bytes from row to row; without it, rows have no gaps.
     */
    stride?: number | undefined;
    /**
     * Clockwise rotation that makes it upright: 0, 90, 180 or 270.
     */
    rotationDeg?: number | undefined;
    /**
     * Whether rows are stored reversed, as in a selfie view.
     */
    mirrored?: boolean | undefined;
};
/**
 * The pixels of one camera frame.
 */
export type LoadOptions = {
    /**
     * The module, its bytes or its
     * address. Without it: the one beside this file that suits the browser.
     */
    wasm?: string | BufferSource | URL | WebAssembly.Module | undefined;
    /**
     * A .posewise model or its address. Without it:
     * default.posewise beside this file.
     */
    model?: string | BufferSource | URL | undefined;
};
import { FORMATS } from './layout.js';
