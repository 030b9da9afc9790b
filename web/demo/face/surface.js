// What a face is drawn on: WebGL with a graphics processor, or else this page's own code, which
// draws 640×480 pixels quicker than WebGL without one.

import { cornersOf } from './geometry.js';
import { GpuSurface } from './gpu.js';
import { RasterSurface } from './raster.js';

/** @typedef {[number, number, number]} Color Red, green, blue, 0..255. */

/**
 * How a face is drawn: with a texture, or as a wire of a width [px] whose contours are twice as
 * wide.
 * @typedef {{ texture: HTMLCanvasElement }
 *   | { texture?: undefined, edge: Color, contour: Color, width: number }} Look
 */

/**
 * A surface for faces whose vertices are joined so.
 * @param {import('../../tracker.js').MeshTables} tables
 * @returns {GpuSurface | RasterSurface}
 */
export function surfaceFor(tables) {
  const corners = cornersOf(tables);
  return GpuSurface.create(corners) ?? new RasterSurface(corners);
}
