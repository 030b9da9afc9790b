// The avatar beside the picture: a head that moves with the weights and the rotation that are
// tracked, retargeted as a file of the visitor's says.

import { asset } from '../assets.js';
import { attempt, element } from '../display.js';
import { save } from '../save.js';
import { AvatarCanvas } from './draw.js';
import { AvatarHead } from './head.js';
import { Retargeting } from './retargeting.js';

/** @typedef {import('../../posewise.js').FaceTracker} FaceTracker */
/** @typedef {import('../../worker.js').Tracked} Tracked */

/** Largest file that is read [bytes]. */
const MOST_FILE = 1 << 20;

/** Before the first face. */
const AHEAD = { weights: /** @type {Record<string, number>} */ ({}), rotation: [0, 0, 0, 1] };

export class AvatarView {
  #canvas = new AvatarCanvas(element('avatar-picture', HTMLCanvasElement));
  #note = element('avatar-note', HTMLOutputElement);
  #head;
  #tracked;
  #retargeting;
  #shown = AHEAD;

  /**
   * Loads the head and connects the controls.
   * @param {FaceTracker} tracker Whose names the weights have.
   * @param {() => void} changed Called when it is to be drawn anew.
   */
  static async create(tracker, changed) {
    const head = new AvatarHead(await asset('demo/avatar/head.bin'));
    return new AvatarView(head, [...tracker.animationNames, ...tracker.eyeLookNames], changed);
  }

  /**
   * @param {AvatarHead} head
   * @param {string[]} tracked
   * @param {() => void} changed
   */
  constructor(head, tracked, changed) {
    this.#head = head;
    this.#tracked = tracked;
    this.#retargeting = new Retargeting(tracked);
    const file = element('retargeting', HTMLInputElement);
    file.addEventListener('change', () => attempt(async () => {
      const first = file.files?.[0];
      if (first) await this.retarget(first);
      // The same file may be chosen again, after it was edited.
      file.value = '';
      changed();
    }));
    element('as-tracked', HTMLButtonElement).addEventListener('click', () => {
      this.#retargeting = new Retargeting(tracked);
      this.#say('Weights are as tracked.');
      changed();
    });
    element('retargeting-template', HTMLButtonElement).addEventListener('click', () =>
      save('retargeting.json', new Blob([this.#retargeting.text], { type: 'application/json' })));
    this.show();
  }

  /**
   * @param {string} text
   * @param {boolean} [isError]
   */
  #say(text, isError = false) {
    this.#note.textContent = text;
    this.#note.classList.toggle('error', isError);
  }

  /**
   * Retargets as a file says.
   * @param {File} file
   */
  async retarget(file) {
    try {
      if (file.size > MOST_FILE) throw new Error('larger than 1 MB');
      this.#retargeting = Retargeting.read(await file.text(), this.#tracked);
      this.#say(`Weights are those of ${file.name}.`);
    } catch (error) {
      this.#say(`${file.name}: ${error instanceof Error ? error.message : error}`, true);
    }
  }

  /**
   * Shows a frame; without a face, what was shown before.
   * @param {Tracked} [tracked]
   * @param {boolean} [isSmooth]
   */
  show(tracked, isSmooth = false) {
    if (tracked && tracked.result.state !== 'searching') {
      const { rotation, eyeLook } = isSmooth ? tracked.smoothed : tracked.result;
      const animation = isSmooth ? tracked.smoothedAnimation : tracked.animation;
      const values = [...animation, ...eyeLook];
      const weights = Object.fromEntries(this.#tracked.map((name, i) => [name, values[i]]));
      this.#shown = { weights, rotation };
    }
    const { weights, rotation } = this.#shown;
    const known = Object.fromEntries(this.#tracked.map((name) => [name, weights[name] ?? 0]));
    this.#head.pose(this.#retargeting.weights(known), rotation);
    this.#canvas.draw(this.#head);
  }
}
