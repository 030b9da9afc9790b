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
export function startWorker(): Worker;
/**
 * The picture that an element shows now.
 * @param {HTMLVideoElement | HTMLCanvasElement} element
 * @param {number} timestampUs
 * @returns {Promise<VideoFrame | ImageBitmap>}
 */
export function grabbed(element: HTMLVideoElement | HTMLCanvasElement, timestampUs: number): Promise<VideoFrame | ImageBitmap>;
export { frameOf } from "./luma.js";
/** Follows one face in a worker. */
export class FaceTracker {
    /**
     * Starts the worker and loads the model.
     * @param {Options} [options]
     */
    static create({ worker, config, ...source }?: Options): Promise<FaceTracker>;
    /** @param {Worker} worker */
    constructor(worker: Worker);
    /** @type {string[]} Names of the animation weights, ARKit's. */
    animationNames: string[];
    /** Frames that were not answered yet. A caller with a camera drops frames while it is not 0. */
    get pending(): number;
    /**
     * Tracks the face in a picture. Timestamps increase from call to call.
     * @param {Picture} picture
     * @param {number} timestampUs When the camera took it, on any monotonic clock [us].
     * @returns {Promise<Tracked>}
     */
    track(picture: Picture, timestampUs: number): Promise<Tracked>;
    /** Forgets the face, its identity and the time, as for another video. */
    reset(): Promise<void>;
    /** Forgets the identity, as when somebody else sits down. */
    forgetIdentity(): Promise<void>;
    /** @param {Roi | null} roi Where faces are looked for; null: the whole frame. */
    setRoi(roi: Roi | null): Promise<void>;
    /** @param {Intrinsics | null} intrinsics null: a field of view of 60 degrees. */
    setIntrinsics(intrinsics: Intrinsics | null): Promise<void>;
    /** @param {Lens | null} lens null: none. */
    setLens(lens: Lens | null): Promise<void>;
    /** Ends the worker when it has answered what was asked before. */
    close(): Promise<void>;
    #private;
}
export type Frame = import("./engine.js").Frame;
export type Config = import("./layout.js").Config;
export type Intrinsics = import("./layout.js").Intrinsics;
export type Lens = import("./layout.js").Lens;
export type Roi = import("./layout.js").Roi;
export type Tracked = import("./worker.js").Tracked;
/**
 * What can be tracked. A VideoFrame and an ImageBitmap are closed; a video is read where it is.
 */
export type Picture = Frame | VideoFrame | ImageBitmap | HTMLVideoElement | HTMLCanvasElement | ImageData;
/**
 * What can be tracked. A VideoFrame and an ImageBitmap are closed; a video is read where it is.
 */
export type Options = {
    /**
     * As in load().
     */
    wasm?: import("./engine.js").LoadOptions["wasm"];
    /**
     * As in load().
     */
    model?: import("./engine.js").LoadOptions["model"];
    /**
     * A worker that runs worker.js, from startWorker() or elsewhere.
     */
    worker?: Worker | undefined;
    /**
     * Settings of the tracker.
     */
    config?: import("./layout.js").Config | undefined;
};
export { Engine, PosewiseError, Tracker, hasSimd, load, moduleName } from "./engine.js";
