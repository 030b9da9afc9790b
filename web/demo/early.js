// Starts what the page needs first, before its other modules are there: index.html runs this file
// by itself.

import { moduleName, startWorker } from '../posewise.js';
import { asset, compiled, embeddedWorker, isStandalone } from './assets.js';

/**
 * Whoever waits for it later gets the error.
 * @template T
 * @param {Promise<T>} promise
 */
function begun(promise) {
  promise.catch(() => {});
  return promise;
}

/** @returns {Promise<Worker>} */
async function worker() {
  return isStandalone() ? embeddedWorker() : startWorker();
}

export const firstWorker = begun(worker());
export const firstModule = begun(compiled(moduleName()));
export const firstModel = begun(asset('posewise.posewise'));
export const firstClip = begun(asset('demo/clip.webm'));
