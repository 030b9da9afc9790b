// The demo page: plays a source, tracks its frames in a worker, shows what comes out.

import { FaceTracker, grabbed, moduleName, startWorker } from '../posewise.js';
import { asset, embeddedWorker, isStandalone } from './assets.js';
import { attempt, begin, connectDisplay, element, say, showFrame } from './display.js';
import { Source } from './sources.js';

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

const video = element('video', HTMLVideoElement);
const stage = element('stage', HTMLElement);
const model = element('model', HTMLSelectElement);
const pause = element('pause', HTMLButtonElement);
const source = new Source(video);
/** @type {FaceTracker | undefined} */
let tracker;
let isBusy = false;

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
    showFrame(shown, await current.track(frame, timestampUs));
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
  begin(source.isCamera);
  pause.setAttribute('aria-pressed', 'false');
  await tracker?.reset();
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
  model.addEventListener('change', () => attempt(loadModel));
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
connectDisplay(() => tracker?.animationNames ?? []);
await attempt(async () => {
  await Promise.all([loadModel(), source.clip()]);
  say('Looking for a face…');
});
