// What the driver monitor says: eyes with their reason, PERCLOS, zones, events as they come.

import { element } from '../display.js';
import { cameraOf } from '../overlay.js';
import { show } from '../readings.js';
import { drawPlan } from './plan.js';

/** @typedef {import('../../layout.js').MonitorEvent} MonitorEvent */
/** @typedef {import('../../layout.js').MonitorState} MonitorState */
/** @typedef {import('../../worker.js').Tracked} Tracked */
/** @typedef {import('./zones.js').NamedZone} NamedZone */

/** Events that are shown. */
const MOST_EVENTS = 12;
/** Length of the ray of the gaze [mm]. */
const RAY_MM = 250;
const RAY = 'rgb(80 160 255)';

/** Why eyes are unknown, in words. */
const WHY_UNKNOWN = {
  'none': '',
  'no-face': 'no face is tracked',
  'low-confidence': 'the face is too uncertain',
  'turned': 'the head is turned away',
  'hidden': 'something hides the eyes',
  'elsewhere': 'the face is not at the driver’s place',
};

const SLEEPINESS = {
  unknown: 'unknown: too little was seen',
  awake: 'awake',
  questionable: 'between awake and drowsy',
  drowsy: 'drowsy',
};

/** @param {number} us */
function seconds(us) {
  return `${(us / 1e6).toFixed(1)} s`;
}

/** @param {number[]} angles Yaw and pitch [deg]. */
function direction([yaw, pitch]) {
  const side = `${Math.abs(yaw).toFixed(0)}° ${yaw < 0 ? 'left' : 'right'}`;
  return `${side}, ${Math.abs(pitch).toFixed(0)}° ${pitch < 0 ? 'down' : 'up'}`;
}

/**
 * @param {MonitorState['zone']} zone
 * @param {NamedZone[]} zones
 */
function zoneName(zone, zones) {
  return typeof zone === 'number' ? zones[zone].name : zone;
}

/**
 * The eyes in words.
 * @param {MonitorState} state
 */
function eyes({ eyes, eyesReason, openness, closureUs, lookDownUs }) {
  if (eyes === 'unknown') return `unknown: ${WHY_UNKNOWN[eyesReason]}`;
  const open = `${eyes}, ${(100 * openness).toFixed(0)} %`;
  if (eyes === 'closed') return `${open}, for ${seconds(closureUs)}`;
  return lookDownUs > 0 ? `${open}, look down for ${seconds(lookDownUs)}` : open;
}

/**
 * What is known of the direction, in words.
 * @param {MonitorState} state
 * @param {NamedZone[]} zones
 */
function looks(state, zones) {
  const { zone, zoneBy, zoneUs, fromRoadDeg, gazeFromRoadDeg, naturalIsFinal } = state;
  if (zone === 'unknown') {
    return naturalIsFinal ? 'unknown' : 'unknown: the direction of the road is still learnt';
  }
  const at = zoneBy === 'gaze' ? gazeFromRoadDeg : fromRoadDeg;
  return `${zoneName(zone, zones)} for ${seconds(zoneUs)}, by the ${zoneBy}: ${direction(at)}`;
}

/**
 * Name and text of each number.
 * @param {MonitorState} state
 * @param {NamedZone[]} zones
 * @returns {[string, string][]}
 */
export function driverReadings(state, zones) {
  const { perclos60: window } = state;
  const percent = (/** @type {number} */ share) => `${(100 * share).toFixed(0)} %`;
  const known = `${percent(window.known)} of the last minute known`;
  const learnt = [
    ['pose', state.naturalIsFinal], ['gaze', state.naturalGazeIsFinal],
    ['open eyes', state.openEyeIsFinal], ['place', state.placeIsFinal],
  ].map(([name, isFinal]) => `${name} ${isFinal ? 'learnt' : 'not yet'}`);
  return [
    ['eyes', eyes(state)],
    ['looks at', looks(state, zones)],
    ['off the road', `${seconds(state.awayUs)}, ${seconds(state.away30Us)} of the last 30 s`],
    ['PERCLOS', window.known > 0 ? `${percent(window.p80)}, ${known}` : 'unknown'],
    ['drowsiness', SLEEPINESS[state.drowsiness]],
    ['counted', `${state.blinks} blinks, ${state.yawns} yawns, ${state.nods} nods`],
    ['driver', learnt.join(', ')],
  ];
}

/**
 * A line of an event.
 * @param {MonitorEvent} event
 * @param {NamedZone[]} zones
 */
export function eventText({ timestampUs, durationUs, kind, zone, isCut }, zones) {
  const parts = [seconds(timestampUs), kind.replaceAll('-', ' ')];
  if (durationUs > 0) parts.push(`for ${isCut ? 'at least ' : ''}${seconds(durationUs)}`);
  if (zone !== 'unknown') parts.push(`(${zoneName(zone, zones)})`);
  return parts.join(' ');
}

export class DriverPanel {
  #section = element('driver', HTMLElement);
  #plan = element('driver-plan', HTMLCanvasElement);
  #list = element('driver-readings', HTMLElement);
  #perclos = element('driver-perclos', HTMLMeterElement);
  #events = element('driver-events', HTMLOListElement);

  #zones;

  /** @param {NamedZone[]} zones Those of the monitor. */
  constructor(zones) {
    this.#zones = zones;
  }

  /** @param {boolean} isShown */
  toggle(isShown) {
    this.#section.hidden = !isShown;
    this.#events.replaceChildren();
  }

  /** @param {Tracked} tracked */
  show({ monitor }) {
    if (!monitor) return;
    const { state, events } = monitor;
    const zones = this.#zones;
    show(this.#list, driverReadings(state, zones));
    this.#perclos.value = state.perclos60.p80;
    drawPlan(this.#plan, zones, state);
    this.#plan.setAttribute('aria-label', `Zones. Looks at: ${looks(state, zones)}`);
    for (const event of events) {
      const item = document.createElement('li');
      item.textContent = eventText(event, zones);
      this.#events.prepend(item);
    }
    while (this.#events.children.length > MOST_EVENTS) this.#events.lastElementChild?.remove();
  }

  /**
   * Draws the ray of the gaze over its picture.
   * @param {CanvasRenderingContext2D} context
   * @param {Tracked} tracked
   */
  paint(context, tracked) {
    const { state, gaze, translationMm: from } = tracked.result;
    if (state !== 'tracking' || gaze[2] === 0) return;
    const { fx, fy, cx, cy } = cameraOf(tracked);
    const scale = context.canvas.width / tracked.width;
    const to = from.map((v, i) => v + RAY_MM * gaze[i]);
    context.strokeStyle = RAY;
    context.lineWidth = scale * Math.max(2, tracked.result.faceBox[2] / 40);
    context.beginPath();
    for (const [x, y, z] of [from, to]) {
      context.lineTo(scale * ((fx * x) / z + cx + 0.5), scale * ((fy * y) / z + cy + 0.5));
    }
    context.stroke();
  }
}
