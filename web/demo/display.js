// What the page shows of a frame, whoever tracked it: picture, drawing, numbers, curves, table.

import { Chart } from './charts.js';
import { header, row, tableOf } from './csv.js';
import { draw } from './overlay.js';
import { readings, show } from './readings.js';
import { save } from './save.js';

/** @typedef {import('../worker.js').Tracked} Tracked */

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function element(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${id}`);
  return found;
}

const picture = element('picture', HTMLCanvasElement);
const context = /** @type {CanvasRenderingContext2D} */ (picture.getContext('2d'));
const status = element('status', HTMLParagraphElement);
const record = element('record', HTMLButtonElement);
const rows = element('rows', HTMLOutputElement);
const smooth = element('smooth', HTMLInputElement);
const mirror = element('mirror', HTMLInputElement);
const list = element('readings', HTMLElement);

/**
 * @param {string} id
 * @param {string[]} curves
 * @param {[number, number]} least
 */
const chartIn = (id, curves, least) => new Chart(element(id, HTMLCanvasElement), curves, least);
const angles = chartIn('angles', ['yaw', 'pitch', 'roll'], [-30, 30]);
const shares = chartIn('shares', ['left', 'right', 'confidence'], [0, 1]);
const times = chartIn('times', ['step', 'pixels'], [0, 5]);

/** @type {{ lines: string[], isWatched: boolean } | undefined} */
let table;
/** Whether the last frame was watched by a driver monitor. */
let isWatched = false;

/**
 * Says something to everybody, screen readers included.
 * @param {string} text
 * @param {boolean} [isError]
 */
export function say(text, isError = false) {
  if (status.textContent !== text) status.textContent = text;
  status.classList.toggle('error', isError);
}

/**
 * Does something that may fail, and says so then.
 * @param {() => Promise<void>} action
 */
export async function attempt(action) {
  try {
    await action();
  } catch (error) {
    say(error instanceof Error ? error.message : String(error), true);
  }
}

/**
 * Pixels of the canvas for one of a frame, across: lines over small frames are fine too.
 * @param {number} width Width of the frame [px].
 */
export function scaleOf(width) {
  return Math.max(1, Math.ceil(640 / width));
}

/** @param {Tracked} tracked */
function chart({ result: r, stepMs, pixelsMs }) {
  const hasFace = r.state !== 'searching';
  const known = (/** @type {number} */ value) => (hasFace && value >= 0 ? value : null);
  const angle = (/** @type {number} */ value) => (hasFace ? value : null);
  angles.add(r.timestampUs, [angle(r.yawDeg), angle(r.pitchDeg), angle(r.rollDeg)]);
  shares.add(r.timestampUs, [known(r.eyeOpen[0]), known(r.eyeOpen[1]), known(r.confidence)]);
  times.add(r.timestampUs, [stepMs, pixelsMs]);
}

/**
 * Draws a picture with what was found in it.
 * @param {CanvasImageSource} image
 * @param {Tracked} tracked
 * @param {(context: CanvasRenderingContext2D) => void} [paint] Draws between the picture and the
 *   landmarks.
 */
export function drawFrame(image, tracked, paint) {
  const { width, height, result } = tracked;
  const scale = scaleOf(width);
  if (picture.width !== scale * width || picture.height !== scale * height) {
    picture.width = scale * width;
    picture.height = scale * height;
  }
  context.drawImage(image, 0, 0, picture.width, picture.height);
  paint?.(context);
  const boxes = document.querySelectorAll('input[name=draw]:checked');
  const wanted = new Set(Array.from(boxes, (box) => /** @type {HTMLInputElement} */ (box).value));
  // Pixels of the frame have their centres at whole numbers.
  context.setTransform(scale, 0, 0, scale, scale / 2, scale / 2);
  draw(context, tracked, smooth.checked ? tracked.smoothed : result,
    smooth.checked ? tracked.smoothedLandmarks : tracked.landmarks, wanted);
  context.resetTransform();
}

/**
 * Shows a picture and what was found in it.
 * @param {CanvasImageSource} image
 * @param {Tracked} tracked
 * @param {(context: CanvasRenderingContext2D) => void} [paint] As for `drawFrame`.
 */
export function showFrame(image, tracked, paint) {
  const { result } = tracked;
  drawFrame(image, tracked, paint);
  show(list, readings(tracked, smooth.checked));
  chart(tracked);
  const text = { searching: 'No face', tracking: 'Face found', coasting: 'Face lost for a moment' };
  picture.setAttribute('aria-label', `Video. ${text[result.state]}`);
  say(text[result.state]);
  isWatched = tracked.monitor !== undefined;
  if (table) {
    const { lines } = table;
    lines.push(row(lines.length, tracked, table.isWatched));
    rows.textContent = `${lines.length - 1} rows`;
  }
  document.dispatchEvent(new CustomEvent('posewise:tracked', { detail: tracked }));
}

/** Forgets the curves, and mirrors the picture or not: for another source. */
export function begin(isMirrored = false) {
  for (const one of [angles, shares, times]) one.clear();
  mirror.checked = isMirrored;
  picture.classList.toggle('mirror', isMirrored);
}

/**
 * Connects the controls that need no tracker.
 * @param {() => string[]} animationNames Names of the weights, for the table's first line.
 */
export function connectDisplay(animationNames) {
  mirror.addEventListener('change', () => picture.classList.toggle('mirror', mirror.checked));
  // Starts the recording, or ends and saves it.
  record.addEventListener('click', () => {
    if (table) save('posewise.csv', tableOf(table.lines));
    table = table ? undefined : { lines: [header(animationNames(), isWatched)], isWatched };
    record.textContent = table ? 'Stop and save' : 'Record CSV';
    record.setAttribute('aria-pressed', String(table !== undefined));
  });
}

