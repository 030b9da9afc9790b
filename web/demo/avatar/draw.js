// Draws the avatar on a canvas, pixel by pixel: so few triangles need no graphics processor.

/** @typedef {import('./head.js').AvatarHead} AvatarHead */
/** @typedef {import('./head.js').Part} Part */

/** Side of the canvas [px], and how much of the head's plane it shows around its middle [mm]. */
const CANVAS_SIDE = 560;
const SHOWN_MM = 300;
const MIDDLE_MM = -6;
const AWAY = 700;

/** Colours, 0..255 in full light. */
const SKIN = [226, 178, 152];
const LIPS = [186, 98, 96];
const BROWS = [72, 48, 36];
const HAIR = [66, 46, 36];
const PLAIN = {
  socket: [150, 100, 88], mouth: [126, 52, 54], teeth: [236, 228, 214], inside: [48, 18, 18],
};
const WHITE = [240, 236, 232];
const RIM = [38, 52, 60];
const IRIS = [92, 128, 148];
const PUPIL = [16, 16, 20];
/** Angles from the middle of an eye [rad]. */
const PUPIL_AT = 0.16;
const IRIS_AT = 0.46;

/** Towards the lights, of length 1 (camera frame), and how bright they are. */
const KEY = [-0.42, -0.55, -0.722];
const FILL = [0.72, -0.1, -0.687];
const GLINT = [-0.3, -0.34, -0.891];

/**
 * From 0 to 1 where a value goes from one edge to the other.
 * @param {number} low
 * @param {number} high
 * @param {number} value
 */
function between(low, high, value) {
  const share = Math.min(1, Math.max(0, (value - low) / (high - low)));
  return share * share * (3 - 2 * share);
}

/**
 * A number of the skin's colour where the shares of lips, brows and hair are these.
 * @param {number} of
 * @param {number} lips
 * @param {number} brows
 * @param {number} hair
 */
function skinAt(of, lips, brows, hair) {
  let value = SKIN[of];
  value += lips * (LIPS[of] - value);
  value += brows * (BROWS[of] - value);
  return value + hair * (HAIR[of] - value);
}

