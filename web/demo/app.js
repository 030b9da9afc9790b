// The demo page: plays a source, tracks its frames in a worker, shows what comes out.

import { FaceTracker, grabbed, moduleName, startWorker } from '../posewise.js';
import { asset, compiled, embeddedWorker, isStandalone } from './assets.js';
import { attempt, begin, connectDisplay, drawFrame, element, say, showFrame } from './display.js';
import { firstClip, firstModel, firstModule, firstWorker } from './early.js';
import { Source } from './sources.js';

/** @typedef {import('../worker.js').Tracked} Tracked */

/** What the page says of each model; models/*.md has the terms. */
const NOTES = {
  posewise: 'Trained on renders and portraits in the public domain: may ship in a product.',
  research: 'Trained on renders and research photographs: check its terms before you ship it.',
};

/** Work of a searching step: a whole frame of 320×240 pixels, so the first shows a face. */
const SCAN_BUDGET = 200_000;

const video = element('video', HTMLVideoElement);
const stage = element('stage', HTMLElement);
const model = element('model', HTMLSelectElement);
const pause = element('pause', HTMLButtonElement);
const avatarShown = element('show-avatar', HTMLInputElement);
const driverWatched = element('watch-driver', HTMLInputElement);
const smoothing = element('smooth', HTMLInputElement);
const source = new Source(video);
/** @type {FaceTracker | undefined} */
let tracker;
let isBusy = false;
/** Time of the frame that the video shows [us]. */
let shownUs = -1;
/** @type {{ picture: VideoFrame | ImageBitmap, tracked: Tracked } | undefined} What is shown. */
let shown;
/** @type {import('./face/layer.js').FaceLayer | undefined} Once it is wanted. */
let face;
/** @type {import('./avatar/view.js').AvatarView | undefined} Likewise. */
let avatar;
/** @type {import('./driver/panel.js').DriverPanel | undefined} Likewise. */
let driver;
/** @type {import('./take/controls.js').TakeControls | undefined} Likewise. */
let take;

/** What the chosen model's tracker is made of. */
async function chosen() {
  const name = model.value === 'research' ? 'research' : 'posewise';
  element('model-note', HTMLElement).textContent = NOTES[name];
  return Promise.all([
    compiled(moduleName()),
    asset(`${name}.posewise`),
    isStandalone() ? embeddedWorker() : startWorker(),
  ]);
}

/**
 * An avatar looks around, a driver too; nothing else on the page needs the gaze.
 * @returns {'natural' | 'on' | 'off'}
 */
function gazeWanted() {
  if (driverWatched.checked) return 'natural';
  return avatarShown.checked ? 'on' : 'off';
}

/** The driver monitor of a tracker, where it is wanted. */
async function monitorWanted() {
  if (!driverWatched.checked) return {};
  const { zonesOfLibrary } = await import('./driver/zones.js');
  return { monitor: {}, zones: zonesOfLibrary() };
}

/**
 * Starts a tracker.
 * @param {Promise<[WebAssembly.Module, ArrayBuffer, Worker]>} parts
 */
async function loadModel(parts) {
  const [wasm, bytes, worker] = await parts;
  const config = { scanBudget: SCAN_BUDGET, gaze: gazeWanted() };
  const watch = await monitorWanted();
  const next = await FaceTracker.create({ wasm, model: bytes, worker, config, ...watch });
  await take?.end();
  const before = tracker;
  tracker = next;
  isBusy = false;
  await before?.close();
  // Frames that came before it are gone, but for the one that is shown.
  if (!before && shownUs >= 0) attempt(() => onFrame(shownUs));
}

/** @param {number} timestampUs */
async function onFrame(timestampUs) {
  // A tracker that is busy does without this frame.
  if (isBusy || !tracker) return;
  const current = tracker;
  isBusy = true;
  try {
    const frame = await grabbed(video, timestampUs);
    const picture = frame instanceof ImageBitmap ? await createImageBitmap(frame) : frame.clone();
    const tracked = await current.track(frame, timestampUs).catch((error) => {
      picture.close();
      throw error;
    });
    shown?.picture.close();
    shown = { picture, tracked };
    await face?.follow(current, tracked);
    showFrame(picture, tracked, paint);
    showAvatar();
    driver?.show(tracked);
    await take?.add(current, tracked);
  } finally {
    // Another model may have been chosen in the meantime.
    if (current === tracker) isBusy = false;
  }
}

