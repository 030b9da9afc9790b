// The controls of a take: record, stop, save.

import { attempt, element } from '../display.js';
import { cameraOf } from '../overlay.js';
import { save } from '../save.js';
import { Take } from './take.js';

/** @typedef {import('../../posewise.js').FaceTracker} FaceTracker */
/** @typedef {import('../../worker.js').Tracked} Tracked */

export class TakeControls {
  #record = element('record-take', HTMLButtonElement);
  #save = element('save-take', HTMLButtonElement);
  #time = element('take-time', HTMLElement);
  #note = element('take-note', HTMLOutputElement);
  /** @type {{ tracker: FaceTracker, take: Take, last?: Tracked } | undefined} What is recorded. */
  #running;
  /** @type {Blob | undefined} The last take. */
  #file;

  /**
   * Connects the controls and begins a take.
   * @param {() => FaceTracker} tracker
   */
  constructor(tracker) {
    this.#record.addEventListener('click', () => attempt(async () => {
      if (this.#running) await this.end();
      else this.#begin(tracker());
    }));
    this.#save.addEventListener('click', () => {
      if (this.#file) save('posewise.glb', this.#file);
    });
    this.#begin(tracker());
  }

  /** @param {FaceTracker} tracker */
  #begin(tracker) {
    this.#running = { tracker, take: new Take() };
    this.#save.disabled = true;
    this.#note.textContent = '';
    this.#show();
  }

  #show() {
    const isRunning = this.#running !== undefined;
    this.#record.textContent = isRunning ? 'Stop' : 'Record take';
    this.#record.setAttribute('aria-pressed', String(isRunning));
    this.#time.textContent = isRunning ? `${this.#running?.take.seconds.toFixed(0)} s` : '';
  }

  /**
   * Takes a frame, while a take is recorded. One that is as long as it may be ends.
   * @param {FaceTracker} tracker What tracked it.
   * @param {Tracked} tracked
   */
  async add(tracker, tracked) {
    if (this.#running?.tracker !== tracker) return;
    this.#running.last = tracked;
    this.#running.take.add(tracked);
    this.#show();
    if (this.#running.take.isFull) await this.end();
  }

  /** Ends the take that is recorded. The tracker must still know the face. */
  async end() {
    if (!this.#running) return;
    const { tracker, take, last } = this.#running;
    this.#running = undefined;
    this.#show();
    if (!last || !take.hasFace) {
      this.#note.textContent = 'There was no face: nothing to save.';
      return;
    }
    const names = tracker.animationNames;
    const [tables, neutral, ...meshes] = await Promise.all([
      tracker.meshTables(), tracker.meshShape(), ...names.map((name) => tracker.meshShape(name)),
    ]);
    const shapes = names.map((name, i) => ({ name, mesh: meshes[i] }));
    const camera = { ...cameraOf(last), width: last.width, height: last.height };
    const bytes = take.glb({ neutral, shapes, tables }, camera, tracker.version);
    this.#file = new Blob([bytes], { type: 'model/gltf-binary' });
    this.#save.disabled = false;
    const kilobytes = Math.ceil(bytes.length / 1000);
    this.#note.textContent = `${take.seconds.toFixed(1)} s, ${kilobytes} kB`;
  }
}