export class AvatarCanvas {
  #context;
  #image;
  #pixels;
  /** One over the distance of what is drawn at each pixel. */
  #near = new Float32Array(CANVAS_SIDE * CANVAS_SIDE);
  /** x and y [px], one over the distance, and light of each vertex; paint, see `AvatarHead`. */
  #drawn = new Float32Array(0);

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    canvas.width = CANVAS_SIDE;
    canvas.height = CANVAS_SIDE;
    this.#context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    this.#image = new ImageData(CANVAS_SIDE, CANVAS_SIDE);
    this.#pixels = new Uint32Array(this.#image.data.buffer);
  }

  /** @param {AvatarHead} head */
  draw(head) {
    this.#project(head);
    this.#near.fill(0);
    this.#pixels.fill(0);
    for (const part of head.parts) {
      for (let i = part.start; i < part.end; i += 3) {
        this.#triangle(head.corners[i], head.corners[i + 1], head.corners[i + 2], part.kind);
      }
    }
    // The skin from inside, so that nothing shines through an open mouth.
    const [skin] = head.parts;
    for (let i = skin.start; i < skin.end; i += 3) {
      this.#triangle(head.corners[i], head.corners[i + 2], head.corners[i + 1], 'inside');
    }
    this.#context.putImageData(this.#image, 0, 0);
  }

  /** @param {AvatarHead} head */
  #project({ places, normals, paint, parts, corners }) {
    const count = places.length / 3;
    if (this.#drawn.length !== 8 * count) this.#drawn = new Float32Array(8 * count);
    const drawn = this.#drawn;
    const scale = CANVAS_SIDE * AWAY / SHOWN_MM;
    for (let v = 0; v < count; v++) {
      const [x, y, z] = [places[3 * v], places[3 * v + 1], places[3 * v + 2]];
      const [nx, ny, nz] = [normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]];
      drawn[8 * v] = CANVAS_SIDE / 2 + scale * x / z;
      drawn[8 * v + 1] = CANVAS_SIDE / 2 + scale * (y - MIDDLE_MM) / z;
      drawn[8 * v + 2] = 1 / z;
      const key = Math.max(0, nx * KEY[0] + ny * KEY[1] + nz * KEY[2]);
      const fill = Math.max(0, nx * FILL[0] + ny * FILL[1] + nz * FILL[2]);
      const open = paint[4 * v + 3];
      drawn[8 * v + 3] = open * (0.4 - 0.08 * ny) + Math.sqrt(open) * (0.62 * key + 0.2 * fill);
      for (let i = 0; i < 3; i++) drawn[8 * v + 4 + i] = paint[4 * v + i];
    }
    // Of eyeballs the second number says where they shine; the upper lid shades them.
    const eyes = parts[parts.length - 1];
    const shaded = new Set(corners.subarray(eyes.start, eyes.end));
    for (const v of shaded) {
      drawn[8 * v + 3] *= 0.5 + 0.5 * between(-0.55, 0.05, normals[3 * v + 1]);
      drawn[8 * v + 5] = normals[3 * v] * GLINT[0] + normals[3 * v + 1] * GLINT[1]
        + normals[3 * v + 2] * GLINT[2];
    }
  }

  /**
   * @param {number} first
   * @param {number} second
   * @param {number} third
   * @param {Part['kind'] | 'inside'} kind
   */
  #triangle(first, second, third, kind) {
    const [drawn, depths] = [this.#drawn, this.#near];
    const [a, b, c] = [8 * first, 8 * second, 8 * third];
    const [ax, ay, bx, by, cx, cy] = [
      drawn[a], drawn[a + 1], drawn[b], drawn[b + 1], drawn[c], drawn[c + 1],
    ];
    // Y is down: what is counter-clockwise from outside has a negative area here.
    const area = (cx - ax) * (by - ay) - (bx - ax) * (cy - ay);
    if (!(area > 0)) return;
    const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx)));
    const right = Math.min(CANVAS_SIDE - 1, Math.floor(Math.max(ax, bx, cx)));
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy)));
    const bottom = Math.min(CANVAS_SIDE - 1, Math.floor(Math.max(ay, by, cy)));
    // Rims of lids and lips are seen from inside too, but from outside first.
    const farther = kind === 'inside' ? 0.98 : 1;
    const [stepP, stepQ] = [(cy - by) / area, (ay - cy) / area];
    for (let y = top; y <= bottom; y++) {
      let p = ((cx - left) * (by - y) - (bx - left) * (cy - y)) / area;
      let q = ((ax - left) * (cy - y) - (cx - left) * (ay - y)) / area;
      for (let x = left; x <= right; x++, p += stepP, q += stepQ) {
        const r = 1 - p - q;
        if (p < -1e-4 || q < -1e-4 || r < -1e-4) continue;
        const near = farther * (p * drawn[a + 2] + q * drawn[b + 2] + r * drawn[c + 2]);
        const pixel = y * CANVAS_SIDE + x;
        if (near <= depths[pixel]) continue;
        depths[pixel] = near;
        this.#paint(pixel, kind,
          p * drawn[a + 3] + q * drawn[b + 3] + r * drawn[c + 3],
          p * drawn[a + 4] + q * drawn[b + 4] + r * drawn[c + 4],
          p * drawn[a + 5] + q * drawn[b + 5] + r * drawn[c + 5],
          p * drawn[a + 6] + q * drawn[b + 6] + r * drawn[c + 6]);
      }
    }
  }

  /**
   * @param {number} pixel
   * @param {Part['kind'] | 'inside'} kind
   * @param {number} light
   * @param {number} i Inside lips, or from the middle of an eye.
   * @param {number} j Inside brows, or where an eye shines.
   * @param {number} k Inside hair.
   */
  #paint(pixel, kind, light, i, j, k) {
    if (kind === 'eye') {
      this.#eye(pixel, light, i, j);
      return;
    }
    if (kind !== 'skin') {
      this.#set(pixel, PLAIN[kind], light, 0);
      return;
    }
    // Not in lists: this is done for each pixel.
    const lips = i > -0.6 ? 0.85 * between(-0.6, 0.6, i) : 0;
    const brows = j > -0.7 ? 0.9 * between(-0.7, 0.9, j) : 0;
    const hair = k > -2 ? between(-2, 2, k) : 0;
    const red = skinAt(0, lips, brows, hair);
    const green = skinAt(1, lips, brows, hair);
    const blue = skinAt(2, lips, brows, hair);
    this.#put(pixel, red * light, green * light, blue * light);
  }

  /**
   * @param {number} pixel
   * @param {number} light
   * @param {number} angle
   * @param {number} shine
   */
  #eye(pixel, light, angle, shine) {
    let color = WHITE;
    if (angle < PUPIL_AT) color = PUPIL;
    else if (angle < IRIS_AT - 0.05) color = IRIS;
    else if (angle < IRIS_AT) color = RIM;
    this.#set(pixel, color, Math.min(1, 0.2 + 0.75 * light), 235 * between(0.985, 0.993, shine));
  }

  /**
   * @param {number} pixel
   * @param {number[]} color
   * @param {number} light
   * @param {number} more
   */
  #set(pixel, [red, green, blue], light, more) {
    this.#put(pixel, red * light + more, green * light + more, blue * light + more);
  }

  /**
   * @param {number} pixel
   * @param {number} red
   * @param {number} green
   * @param {number} blue
   */
  #put(pixel, red, green, blue) {
    const byte = (/** @type {number} */ v) => Math.min(255, v) | 0;
    // Little-endian, as all machines of browsers are.
    this.#pixels[pixel] = 0xff000000 | byte(blue) << 16 | byte(green) << 8 | byte(red);
  }
}
