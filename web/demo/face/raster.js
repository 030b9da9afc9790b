// A surface for browsers without WebGL 2: each pixel is computed here, to the same rules as in
// gpu.js.

import { extentOf } from './geometry.js';

/** @typedef {import('./geometry.js').Corners} Corners */
/** @typedef {import('./surface.js').Look} Look */

/** Side of the texture as it is read: pixels are taken from it without mipmaps [px]. */
const TEXTURE_SIDE = 512;

/**
 * How solid a surface of some visibility is, as gpu.js computes it.
 * @param {number} visibility
 */
function solidity(visibility) {
  return Math.min(1, Math.max(0, 4 * visibility - 1));
}

/**
 * @param {number} width
 * @param {number} height
 */
function contextOf(width, height) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const options = { willReadFrequently: true };
  return /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d', options));
}

/** A canvas with the face as this code draws it. */
export class RasterSurface {
  #corners;
  #context = contextOf(1, 1);
  #image = new ImageData(1, 1);
  /** One over the distance of what is drawn at each pixel. */
  #nearness = new Float32Array(1);
  /** @type {HTMLCanvasElement | undefined} What is in `texels` now. */
  #read;
  #texels = new Uint8ClampedArray();

  /** @param {Corners} corners */
  constructor(corners) {
    this.#corners = corners;
  }

  get canvas() {
    return this.#context.canvas;
  }

  /** It is never lost, as WebGL may be. */
  get isLost() {
    return false;
  }

  /** There is nothing that is not freed by itself. */
  free() {}

  /** @param {HTMLCanvasElement} texture */
  #take(texture) {
    if (texture === this.#read) return;
    const context = contextOf(TEXTURE_SIDE, TEXTURE_SIDE);
    context.imageSmoothingQuality = 'high';
    context.drawImage(texture, 0, 0, TEXTURE_SIDE, TEXTURE_SIDE);
    this.#texels = context.getImageData(0, 0, TEXTURE_SIDE, TEXTURE_SIDE).data;
    this.#read = texture;
  }

  /**
   * As {@link GpuSurface.draw}.
   * @param {Float32Array} mesh
   * @param {number} width
   * @param {number} height
   * @param {number} scale
   * @param {Look} look
   */
  draw(mesh, width, height, scale, look) {
    const { canvas } = this;
    if (canvas.width !== scale * width || canvas.height !== scale * height) {
      this.#context = contextOf(scale * width, scale * height);
      this.#image = new ImageData(scale * width, scale * height);
      this.#nearness = new Float32Array(scale * width * scale * height);
    }
    // Outside of it there may be what was drawn before.
    const extent = extentOf(mesh, scale, this.canvas);
    const { left, right, top, bottom } = extent;
    for (let row = top * scale * width; row < bottom * scale * width; row += scale * width) {
      this.#image.data.fill(0, 4 * (row + left), 4 * (row + right));
      this.#nearness.fill(0, row + left, row + right);
    }
    if (look.texture) this.#take(look.texture);
    for (let first = 0; first < this.#corners.vertices.length; first += 3) {
      this.#triangle(mesh, first, scale, look);
    }
    this.#context.putImageData(this.#image, 0, 0, left, top, right - left, bottom - top);
    return extent;
  }

