// Curves of the last seconds, each with an axis that fits them.

/** Time that a chart shows [us]. */
const SPAN_US = 10e6;

/**
 * Empties a canvas, which gets the pixels of the screen that it takes; what is drawn is in CSS px.
 * @param {HTMLCanvasElement} canvas
 */
export function cleared(canvas) {
  const scale = globalThis.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const context = canvas.getContext('2d');
  context?.scale(scale, scale);
  return { context, width, height };
}

/**
 * @typedef {object} Curve
 * @property {string} css The class of the legend's word, whose colour the curve has.
 * @property {(number | null)[]} values One for each time; null where there is none.
 */

export class Chart {
  #canvas;
  /** @type {Curve[]} */
  #curves;
  /** @type {number[]} */
  #times = [];
  #least;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {string[]} css
   * @param {[number, number]} least The range that is always shown.
   */
  constructor(canvas, css, least) {
    this.#canvas = canvas;
    this.#curves = css.map((name) => ({ css: name, values: [] }));
    this.#least = least;
  }

  /**
   * @param {number} timestampUs
   * @param {(number | null)[]} values One for each curve.
   */
  add(timestampUs, values) {
    this.#times.push(timestampUs);
    this.#curves.forEach((curve, i) => curve.values.push(values[i]));
    while (this.#times[0] < timestampUs - SPAN_US) {
      this.#times.shift();
      for (const curve of this.#curves) curve.values.shift();
    }
    this.#draw();
  }

  /** Forgets everything. */
  clear() {
    this.#times = [];
    for (const curve of this.#curves) curve.values = [];
  }

  #range() {
    let [low, high] = this.#least;
    for (const value of this.#curves.flatMap((curve) => curve.values)) {
      if (value === null) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    return [low, high];
  }

  #draw() {
    const canvas = this.#canvas;
    const { context, width, height } = cleared(canvas);
    if (!context) return;
    const [low, high] = this.#range();
    const end = this.#times[this.#times.length - 1];
    const x = (/** @type {number} */ us) => width * (1 - (end - us) / SPAN_US);
    const y = (/** @type {number} */ v) => 6 + (height - 12) * (1 - (v - low) / (high - low));
    const style = getComputedStyle(canvas);
    context.font = '11px system-ui, sans-serif';
    for (const value of low < 0 ? [low, 0, high] : [low, high]) {
      context.fillStyle = style.color;
      const isTop = value === high;
      context.textBaseline = isTop ? 'top' : 'bottom';
      context.fillText(String(Math.round(10 * value) / 10), 4, y(value) + (isTop ? 1 : -1));
      context.strokeStyle = style.borderTopColor;
      context.lineWidth = 1;
      context.strokeRect(0, y(value), width, 0);
    }
    for (const { css, values } of this.#curves) {
      const word = canvas.parentElement?.querySelector(`.${css}`);
      context.strokeStyle = word ? getComputedStyle(word).color : style.color;
      context.lineWidth = 1.5;
      context.beginPath();
      let isDown = false;
      values.forEach((value, i) => {
        if (value !== null) context[isDown ? 'lineTo' : 'moveTo'](x(this.#times[i]), y(value));
        isDown = value !== null;
      });
      context.stroke();
    }
  }
}
