// The driver monitor.

import { Handle } from './handle.js';
import {
  MONITOR_EVENT, MONITOR_OBSERVATION, MONITOR_RECORD_SIZE, MONITOR_STATE, MONITOR_ZONE,
  UNREAD_MONITOR_EVENTS,
} from './layout.js';

/** @typedef {import('./layout.js').MonitorEvent} MonitorEvent */
/** @typedef {import('./layout.js').MonitorState} MonitorState */
/** @typedef {import('./layout.js').Observation} Observation */

/**
 * Where a driver may look. Where zones overlap, the first one counts.
 *
 * Angles are those from the direction of the road, within -180..180: yaw > 0 to the image right,
 * pitch > 0 up. A box, along the axes, and a plane, the parallelogram centre ± half u ± half v, are
 * in the camera frame, within ±20000 mm.
 *
 * @typedef {[number, number]} Range Least and largest value.
 * @typedef {[number, number, number]} Point x, y, z [mm].
 *
 * @typedef {object} Place
 * @property {boolean} [isRoad] Whether it is the road. What is not the road is away from it.
 * @property {number} [graceUs] Time of a stay that does not count as away [us]; 0xFFFFFFFF: none of
 *   it does.
 *
 * @typedef {(
 *   { kind: 'angles', yawDeg: Range, pitchDeg: Range }
 *   | { kind: 'box', minMm: Point, maxMm: Point }
 *   | { kind: 'plane', centreMm: Point, halfUMm: Point, halfVMm: Point }
 * ) & Place} Zone
 */

/**
 * The numbers of each kind of zone, in the order of C, and how many each has.
 * @type {Record<Zone['kind'], [string[], number]>}
 */
const NUMBERS = {
  angles: [['yawDeg', 'pitchDeg'], 2],
  box: [['minMm', 'maxMm'], 3],
  plane: [['centreMm', 'halfUMm', 'halfVMm'], 3],
};

/**
 * A zone as the struct of C has it.
 * @param {Zone} zone
 */
function struct({ kind, isRoad = false, graceUs = 0, ...lists }) {
  if (!(kind in NUMBERS)) throw new TypeError(`unknown kind of zone ${kind}`);
  const [names, count] = NUMBERS[kind];
  /** @type {Record<string, number[]>} */
  const given = lists;
  for (const name of Object.keys(given)) {
    if (!names.includes(name)) throw new TypeError(`unknown field ${name}`);
  }
  const numbers = names.flatMap((name) => {
    if (given[name]?.length !== count) throw new TypeError(`${name} must have ${count} numbers`);
    return given[name];
  });
  return { kind, isRoad, graceUs, numbers: [...numbers, ...new Array(9 - numbers.length).fill(0)] };
}

/**
 * Watches one driver through the results of a tracker. Made by {@link Engine.createMonitor}.
 * What it measures, and what it is not, is in docs/driver-monitor.md of the repository.
 */
export class Monitor extends Handle {
  /**
   * Takes what {@link Tracker.observation} gives, or an observation from elsewhere, at its time.
   * Frames without a face are observations too; frames that were dropped need none. A time before
   * the last one means that the clock was set back; the same time is an error.
   * @param {Observation} observation
   * @param {number} timestampUs
   */
  update(observation, timestampUs) {
    const time = Math.trunc(timestampUs);
    if (!Number.isSafeInteger(time)) throw new RangeError(`timestampUs cannot be ${timestampUs}`);
    this.call('monitor_update', this.write(MONITOR_OBSERVATION, observation), BigInt(time));
  }

  /**
   * What it knows after the last observation.
   * @returns {MonitorState}
   */
  state() {
    return this.read(MONITOR_STATE, 'monitor_read');
  }

  /**
   * The events that were not read yet.
   * @returns {{ events: MonitorEvent[], overwritten: number }}
   */
  events() {
    const { found, other } = this.readList(MONITOR_EVENT, 'monitor_events', UNREAD_MONITOR_EVENTS);
    return { events: found, overwritten: other };
  }

  /**
   * Replaces the zones; times in zones begin anew. Without any, nothing is away.
   * @param {Zone[]} zones
   */
  setZones(zones) {
    // The library refuses more than it has room for, whatever they are.
    const at = this.write(MONITOR_ZONE, ...zones.slice(0, 32).map(struct));
    this.call('monitor_set_zones', at, zones.length);
  }

  /** Another person drives: forgets what it learnt and measured, and the time. */
  forgetDriver() {
    this.call('monitor_forget_driver');
  }

  /**
   * What was learnt of the driver, for {@link Monitor.restore} on the next drive.
   * @returns {Uint8Array}
   */
  save() {
    return this.readRecord('monitor_save', MONITOR_RECORD_SIZE);
  }

  /**
   * Guesses that the driver is the one of a record, until it has observed enough.
   * @param {Uint8Array} record
   */
  restore(record) {
    this.callWithRecord('monitor_restore', record, MONITOR_RECORD_SIZE);
  }
}
