// The numbers beside the picture.

/** @typedef {import('../worker.js').Tracked} Tracked */

/** Frames over which times are averaged. */
const FRAMES = 60;

/** @type {number[]} */
let stepsMs = [];
/** @type {number[]} */
let arrivalsMs = [];

/** @param {number[]} values */
function median(values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}

/**
 * @param {number} value
 * @param {number} decimals
 */
function signed(value, decimals) {
  return (value < 0 ? '−' : '+') + Math.abs(value).toFixed(decimals);
}

/** @param {number} value */
function eye(value) {
  return value < 0 ? 'unknown' : value.toFixed(2);
}

/**
 * Name and text of each number.
 * @param {Tracked} tracked
 * @param {boolean} smooth
 * @returns {[string, string][]}
 */
export function readings(tracked, smooth) {
  const r = smooth ? tracked.smoothed : tracked.result;
  stepsMs = [...stepsMs, tracked.stepMs].slice(-FRAMES);
  arrivalsMs = [...arrivalsMs, performance.now()].slice(-FRAMES);
  const seconds = (arrivalsMs[arrivalsMs.length - 1] - arrivalsMs[0]) / 1000;
  const rate = arrivalsMs.length > 1 ? ((arrivalsMs.length - 1) / seconds).toFixed(0) : '–';
  const hasFace = r.state !== 'searching';
  const of = (/** @type {() => string} */ text) => (hasFace ? text() : '–');
  const angle = (/** @type {number} */ value, /** @type {number} */ i) =>
    of(() => `${signed(value, 1)}° ± ${r.rotationSigmaDeg[i].toFixed(1)}°`);
  const facing = (/** @type {number} */ value, /** @type {number} */ i) =>
    of(() => `${signed(value, 1)}° ± ${r.facingSigmaDeg[i].toFixed(1)}°`);
  return [
    ['state', r.state + (r.loss === 'none' ? '' : ` (${r.loss.replace('-', ' ')})`)],
    ['facing yaw', facing(r.facingYawDeg, 0)],
    ['facing pitch', facing(r.facingPitchDeg, 1)],
    ['facing roll', facing(r.facingRollDeg, 2)],
    ['yaw', angle(r.yawDeg, 1)],
    ['pitch', angle(r.pitchDeg, 0)],
    ['roll', angle(r.rollDeg, 2)],
    ['position', of(() => `${r.translationMm.map((v) => signed(v, 0)).join(', ')} mm`)],
    ['eyes open', of(() => `left ${eye(r.eyeOpen[0])}, right ${eye(r.eyeOpen[1])}`)],
    ['confidence', of(() => r.confidence.toFixed(2))],
    ['visible', of(() => `${(100 * r.visibleShare).toFixed(0)} %`)],
    ['tracker', `${median(stepsMs).toFixed(1)} ms a frame (median), ${rate} frames a second`],
    ['frame', `${tracked.width} × ${tracked.height}`],
  ];
}

/**
 * Shows the numbers in a description list.
 * @param {HTMLElement} list
 * @param {[string, string][]} pairs
 */
export function show(list, pairs) {
  if (list.children.length !== 2 * pairs.length) {
    list.replaceChildren(...pairs.flatMap(([name]) => {
      const term = document.createElement('dt');
      term.textContent = name;
      return [term, document.createElement('dd')];
    }));
  }
  const cells = list.querySelectorAll('dd');
  pairs.forEach(([, text], i) => {
    if (cells[i].textContent !== text) cells[i].textContent = text;
  });
}
