// The controls of the dense mesh.

import { attempt, element } from '../display.js';
import { save } from '../save.js';
import { template, textureFrom } from './textures.js';

/** @typedef {import('../../tracker.js').MeshTables} MeshTables */

/**
 * What was chosen.
 * @typedef {object} Choice
 * @property {'none' | 'wire' | 'mask' | 'make-up'} mode
 * @property {HTMLCanvasElement} [texture] Of the mask, in place of the painted one.
 * @property {string} lips Colour of the make-up, of CSS.
 * @property {string} lids
 * @property {number} strength How much of the make-up, 0..1.
 */

/** Points and landmark mesh would lie over the dense mesh. */
const LANDMARKS_DRAWN = ['points', 'mesh'];

/** @param {string} id */
const inputOf = (id) => element(id, HTMLInputElement);

export class FaceControls {
  #modes = /** @type {HTMLInputElement[]} */ ([...document.querySelectorAll('input[name=face]')]);
  #note = element('texture-note', HTMLOutputElement);
  /** @type {HTMLCanvasElement | undefined} */
  #texture;
  /** @type {HTMLInputElement[] | undefined} The landmarks that were drawn before the mesh was. */
  #leftOut;

  /**
   * @param {() => Promise<MeshTables>} tables
   * @param {() => void} changed Called when the mask has another texture.
   */
  constructor(tables, changed) {
    for (const radio of this.#modes) radio.addEventListener('input', () => this.#showMode());
    const file = inputOf('texture');
    file.addEventListener('change', async () => {
      const first = file.files?.[0];
      if (first) await this.wear(first);
      // The same file may be chosen again, after it was painted on.
      file.value = '';
      changed();
    });
    element('painted', HTMLButtonElement).addEventListener('click', () => {
      this.#texture = undefined;
      this.#say('The mask is the painted one.');
      changed();
    });
    element('template', HTMLButtonElement).addEventListener('click', () => attempt(async () => {
      const canvas = template(await tables());
      canvas.toBlob((blob) => blob && save('posewise-template.png', blob));
    }));
    this.#showMode();
  }

  /** @returns {Choice} */
  get choice() {
    const chosen = this.#modes.find(({ checked }) => checked);
    return {
      mode: /** @type {Choice['mode']} */ (chosen?.value ?? 'none'),
      texture: this.#texture,
      lips: inputOf('lips').value,
      lids: inputOf('lids').value,
      strength: Number(inputOf('strength').value) / 100,
    };
  }

  /** Shows the controls of the mode. With a mesh the landmarks go, until they are ticked again. */
  #showMode() {
    const { mode } = this.choice;
    element('mask', HTMLElement).hidden = mode !== 'mask';
    element('make-up', HTMLElement).hidden = mode !== 'make-up';
    if (mode === 'none') {
      for (const box of this.#leftOut ?? []) box.checked = true;
      this.#leftOut = undefined;
    } else if (!this.#leftOut) {
      const boxes = /** @type {NodeListOf<HTMLInputElement>} */ (
        document.querySelectorAll('input[name=draw]:checked'));
      this.#leftOut = [...boxes].filter(({ value }) => LANDMARKS_DRAWN.includes(value));
      for (const box of this.#leftOut) box.checked = false;
    }
  }

  /**
   * Says which texture the mask has, or what is wrong with a picture.
   * @param {string} text
   * @param {boolean} [isError]
   */
  #say(text, isError = false) {
    this.#note.textContent = text;
    this.#note.classList.toggle('error', isError);
  }

  /**
   * Makes a picture the mask's texture, and chooses the mask.
   * @param {File} file
   */
  async wear(file) {
    inputOf('face-mask').checked = true;
    this.#showMode();
    try {
      this.#texture = await textureFrom(file);
      this.#say(`The mask is ${file.name}.`);
    } catch (error) {
      this.#say(error instanceof Error ? error.message : String(error), true);
    }
  }
}
