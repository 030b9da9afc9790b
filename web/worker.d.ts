export type Engine = import("./engine.js").Engine;
export type Tracker = import("./engine.js").Tracker;
export type Frame = import("./engine.js").Frame;
/**
 * What a frame gave.
 */
export type Tracked = {
    result: import("./layout.js").Result;
    smoothed: import("./layout.js").Result;
    landmarks: import("./layout.js").Landmark[];
    smoothedLandmarks: import("./layout.js").Landmark[];
    animation: Float32Array;
    smoothedAnimation: Float32Array;
    /**
     * Those since the last frame.
     */
    events: import("./layout.js").FaceEvent[];
    /**
     * Width of the frame [px].
     */
    width: number;
    /**
     * Height of the frame [px].
     */
    height: number;
    /**
     * Time that the tracker took [ms].
     */
    stepMs: number;
    /**
     * Time until its pixels were there [ms].
     */
    pixelsMs: number;
    /**
     * Where it is not the one that the tracker
     * assumes.
     */
    camera?: import("./layout.js").Intrinsics | undefined;
};
