// The table that `posewise track --csv` writes, with the same columns; a test compares them. Fields
// that came later than these have columns by themselves.

import { LATER } from './columns.js';
import { MONITOR_COLUMNS } from './driver/columns.js';
import { axesOf } from './overlay.js';

/** @typedef {import('../worker.js').Tracked} Tracked */

/**
 * OpenFace's angles [rad]: pose_Rx, pose_Ry, pose_Rz.
 * @param {import('../layout.js').Result} result
 */
function openFaceAngles({ state, rotation }) {
  if (state === 'searching') return [0, 0, 0];
  const [x, y, z] = axesOf(rotation);
  const sine = Math.min(1, Math.max(-1, z[0]));
  return [Math.atan2(-z[1], z[2]), Math.asin(sine), Math.atan2(-y[0], x[0])];
}

/**
 * OpenFace's angles of the gaze of both eyes [rad].
 * @param {import('../layout.js').Result} result
 */
function gazeAngles({ gaze: [x, y, z] }) {
  return z < 0 ? [Math.atan2(x, -z), Math.atan2(y, -z)] : [0, 0];
}

/**
 * Columns by groups: names, decimals, values.
 * @type {[string[], number, (t: Tracked) => ArrayLike<number | string>][]}
 */
const GROUPS = [
  [['timestamp'], 6, ({ result: r }) => [r.timestampUs / 1e6]],
  [['confidence'], 4, ({ result: r }) => [r.confidence]],
  [['success'], 0, ({ result: r }) => [r.state === 'tracking' ? 1 : 0]],
  [['pose_Tx', 'pose_Ty', 'pose_Tz'], 2, ({ result: r }) => r.translationMm],
  [['pose_Rx', 'pose_Ry', 'pose_Rz'], 5, ({ result: r }) => openFaceAngles(r)],
  [each('x'), 3, (t) => t.landmarks.map((l) => l.x)],
  [each('y'), 3, (t) => t.landmarks.map((l) => l.y)],
  [each('X'), 2, (t) => t.landmarks.map((l) => l.xMm)],
  [each('Y'), 2, (t) => t.landmarks.map((l) => l.yMm)],
  [each('Z'), 2, (t) => t.landmarks.map((l) => l.zMm)],
  [['state'], 0, ({ result: r }) => [r.state]],
  [['yaw_deg', 'pitch_deg', 'roll_deg'], 3, ({ result: r }) => [r.yawDeg, r.pitchDeg, r.rollDeg]],
  [each('c'), 3, (t) => t.landmarks.map((l) => l.confidence)],
  [each('vis'), 2, (t) => t.landmarks.map((l) => l.visibility)],
  [['eye_open_left', 'eye_open_right'], 3, ({ result: r }) => r.eyeOpen],
  [['ANIMATION'], 3, (t) => t.animation],
  [['box_x', 'box_y', 'box_w', 'box_h'], 2, ({ result: r }) => r.faceBox],
  [['age_us'], 0, ({ result: r }) => [r.ageUs]],
  [['loss'], 0, ({ result: r }) => [r.loss]],
  [['visible_share'], 3, ({ result: r }) => [r.visibleShare]],
  [['R_sigma_x', 'R_sigma_y', 'R_sigma_z'], 3, ({ result: r }) => r.rotationSigmaDeg],
  [['T_sigma_x', 'T_sigma_y', 'T_sigma_z'], 2, ({ result: r }) => r.translationSigmaMm],
  [['gaze_0_x', 'gaze_0_y', 'gaze_0_z'], 4, ({ result: r }) => r.gazeRight],
  [['gaze_1_x', 'gaze_1_y', 'gaze_1_z'], 4, ({ result: r }) => r.gazeLeft],
  [['gaze_angle_x', 'gaze_angle_y'], 4, ({ result: r }) => gazeAngles(r)],
  [['gaze_head_x', 'gaze_head_y', 'gaze_head_z'], 4, ({ result: r }) => r.gazeHead],
  [['gaze_sigma_deg'], 2, ({ result: r }) => [r.gazeSigmaDeg[2]]],
  [['gaze_status'], 0, ({ result: r }) => [r.gazeStatus[2]]],
  [['eye_open_p_left', 'eye_open_p_right'], 3, ({ result: r }) => r.eyeOpenProbability],
  [['eye_status_left', 'eye_status_right'], 0, ({ result: r }) => r.eyeStatus],
  [['iris_left_x', 'iris_left_y', 'iris_right_x', 'iris_right_y'], 3,
    ({ result: r }) => [...r.irisLeft, ...r.irisRight]],
  [['glasses'], 3, ({ result: r }) => [r.glasses]],
  [['dark_glasses'], 3, ({ result: r }) => [r.darkGlasses]],
  [['eyeLookUpLeft', 'eyeLookUpRight', 'eyeLookDownLeft', 'eyeLookDownRight', 'eyeLookInLeft',
    'eyeLookInRight', 'eyeLookOutLeft', 'eyeLookOutRight'], 3, ({ result: r }) => r.eyeLook],
  [['facing_yaw_deg', 'facing_pitch_deg', 'facing_roll_deg'], 3,
    ({ result: r }) => [r.facingYawDeg, r.facingPitchDeg, r.facingRollDeg]],
  [['facing_yaw_sigma', 'facing_pitch_sigma', 'facing_roll_sigma'], 3,
    ({ result: r }) => r.facingSigmaDeg],
  [['focal_px'], 1, ({ result: r }) => [r.focalPx]],
  [['camera_assumed'], 0, ({ result: r }) => [Number(r.cameraAssumed)]],
  ...LATER,
];

/** @param {string} name */
function each(name) {
  return Array.from({ length: 68 }, (_, i) => `${name}_${i}`);
}

/**
 * The first line.
 * @param {string[]} animationNames
 * @param {boolean} isWatched Whether rows have the columns of the driver monitor.
 */
export function header(animationNames, isWatched) {
  const names = GROUPS.flatMap(([group]) => (group[0] === 'ANIMATION' ? animationNames : group));
  const more = isWatched ? MONITOR_COLUMNS.flatMap(([group]) => group) : [];
  return ['frame', 'face_id', ...names, ...more].join(',');
}

/**
 * @param {ArrayLike<number | string>} values
 * @param {number} decimals
 */
function cells(values, decimals) {
  return Array.from(values, (v) => (typeof v === 'string' ? v : v.toFixed(decimals)));
}

/**
 * The line of a frame, which are numbered from 1.
 * @param {number} frame
 * @param {Tracked} tracked
 * @param {boolean} isWatched As for `header`.
 */
export function row(frame, tracked, isWatched) {
  const { monitor } = tracked;
  const of = GROUPS.flatMap(([, decimals, values]) => cells(values(tracked), decimals));
  const more = isWatched ? MONITOR_COLUMNS.flatMap(([names, decimals, values]) =>
    (monitor ? cells(values(monitor), decimals) : names.map(() => ''))) : [];
  return [frame, 0, ...of, ...more].join(',');
}

/**
 * A whole table as a file.
 * @param {string[]} lines
 */
export function tableOf(lines) {
  return new Blob([lines.join('\n'), '\n'], { type: 'text/csv' });
}
