// Zones as a plan, seen from the driver: yaw across, pitch up, and where gaze and head point.

import { cleared } from '../charts.js';

/** @typedef {import('../../layout.js').MonitorState} MonitorState */
/** @typedef {import('./zones.js').NamedZone} NamedZone */

/** What the plan shows [deg]. */
const YAW = [-70, 70];
const PITCH = [-50, 35];
const MARK_PX = 6;

/**
 * Draws zones and directions. The image right is on the right, as in the picture.
 * @param {HTMLCanvasElement} canvas
 * @param {NamedZone[]} zones
 * @param {MonitorState} state
 */
export function drawPlan(canvas, zones, state) {
  const { context, width, height } = cleared(canvas);
  if (!context) return;
  const style = getComputedStyle(canvas);
  const share = (/** @type {number} */ v, /** @type {number[]} */ [low, high]) =>
    Math.min(1, Math.max(0, (v - low) / (high - low)));
  const x = (/** @type {number} */ yaw) => width * share(yaw, YAW);
  const y = (/** @type {number} */ pitch) => height * (1 - share(pitch, PITCH));
  context.font = '11px system-ui, sans-serif';
  context.textBaseline = 'top';
  zones.forEach(({ name, yawDeg, pitchDeg, isRoad }, index) => {
    if (yawDeg.length === 0) return;
    const [left, right, top, bottom] = [x(yawDeg[0]), x(yawDeg[1]), y(pitchDeg[1]), y(pitchDeg[0])];
    const isMet = state.zone === index;
    context.globalAlpha = isMet ? 0.35 : 0.08;
    context.fillStyle = style.getPropertyValue(isRoad ? '--green' : '--red');
    context.fillRect(left, top, right - left, bottom - top);
    context.globalAlpha = 1;
    context.strokeStyle = style.borderTopColor;
    context.strokeRect(left, top, right - left, bottom - top);
    context.fillStyle = style.color;
    context.fillText(name, left + 4, top + 3, Math.max(1, right - left - 8));
  });
  if (state.zone === 'unknown') return;
  const [yaw, pitch] = state.fromRoadDeg;
  context.strokeStyle = style.color;
  context.lineWidth = 2;
  context.strokeRect(x(yaw) - MARK_PX, y(pitch) - MARK_PX, 2 * MARK_PX, 2 * MARK_PX);
  if (state.zoneBy !== 'gaze') return;
  const [gazeYaw, gazePitch] = state.gazeFromRoadDeg;
  context.fillStyle = style.getPropertyValue('--blue');
  context.beginPath();
  context.arc(x(gazeYaw), y(gazePitch), MARK_PX, 0, 2 * Math.PI);
  context.fill();
}
