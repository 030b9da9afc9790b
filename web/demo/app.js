// The demo page: plays a source, tracks its frames in a worker, shows what comes out.

import { FaceTracker, grabbed, moduleName, startWorker } from '../posewise.js';
import { asset, embeddedWorker, isStandalone } from './assets.js';
import { Chart } from './charts.js';
import { header, row, save } from './csv.js';
import { draw } from './overlay.js';
import { readings, show } from './readings.js';
import { Source } from './sources.js';

/** @typedef {import('../worker.js').Tracked} Tracked */

/** What the page says of each model; models/*.md has the terms. */
const NOTES = {
  default: 'Trained on renders and research photographs: check its terms before you ship it.',
  clean: 'Trained on renders only: may ship in a product, under the MIT licence.',
};

/**
 * Work of a step while it searches: more than the default, so that a face is found at once. The
 * worker has time for it.
 */
const SCAN_BUDGET = 20_000;

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
function element(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${id}`);
  return found;
}

const picture = element('picture', HTMLCanvasElement);
const context = /** @type {CanvasRenderingContext2D} */ (picture.getContext('2d'));
const video = element('video', HTMLVideoElement);
const status = element('status', HTMLParagraphElement);
const stage = element('stage', HTMLElement);
const model = element('model', HTMLSelectElement);
const pause = element('pause', HTMLButtonElement);
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

const source = new Source(video);
/** @type {FaceTracker | undefined} */
let tracker;
/** @type {string[] | undefined} */
let table;
let isBusy = false;

/**
 * Says something to everybody, screen readers included.
 * @param {string} text
 * @param {boolean} [isError]
 */
function say(text, isError = false) {
  if (status.textContent !== text) status.textContent = text;
  status.classList.toggle('error', isError);
}

/**
 * Does something that may fail, and says so then.
 * @param {() => Promise<void>} action
 */
async function attempt(action) {
  try {
    await action();
  } catch (error) {
    say(error instanceof Error ? error.message : String(error), true);
  }
}

/** Starts a tracker with the chosen model. */
async function loadModel() {
  const name = model.value === 'clean' ? 'clean' : 'default';
  element('model-note', HTMLElement).textContent = NOTES[name];
  const [wasm, bytes, worker] = await Promise.all([
    asset(moduleName()).then((module) => WebAssembly.compile(module)),
    asset(`${name}.posewise`),
    isStandalone() ? embeddedWorker() : startWorker(),
  ]);
  const config = { scanBudget: SCAN_BUDGET };
  const next = await FaceTracker.create({ wasm, model: bytes, worker, config });
  const before = tracker;
  tracker = next;
  isBusy = false;
  await before?.close();
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
 * Shows a picture with what was found in it.
 * @param {CanvasImageSource} image
 * @param {Tracked} tracked
 */
function showFrame(image, tracked) {
  const { width, height, result } = tracked;
  if (picture.width !== width || picture.height !== height) {
    picture.width = width;
    picture.height = height;
  }
  context.drawImage(image, 0, 0, width, height);
  const boxes = document.querySelectorAll('input[name=draw]:checked');
  const wanted = new Set(Array.from(boxes, (box) => /** @type {HTMLInputElement} */ (box).value));
  const isSmooth = smooth.checked;
  draw(context, isSmooth ? tracked.smoothed : result,
    isSmooth ? tracked.smoothedLandmarks : tracked.landmarks, wanted);
  show(list, readings(tracked, isSmooth));
  chart(tracked);
  const text = { searching: 'No face', tracking: 'Face found', coasting: 'Face lost for a moment' };
  picture.setAttribute('aria-label', `Video. ${text[result.state]}`);
  say(text[result.state]);
}

/** @param {number} timestampUs */
async function onFrame(timestampUs) {
  // A tracker that is busy does without this frame.
  if (isBusy || !tracker) return;
  const current = tracker;
  isBusy = true;
  /** @type {VideoFrame | ImageBitmap | undefined} */
  let shown;
  try {
    const frame = await grabbed(video, timestampUs);
    shown = frame instanceof ImageBitmap ? await createImageBitmap(frame) : frame.clone();
    const tracked = await current.track(frame, timestampUs);
    showFrame(shown, tracked);
    if (table) {
      table.push(row(table.length, tracked));
      rows.textContent = `${table.length - 1} rows`;
    }
    document.dispatchEvent(new CustomEvent('posewise:tracked', { detail: tracked }));
  } finally {
    shown?.close();
    // Another model may have been chosen in the meantime.
    if (current === tracker) isBusy = false;
  }
}

/**
 * Goes over to another source.
 * @param {() => Promise<void>} open
 */
async function use(open) {
  say('Opening…');
  await open();
  for (const one of [angles, shares, times]) one.clear();
  mirror.checked = source.isCamera;
  picture.classList.toggle('mirror', mirror.checked);
  pause.setAttribute('aria-pressed', 'false');
  await tracker?.reset();
}

/** Starts the recording, or ends and saves it. */
function toggleRecord() {
  if (table) save('posewise.csv', table);
  table = table ? undefined : [header(tracker?.animationNames ?? [])];
  record.textContent = table ? 'Stop and save' : 'Record CSV';
  record.setAttribute('aria-pressed', String(table !== undefined));
}

function connect() {
  const on = (/** @type {string} */ id, /** @type {() => Promise<void>} */ action) =>
    element(id, HTMLElement).addEventListener('click', () => attempt(action));
  on('use-clip', () => use(() => source.clip()));
  on('use-camera', () => use(() => source.camera()));
  on('pause', async () => {
    pause.setAttribute('aria-pressed', String(!video.paused));
    await (video.paused ? video.play() : video.pause());
  });
  on('record', async () => toggleRecord());
  model.addEventListener('change', () => attempt(loadModel));
  mirror.addEventListener('change', () => picture.classList.toggle('mirror', mirror.checked));
  const file = element('file', HTMLInputElement);
  const open = (/** @type {FileList | null | undefined} */ files) => {
    const first = files?.[0];
    if (first) attempt(() => use(() => source.file(first)));
  };
  file.addEventListener('change', () => open(file.files));
  stage.addEventListener('dragover', (event) => {
    event.preventDefault();
    stage.classList.add('dropping');
  });
  stage.addEventListener('dragleave', () => stage.classList.remove('dropping'));
  stage.addEventListener('drop', (event) => {
    event.preventDefault();
    stage.classList.remove('dropping');
    open(event.dataTransfer?.files);
  });
  source.eachFrame((timestampUs) => attempt(() => onFrame(timestampUs)));
}

connect();
await attempt(async () => {
  await Promise.all([loadModel(), source.clip()]);
  say('Looking for a face…');
});
