// The dense mesh of the tracked face, drawn over its picture as it was chosen.

import { FaceControls } from './controls.js';
import { surfaceFor } from './surface.js';
import { makeUp, paintedMask } from './textures.js';

/** @typedef {import('../../posewise.js').FaceTracker} FaceTracker */
/** @typedef {import('../../tracker.js').MeshTables} MeshTables */
/** @typedef {import('../../worker.js').Tracked} Tracked */
/** @typedef {import('./controls.js').Choice} Choice */
/** @typedef {import('./surface.js').Look} Look */

/** @type {{ edge: [number, number, number], contour: [number, number, number] }} */
const WIRE = { edge: [120, 175, 240], contour: [255, 190, 60] };

export class FaceLayer {
  #controls;
  /** @type {FaceTracker | undefined} */
  #tracker;
  /** @type {MeshTables | undefined} */
  #tables;
  /** @type {ReturnType<typeof surfaceFor> | undefined} */
  #surface;
  /** @type {Float32Array | undefined} The mesh of the frame; without a face there is none. */
  #mesh;
  /** What was drawn last, by its name: a texture is made when it is needed. */
  #texture = { name: '', canvas: /** @type {HTMLCanvasElement | undefined} */ (undefined) };

  /**
   * Connects the controls.
   * @param {() => FaceTracker} tracker
   * @param {() => void} changed Called when something else is to be drawn.
   */
  constructor(tracker, changed) {
    this.#controls = new FaceControls(() => this.#tablesOf(tracker()), changed);
  }

  /**
   * Chooses a mask with this picture.
   * @param {File} file
   */
  wear(file) {
    return this.#controls.wear(file);
  }

  /**
   * How the vertices of a tracker's mesh are joined.
   * @param {FaceTracker} tracker
   */
  async #tablesOf(tracker) {
    if (tracker !== this.#tracker || !this.#tables) {
      this.#tables = await tracker.meshTables();
      this.#tracker = tracker;
      this.#surface?.free();
      this.#surface = undefined;
      this.#texture = { name: '', canvas: undefined };
    }
    return this.#tables;
  }

  /**
   * Takes the mesh of the frame that a tracker has seen last.
   * @param {FaceTracker} tracker
   * @param {Tracked} tracked
   */
  async follow(tracker, { result }) {
    this.#mesh = undefined;
    if (this.#controls.choice.mode === 'none' || result.state === 'searching') return;
    await this.#tablesOf(tracker);
    this.#mesh = await tracker.mesh('picture');
  }

  /**
   * @param {string} name
   * @param {() => HTMLCanvasElement} make
   */
  #made(name, make) {
    if (this.#texture.name !== name) this.#texture = { name, canvas: make() };
    return /** @type {HTMLCanvasElement} */ (this.#texture.canvas);
  }

  /**
   * @param {MeshTables} tables
   * @param {Choice} choice
   * @param {number} width Width of a line [px].
   * @returns {Look}
   */
  #look(tables, { mode, texture, lips, lids }, width) {
    if (mode === 'wire') return { ...WIRE, width };
    if (mode === 'mask') {
      return { texture: texture ?? this.#made('mask', () => paintedMask(tables)) };
    }
    return { texture: this.#made(`${lips} ${lids}`, () => makeUp(tables, lips, lids)) };
  }

  /**
   * Draws the mesh that was taken last over its picture.
   * @param {CanvasRenderingContext2D} context
   * @param {Tracked} tracked
   */
  paint(context, { width, height }) {
    const { choice } = this.#controls;
    if (!this.#mesh || !this.#tables || choice.mode === 'none') return;
    if (!this.#surface || this.#surface.isLost) this.#surface = surfaceFor(this.#tables);
    const scale = context.canvas.width / width;
    const { left, right, top, bottom } = this.#surface.draw(this.#mesh, width, height, scale,
      this.#look(this.#tables, choice, Math.max(1, scale / 2)));
    if (left === right || top === bottom) return;
    context.save();
    if (choice.mode === 'make-up') {
      context.globalCompositeOperation = 'multiply';
      context.globalAlpha = choice.strength;
    }
    const part = /** @type {const} */ ([left, top, right - left, bottom - top]);
    context.drawImage(this.#surface.canvas, ...part, ...part);
    context.restore();
  }
}
