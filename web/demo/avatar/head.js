// The avatar's head: MakeHuman's, as make.py writes it.

import { findNormals } from '../normals.js';
import { AVATAR_SHAPES } from './retargeting.js';

/** What the head turns about [mm, head frame], and how far that is from the eye [mm]. */
const NECK = [0, 70, 75];
const AWAY_MM = 700;
/**
 * Lids lie at least so far in front of an eyeball, and that is drawn so much smaller [mm]: between
 * their vertices lids are flat, and it is not.
 */
const LID_MM = 1.1;
const SMALLER_MM = 0.8;
/** The gaze at weights of 1 [rad]. */
const LOOK = 0.5;
/** The share of a closed eye that lids go down by where the eyes look down. */
const LOWERED = 0.54;
/** Rings and sectors of an eyeball, and how far back it is drawn [rad]. */
const RINGS = 12;
const SECTORS = 20;
const BALL = 1.5;

/**
 * A part of the head that is drawn in one way.
 * @typedef {object} Part
 * @property {'skin' | 'socket' | 'mouth' | 'teeth' | 'eye'} kind
 * @property {number} start The first of its corners.
 * @property {number} end
 */

/**
 * The turn of a quaternion, row by row.
 * @param {ArrayLike<number>} quaternion x, y, z, w
 */
function matrixOf({ 0: x, 1: y, 2: z, 3: w }) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
  ];
}

export class AvatarHead {
  #neutral;
  #shapes;
  #eyes;
  /** @type {Uint16Array} Vertices of the skin near eyeballs. */
  #lids;
  #count;
  /** Places of the head at rest or with an expression, head frame [mm]. */
  #shaped;

