// The page of `posewise view`: shows what a tracker elsewhere sees. The command serves index.html
// with this module in place of app.js.
//
// The page asks for each frame when it has shown the one before, so that nothing piles up on a slow
// line. A message is the length of a JSON text (32 bits, little-endian), the text, a JPEG picture.

import { attempt, begin, connectDisplay, element, say, showFrame } from './display.js';
import { DriverPanel } from './driver/panel.js';
import { withNames } from './driver/zones.js';

/** @typedef {import('../worker.js').Tracked} Tracked */
/**
 * What a message has beside it.
 * @typedef {object} Page
 * @property {string[]} animationNames
 * @property {Omit<import('./driver/zones.js').NamedZone, 'name'>[]} zones Those of a monitor.
 */

/** Time until a lost connection is tried again [ms]. */
const RETRY_MS = 1000;

/** @type {string[]} */
let animationNames = [];
/** @type {DriverPanel | undefined} Where the command watches a driver. */
let driver;

/** @param {ArrayBuffer} message */
async function showMessage(message) {
  const length = new DataView(message).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(message, 4, length));
  /** @type {Tracked & Page} */
  const tracked = JSON.parse(text);
  animationNames = tracked.animationNames;
  const jpeg = new Blob([new Uint8Array(message, 4 + length)], { type: 'image/jpeg' });
  const picture = await createImageBitmap(jpeg);
  if (tracked.monitor && !driver) {
    driver = new DriverPanel(withNames(tracked.zones));
    driver.toggle(true);
  }
  showFrame(picture, tracked, (context) => driver?.paint(context, tracked));
  driver?.show(tracked);
  picture.close();
}

/** Follows the tracker, and tries again when the connection is lost. */
function follow() {
  const socket = new WebSocket(new URL('frames', document.baseURI.replace(/^http/, 'ws')));
  socket.binaryType = 'arraybuffer';
  const next = () => socket.send('next');
  socket.onopen = () => {
    begin();
    say('Waiting for a frame…');
    next();
  };
  socket.onmessage = ({ data }) => attempt(async () => {
    await showMessage(data);
    if (socket.readyState === WebSocket.OPEN) next();
  });
  socket.onclose = ({ code, reason }) => {
    // 1000: the command has ended.
    if (code === 1000) return say(reason || 'The command has ended.');
    say('No connection to the command. Trying again…', true);
    setTimeout(follow, RETRY_MS);
  };
}

for (const id of ['source', 'models', 'video', 'face', 'avatar', 'avatar-picture', 'take',
  'driver-monitor']) {
  element(id, HTMLElement).remove();
}
connectDisplay(() => animationNames);
follow();
