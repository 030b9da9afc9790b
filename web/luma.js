// Pixels of what browsers hand out as pictures.

/** @typedef {import('./engine.js').Frame} Frame */

// Formats of VideoFrame whose first plane is 8-bit luma, and packed ones by their name in V4L2.
const PLANAR = ['I420', 'I420A', 'I422', 'I422A', 'I444', 'I444A', 'NV12'];
/** @type {Record<string, Frame['format']>} */
const PACKED = { RGBA: 'AB24', RGBX: 'XB24', BGRA: 'AR24', BGRX: 'XR24' };

/** @type {Uint8Array} */
let buffer = new Uint8Array(0);
/** @type {OffscreenCanvas | undefined} */
let canvas;

/**
 * The pixels of a picture. They are valid until the next call.
 * @param {VideoFrame | ImageBitmap | OffscreenCanvas} picture
 * @returns {Promise<Frame>}
 */
export async function frameOf(picture) {
  if (typeof VideoFrame !== 'undefined' && picture instanceof VideoFrame) {
    const { rotation = 0, flip = false } = /** @type {any} */ (picture);
    const isKnown = PLANAR.includes(picture.format ?? '') || (picture.format ?? '') in PACKED;
    // A canvas turns what has to be turned, and converts what no table knows.
    return isKnown && !rotation && !flip ? copied(picture) : drawn(picture, picture.displayWidth,
      picture.displayHeight);
  }
  const { width, height } = /** @type {ImageBitmap} */ (picture);
  return drawn(/** @type {ImageBitmap} */ (picture), width, height);
}

/**
 * @param {VideoFrame} picture
 * @returns {Promise<Frame>}
 */
async function copied(picture) {
  const size = picture.allocationSize();
  if (buffer.length < size) buffer = new Uint8Array(size);
  const [{ offset, stride }] = await picture.copyTo(buffer);
  const rect = /** @type {DOMRectReadOnly} */ (picture.visibleRect);
  const { width, height } = rect;
  const format = PACKED[picture.format ?? ''] ?? 'GREY';
  const data = buffer.subarray(offset, offset + stride * height);
  return { data, width, height, stride, format };
}

/**
 * @param {CanvasImageSource} picture
 * @param {number} width
 * @param {number} height
 * @returns {Frame}
 */
function drawn(picture, width, height) {
  canvas ??= new OffscreenCanvas(width, height);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  const context = canvas.getContext('2d', { willReadFrequently: true });
  if (!context) throw new Error('no 2D canvas');
  context.drawImage(picture, 0, 0, width, height);
  return { data: context.getImageData(0, 0, width, height).data, width, height, format: 'AB24' };
}
