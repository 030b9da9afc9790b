// Where frames come from: a camera, a file, or the demo clip, all played by one video element.

import { asset } from './assets.js';

/** Asked of a camera; it may give something else. */
const CAMERA = { width: { ideal: 640 }, height: { ideal: 480 }, facingMode: 'user' };

export class Source {
  #video;
  #ended = () => {};
  /** Added to media time, so that a clip that starts again goes on [us]. */
  #offsetUs = 0;
  #lastUs = -1;

  /** @param {HTMLVideoElement} video */
  constructor(video) {
    this.#video = video;
  }

  /** Plays the camera. */
  async camera() {
    if (!navigator.mediaDevices) throw new Error('this page may not use a camera (needs https)');
    const stream = await navigator.mediaDevices.getUserMedia({ video: CAMERA, audio: false });
    await this.#play(() => (this.#video.srcObject = stream), () =>
      stream.getTracks().forEach((track) => track.stop()));
  }

  /**
   * Plays the demo clip.
   * @param {Promise<ArrayBuffer>} [bytes] The clip, if somebody has begun to load it.
   */
  async clip(bytes = asset('demo/clip.webm')) {
    await this.file(new Blob([await bytes], { type: 'video/webm' }));
  }

  /**
   * Plays a video.
   * @param {Blob} file
   */
  async file(file) {
    const url = URL.createObjectURL(file);
    await this.#play(() => (this.#video.src = url), () => URL.revokeObjectURL(url));
  }

  /**
   * @param {() => void} open
   * @param {() => void} end
   */
  async #play(open, end) {
    this.#ended();
    this.#ended = end;
    const video = this.#video;
    video.srcObject = null;
    video.removeAttribute('src');
    video.loop = true;
    open();
    await new Promise((resolve, reject) => {
      video.onloadeddata = resolve;
      video.onerror = () => reject(new Error('the browser cannot play this video'));
      video.play().catch(reject);
    });
  }

  /** Whether the frames are those of a camera. */
  get isCamera() {
    return this.#video.srcObject !== null;
  }

  /**
   * Calls back with the time of each new frame [us], which always increases.
   * @param {(timestampUs: number) => void} callback
   */
  eachFrame(callback) {
    const video = this.#video;
    const time = (/** @type {number} */ nowMs, /** @type {number} */ mediaS) => {
      let us = Math.round(this.isCamera ? 1000 * nowMs : 1e6 * mediaS + this.#offsetUs);
      if (us <= this.#lastUs) {
        // Begun again, or another source.
        const next = this.#lastUs + 33_333;
        if (!this.isCamera) this.#offsetUs += next - us;
        us = next;
      }
      this.#lastUs = us;
      return us;
    };
    if (!('requestVideoFrameCallback' in video)) {
      let before = -1;
      const look = () => {
        const { currentTime } = this.#video;
        if (currentTime !== before && this.#video.readyState >= 2) {
          before = currentTime;
          callback(time(performance.now(), currentTime));
        }
        requestAnimationFrame(look);
      };
      requestAnimationFrame(look);
      return;
    }
    /** @type {VideoFrameRequestCallback} */
    const next = (now, { captureTime, mediaTime }) => {
      video.requestVideoFrameCallback(next);
      callback(time(captureTime ?? now, mediaTime));
    };
    video.requestVideoFrameCallback(next);
  }
}
