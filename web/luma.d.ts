/**
 * The pixels of a picture. They are valid until the next call.
 * @param {VideoFrame | ImageBitmap | OffscreenCanvas} picture
 * @returns {Promise<Frame>}
 */
export function frameOf(picture: VideoFrame | ImageBitmap | OffscreenCanvas): Promise<Frame>;
export type Frame = import("./engine.js").Frame;
