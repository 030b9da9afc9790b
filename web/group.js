// Several trackers on the same frames.

import { Handle } from './handle.js';
import { RESULT } from './layout.js';
import { clearStruct } from './struct.js';

/** @typedef {import('./engine.js').Frame} Frame */
/** @typedef {import('./layout.js').Result} Result */
/** @typedef {import('./tracker.js').Tracker} Tracker */

// More than the library takes; it refuses them.
const MOST = 32;

/**
 * Steps several trackers, so that each follows a face of its own, for less than they cost alone.
 * Made by {@link Engine.createGroup}.
 */
export class Group extends Handle {
  /**
   * Processes one frame; the result of each tracker. They are those of the steps before, in the
   * same order; those that are added come last.
   * @param {Tracker[]} trackers Of the same engine.
   * @param {Frame} frame
   * @param {number} timestampUs
   * @returns {Result[]}
   */
  step(trackers, frame, timestampUs) {
    const given = trackers.slice(0, MOST);
    const at = this.engine.writeFrame(frame, timestampUs);
    const [pointers, results] = [this.engine.scratch, this.engine.scratch + 8 * MOST];
    const { view } = this.engine;
    given.forEach((tracker, k) => {
      view.setUint32(pointers + 4 * k, tracker.address(this.engine), true);
      clearStruct(view, results + k * RESULT.size, RESULT);
    });
    this.call('group_step', pointers, trackers.length, at, results);
    return this.list(RESULT, results, trackers.length);
  }
}