/** The tracker, for what cannot do without it. */
function ready() {
  if (!tracker) throw new Error('The model is not loaded yet.');
  return tracker;
}

/** @param {CanvasRenderingContext2D} context */
function paint(context) {
  if (!shown) return;
  face?.paint(context, shown.tracked);
  if (driverWatched.checked) driver?.paint(context, shown.tracked);
}

/** Watches the driver, or no longer. */
async function toggleDriver() {
  const isWatched = driverWatched.checked;
  if (isWatched && !driver) {
    const { DriverPanel } = await import('./driver/panel.js');
    const { ZONES } = await import('./driver/zones.js');
    driver ??= new DriverPanel(ZONES);
  }
  driver?.toggle(isWatched);
  await loadModel(chosen());
}

/** Moves the avatar as the frame that is shown says. */
function showAvatar() {
  if (avatarShown.checked) avatar?.show(shown?.tracked, smoothing.checked);
}

/** Shows the avatar or not; what it takes is loaded when it is wanted. */
async function toggleAvatar() {
  const isShown = avatarShown.checked;
  if (!tracker) avatarShown.checked = false;
  if (isShown && !avatar) {
    const { AvatarView } = await import('./avatar/view.js');
    avatar ??= await AvatarView.create(ready(), () => attempt(redraw));
  }
  element('avatar-picture', HTMLCanvasElement).hidden = !isShown;
  element('avatar-controls', HTMLElement).hidden = !isShown;
  showAvatar();
  await loadModel(chosen());
}

/** What draws the dense mesh, loaded when it is wanted. */
async function faceLayer() {
  const { FaceLayer } = await import('./face/layer.js');
  face ??= new FaceLayer(ready, () => attempt(redraw));
  return face;
}

/** Draws the frame that is shown anew: something else is wanted of it. */
async function redraw() {
  // The next frame shows it anyway.
  if (isBusy || !tracker || !shown) return;
  await face?.follow(tracker, shown.tracked);
  if (shown) drawFrame(shown.picture, shown.tracked, paint);
  showAvatar();
}

/**
 * Goes over to another source.
 * @param {() => Promise<void>} open
 */
async function use(open) {
  say('Opening…');
  await take?.end();
  await open();
  begin(source.isCamera);
  pause.setAttribute('aria-pressed', 'false');
  await tracker?.reset();
  if (driverWatched.checked) await tracker?.forgetDriver();
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
  model.addEventListener('change', () => attempt(() => loadModel(chosen())));
  element('controls', HTMLFormElement).addEventListener('input', () => attempt(redraw));
  element('face', HTMLFieldSetElement).addEventListener('input', () => attempt(async () => {
    if (face) return;
    await faceLayer();
    await redraw();
  }));
  avatarShown.addEventListener('change', () => attempt(toggleAvatar));
  driverWatched.addEventListener('change', () => attempt(toggleDriver));
  on('record-take', async () => {
    if (take) return;
    const { TakeControls } = await import('./take/controls.js');
    take ??= new TakeControls(ready);
  });
  const file = element('file', HTMLInputElement);
  const open = (/** @type {FileList | null | undefined} */ files) => {
    const first = files?.[0];
    if (!first) return;
    attempt(async () => {
      if (first.name.endsWith('.json')) {
        if (!avatarShown.checked) {
          avatarShown.checked = true;
          await toggleAvatar();
        }
        await avatar?.retarget(first);
        return redraw();
      }
      if (!first.type.startsWith('image/')) return use(() => source.file(first));
      await (await faceLayer()).wear(first);
      await redraw();
    });
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
  source.eachFrame((timestampUs) => {
    shownUs = timestampUs;
    attempt(() => onFrame(timestampUs));
  });
}

connect();
connectDisplay(() => tracker?.animationNames ?? []);
await attempt(async () => {
  element('model-note', HTMLElement).textContent = NOTES.posewise;
  const parts = Promise.all([firstModule, firstModel, firstWorker]);
  await Promise.all([loadModel(parts), source.clip(firstClip)]);
  say('Looking for a face…');
});