  /** @param {ArrayBuffer} bytes */
  constructor(bytes) {
    const view = new DataView(bytes);
    const [count, skin, socket, mouth, teeth, shapes] = new Uint16Array(bytes, 0, 6);
    this.#count = count;
    this.#eyes = [0, 1].map((k) => {
      const [x, y, z, radius] = new Float32Array(bytes, 16 + 16 * k, 4);
      return { at: [x, y, z], radius };
    });
    let at = 48;
    const balls = 2 * (RINGS * SECTORS + 1);
    this.#neutral = Float32Array.from(new Int16Array(bytes, at, 3 * count), (v) => v / 100);
    at += 6 * count;
    /** Inside lips, brows and hair [mm], or of an eyeball the angle [rad]; light from around. */
    this.paint = new Float32Array(4 * (count + balls));
    new Int8Array(bytes, at, 4 * count).forEach((v, i) => {
      this.paint[i] = v / (i % 4 === 3 ? 127 : 8);
    });
    at += 4 * count;
    const all = skin + socket + mouth + teeth;
    const corners = new Uint16Array(bytes, at, 3 * all);
    at += 6 * all;
    this.#shapes = AVATAR_SHAPES.slice(0, shapes).map((name) => {
      const step = view.getFloat32(at, true);
      const moved = view.getUint16(at + 4, true);
      const numbers = Uint16Array.from({ length: moved }, (_, i) =>
        view.getUint16(at + 6 + 2 * i, true));
      const by = new Int8Array(bytes, at + 6 + 2 * moved, 3 * moved);
      at += 6 + 5 * moved;
      return { name, step, numbers, by };
    });
    this.#shaped = new Float32Array(3 * count);
    this.corners = new Uint16Array(3 * (all + 2 * SECTORS * (2 * RINGS - 1)));
    this.corners.set(corners);
    /** @type {Part[]} */
    this.parts = [];
    let start = 0;
    const end = (/** @type {Part['kind']} */ kind, /** @type {number} */ triangles) => {
      this.parts.push({ kind, start, end: start + 3 * triangles });
      start += 3 * triangles;
    };
    end('skin', skin);
    end('socket', socket);
    end('mouth', mouth);
    end('teeth', teeth);
    const faces = ballCorners(count);
    this.corners.set(faces, start);
    this.corners.set(faces.map((v) => v + balls / 2), start + faces.length);
    end('eye', 2 * faces.length / 3);
    for (let ball = 0; ball < 2; ball++) {
      for (let v = 0; v < balls / 2; v++) {
        const ring = v === 0 ? 0 : 1 + Math.floor((v - 1) / SECTORS);
        this.paint.set([ringAngle(ring), 0, 0, 1], 4 * (count + ball * balls / 2 + v));
      }
    }
    const isNear = (/** @type {number} */ v) => this.#eyes.some(({ at: eye, radius }) => {
      const [x, y, z] = [0, 1, 2].map((i) => this.#neutral[3 * v + i] - eye[i]);
      return z < 0 && Math.hypot(x, y, z) < radius + 9;
    });
    const skins = new Set(corners.subarray(0, 3 * skin));
    this.#lids = Uint16Array.from([...skins].filter(isNear));
    /** x, y, z of each vertex in the camera frame [mm]. */
    this.places = new Float32Array(3 * (count + balls));
    /** Of length 1, from the head outwards. */
    this.normals = new Float32Array(this.places.length);
  }

  /**
   * Gives the head an expression and turns it.
   * @param {Record<string, number>} weights Those of an avatar; may be more or less than 0..1.
   * @param {ArrayLike<number>} rotation Head to camera: x, y, z, w.
   */
  pose(weights, rotation) {
    const shaped = this.#shaped;
    shaped.set(this.#neutral);
    for (const { name, step, numbers, by } of this.#shapes) {
      let weight = weights[name];
      if (name.startsWith('eyeBlink')) {
        const down = weights[name.replace('Blink', 'LookDown')];
        weight = Math.min(weight, 1 - LOWERED * down);
      }
      const scale = weight * step;
      if (Math.abs(weight) < 0.002) continue;
      for (let i = 0; i < numbers.length; i++) {
        const v = 3 * numbers[i];
        shaped[v] += scale * by[3 * i];
        shaped[v + 1] += scale * by[3 * i + 1];
        shaped[v + 2] += scale * by[3 * i + 2];
      }
    }
    this.#clearLids();
    const turn = matrixOf(rotation);
    const { places } = this;
    const put = (/** @type {number} */ to, /** @type {number} */ x, /** @type {number} */ y,
      /** @type {number} */ z) => {
      const [a, b, c] = [x - NECK[0], y - NECK[1], z - NECK[2]];
      places[to] = turn[0] * a + turn[1] * b + turn[2] * c;
      places[to + 1] = turn[3] * a + turn[4] * b + turn[5] * c + NECK[1];
      places[to + 2] = turn[6] * a + turn[7] * b + turn[8] * c + AWAY_MM;
    };
    for (let v = 0; v < 3 * this.#count; v += 3) put(v, shaped[v], shaped[v + 1], shaped[v + 2]);
    // The person's right eye first, at -x.
    ['Right', 'Left'].forEach((side, k) => {
      const look = (/** @type {string} */ way) => weights[`eyeLook${way}${side}`];
      const inwards = look('In') - look('Out');
      this.#turnEye(k, LOOK * (k === 0 ? inwards : -inwards), LOOK * (look('Down') - look('Up')),
        put);
    });
    findNormals(places, this.corners, this.normals);
  }

  /** Lifts skin that lies within an eyeball, as half-closed lids would, to its surface. */
  #clearLids() {
    const shaped = this.#shaped;
    for (const v of this.#lids) {
      for (const { at, radius } of this.#eyes) {
        const [x, y, z] = [0, 1, 2].map((i) => shaped[3 * v + i] - at[i]);
        const far = Math.hypot(x, y, z);
        const least = radius + LID_MM;
        if (far >= least || z > 0) continue;
        [x, y, z].forEach((d, i) => {
          shaped[3 * v + i] = at[i] + d * least / far;
        });
      }
    }
  }

  /**
   * @param {number} k
   * @param {number} right To the image right of a head that looks into the camera [rad].
   * @param {number} down [rad]
   * @param {(to: number, x: number, y: number, z: number) => void} put
   */
  #turnEye(k, right, down, put) {
    const { at } = this.#eyes[k];
    const radius = this.#eyes[k].radius - SMALLER_MM;
    const balls = 1 + RINGS * SECTORS;
    const [cosR, sinR, cosD, sinD] = [
      Math.cos(right), Math.sin(right), Math.cos(down), Math.sin(down),
    ];
    for (let v = 0; v < balls; v++) {
      const ring = v === 0 ? 0 : 1 + Math.floor((v - 1) / SECTORS);
      const angle = ringAngle(ring);
      const around = 2 * Math.PI * ((v - 1) % SECTORS) / SECTORS;
      const x = Math.sin(angle) * Math.cos(around);
      const y = Math.sin(angle) * Math.sin(around);
      const z = -Math.cos(angle);
      // Down about x, then to the side about y.
      const [y1, z1] = [cosD * y - sinD * z, sinD * y + cosD * z];
      const [x2, z2] = [cosR * x - sinR * z1, sinR * x + cosR * z1];
      put(3 * (this.#count + k * balls + v), at[0] + radius * x2, at[1] + radius * y1,
        at[2] + radius * z2);
    }
  }
}

/**
 * Of a ring of an eyeball, from where it looks [rad].
 * @param {number} ring
 */
function ringAngle(ring) {
  return BALL * ring / RINGS;
}

/**
 * Triangles of an eyeball whose first vertex has this number.
 * @param {number} first
 */
function ballCorners(first) {
  const corners = [];
  const vertex = (/** @type {number} */ ring, /** @type {number} */ sector) =>
    first + (ring === 0 ? 0 : 1 + (ring - 1) * SECTORS + sector % SECTORS);
  for (let ring = 0; ring < RINGS; ring++) {
    for (let sector = 0; sector < SECTORS; sector++) {
      const [a, b] = [vertex(ring + 1, sector), vertex(ring + 1, sector + 1)];
      corners.push(vertex(ring, sector), b, a);
      if (ring > 0) corners.push(vertex(ring, sector), vertex(ring, sector + 1), b);
    }
  }
  return Uint16Array.from(corners);
}