  /**
   * @param {Float32Array} mesh
   * @param {number} first The first of its corners.
   * @param {number} scale
   * @param {Look} look
   */
  #triangle(mesh, first, scale, look) {
    const { width, height } = this.#image;
    const [a, b, c] = [0, 1, 2].map((k) => {
      const at = 4 * this.#corners.vertices[first + k];
      // To the middle of the first pixel.
      const [x, y] = [mesh[at], mesh[at + 1]].map((v) => scale * (v + 0.5) - 0.5);
      return { x, y, near: 1 / mesh[at + 2], seen: mesh[at + 3] };
    });
    const area = (c.x - a.x) * (b.y - a.y) - (b.x - a.x) * (c.y - a.y);
    if (!(area > 0)) return;
    const bound = (/** @type {number} */ v, /** @type {number} */ most) =>
      Math.min(most, Math.max(0, v));
    const left = bound(Math.ceil(Math.min(a.x, b.x, c.x)), width);
    const right = bound(Math.floor(Math.max(a.x, b.x, c.x)), width - 1);
    const top = bound(Math.ceil(Math.min(a.y, b.y, c.y)), height);
    const bottom = bound(Math.floor(Math.max(a.y, b.y, c.y)), height - 1);
    // Of each corner over the edge opposite.
    const [tallA, tallB, tallC] = [[b, c], [c, a], [a, b]].map(([p, q]) =>
      area / Math.hypot(p.x - q.x, p.y - q.y));
    for (let y = top; y <= bottom; y++) {
      for (let x = left; x <= right; x++) {
        // How much each corner counts: its share of the triangle's area.
        const p = ((c.x - x) * (b.y - y) - (b.x - x) * (c.y - y)) / area;
        const q = ((a.x - x) * (c.y - y) - (c.x - x) * (a.y - y)) / area;
        const r = 1 - p - q;
        if (p < 0 || q < 0 || r < 0) continue;
        const near = p * a.near + q * b.near + r * c.near;
        const pixel = y * width + x;
        if (near <= this.#nearness[pixel]) continue;
        this.#nearness[pixel] = near;
        // The same in space, where what is far off counts for more.
        const [i, j, k] = [p * a.near / near, q * b.near / near, r * c.near / near];
        const seen = solidity(i * a.seen + j * b.seen + k * c.seen);
        if (look.texture) this.#textured(pixel, first, i, j, k, seen);
        else this.#wired(pixel, first, [p * tallA, q * tallB, r * tallC], seen, look);
      }
    }
  }

  /**
   * @param {number} pixel
   * @param {number} first
   * @param {number} i How much the first corner counts, and so on.
   * @param {number} j
   * @param {number} k
   * @param {number} seen
   */
  #textured(pixel, first, i, j, k, seen) {
    const { places } = this.#corners;
    const at = 2 * first;
    const u = i * places[at] + j * places[at + 2] + k * places[at + 4];
    const v = i * places[at + 1] + j * places[at + 3] + k * places[at + 5];
    const most = TEXTURE_SIDE - 1;
    const x = Math.min(most, Math.max(0, TEXTURE_SIDE * u - 0.5));
    const y = Math.min(most, Math.max(0, TEXTURE_SIDE * (1 - v) - 0.5));
    const [x0, y0] = [Math.floor(x), Math.floor(y)];
    let [red, green, blue, alpha] = [0, 0, 0, 0];
    // Between the four texels around.
    for (let corner = 0; corner < 4; corner++) {
      const [right, below] = [corner & 1, corner >> 1];
      const texel = 4 * (Math.min(most, y0 + below) * TEXTURE_SIDE + Math.min(most, x0 + right));
      const part = (right ? x - x0 : 1 - x + x0) * (below ? y - y0 : 1 - y + y0)
        * this.#texels[texel + 3];
      red += part * this.#texels[texel];
      green += part * this.#texels[texel + 1];
      blue += part * this.#texels[texel + 2];
      alpha += part;
    }
    if (alpha === 0) return;
    const { data } = this.#image;
    data[4 * pixel] = red / alpha;
    data[4 * pixel + 1] = green / alpha;
    data[4 * pixel + 2] = blue / alpha;
    data[4 * pixel + 3] = alpha * seen;
  }

  /**
   * @param {number} pixel
   * @param {number} first
   * @param {number[]} away Distance to each edge [px].
   * @param {number} seen
   * @param {Extract<Look, { texture?: undefined }>} look
   */
  #wired(pixel, first, away, seen, { edge, contour, width }) {
    let [onEdge, onContour] = [0, 0];
    for (let k = 0; k < 3; k++) {
      const isContour = this.#corners.contours[3 * first + k];
      const covered = Math.min(1, 0.5 * width * (1 + isContour) + 0.5 - away[k]);
      onEdge = Math.max(onEdge, covered);
      if (isContour) onContour = Math.max(onContour, covered);
    }
    const { data } = this.#image;
    for (let i = 0; i < 3; i++) {
      data[4 * pixel + i] = edge[i] + onContour * (contour[i] - edge[i]);
    }
    data[4 * pixel + 3] = 255 * Math.max(0.6 * onEdge, onContour) * seen;
  }
}
