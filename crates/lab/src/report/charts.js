// Charts as SVG, drawn in the width that they have and drawn again when it changes.

const SPACE = { left: 46, right: 24, top: 12, bottom: 42 };
const DASHES = ['', '7 4', '2 3'];

/** Numbers of the systems that the legend has switched off. */
const hidden = new Set();

/** Functions that draw a chart again. */
const drawings = new Map();

/** An element with attributes, in the namespace of SVG. */
function svg(name, attributes = {}, text = undefined) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

/** An element of HTML with text. */
function html(name, text = '', attributes = {}) {
  const element = document.createElement(name);
  element.textContent = text;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

/** The colour of a system. */
const colour = (system) => `var(--s${system % 12})`;

/** Dashes of a system: few people tell seven colours apart. */
const dashOf = (system) => (system > 5 ? 1 : 0);

/** Round numbers from min to max, about `count`. */
function ticks(min, max, count) {
  const rough = (max - min) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= rough * 0.999);
  const first = Math.ceil(min / step - 1e-9);
  const last = Math.floor(max / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

/** A number with the digits that it needs. */
const short = (value) => String(Number(value.toPrecision(6)));

/** A value with its unit. */
const shown = (value, unit) => (value == null ? '–' : `${value.toFixed(2)} ${unit}`);

/** Keeps a chart as wide as its place. */
function keepDrawn(place, draw) {
  const redraw = () => {
    const width = place.clientWidth;
    if (width > 0) place.replaceChildren(...draw(width));
  };
  drawings.set(place, redraw);
  new ResizeObserver(redraw).observe(place);
}

const drawAll = () => drawings.forEach((draw) => draw());

/** Grid and labels of both axes. Each has min, max, unit and name. */
function axes(root, width, height, x, y, toX, toY) {
  const bottom = height - SPACE.bottom;
  for (const value of ticks(y.min, y.max, 5)) {
    const kind = value === 0 && y.min < 0 ? 'zero' : 'grid';
    const at = { y1: toY(value), y2: toY(value) };
    root.append(svg('line', { class: kind, x1: SPACE.left, x2: width - SPACE.right, ...at }));
    const place = { x: SPACE.left - 6, y: toY(value) + 4, 'text-anchor': 'end' };
    root.append(svg('text', place, short(value) + y.unit));
  }
  for (const value of x.ticks ?? ticks(x.min, x.max, width > 500 ? 8 : 5)) {
    root.append(svg('line', { class: 'grid', x1: toX(value), x2: toX(value), y1: SPACE.top,
      y2: bottom }));
    root.append(svg('text', { x: toX(value), y: bottom + 16, 'text-anchor': 'middle' },
      short(value) + x.unit));
  }
  const middle = (SPACE.left + width - SPACE.right) / 2;
  root.append(svg('text', { x: middle, y: height - 8, 'text-anchor': 'middle' }, x.name));
}

/** The path of points, with gaps where there is no value. */
function path(points, toX, toY) {
  let pen = 'M';
  return points.map(([x, y]) => {
    if (y == null) {
      pen = 'M';
      return '';
    }
    const text = `${pen}${toX(x).toFixed(1)} ${toY(y).toFixed(1)}`;
    pen = 'L';
    return text;
  }).join('');
}

/**
 * Lines over x. `options()` gives { x, y, series }: axes, and { name, system, points } with an
 * optional dash (0 to 2), dots, or colour. What is above or below the axis is cut off.
 */
function lines(place, title, options, cursor = () => null) {
  const id = `cut-${place.id}`;
  keepDrawn(place, (width) => {
    const { x, y, series } = options();
    const height = Math.round(Math.min(300, Math.max(200, width * 0.5)));
    const toX = (v) => SPACE.left
      + (v - x.min) / (x.max - x.min) * (width - SPACE.left - SPACE.right);
    const toY = (v) => SPACE.top
      + (y.max - v) / (y.max - y.min) * (height - SPACE.top - SPACE.bottom);
    const root = svg('svg', { width, height, role: 'img', 'aria-label': title });
    const cut = svg('clipPath', { id });
    cut.append(svg('rect', { x: SPACE.left, y: SPACE.top - 2,
      width: width - SPACE.left - SPACE.right, height: height - SPACE.top - SPACE.bottom + 4 }));
    root.append(cut);
    axes(root, width, height, x, y, toX, toY);
    const inside = svg('g', { 'clip-path': `url(#${id})` });
    for (const one of series) {
      const stroke = one.colour ?? colour(one.system);
      inside.append(svg('path', { class: 'series', d: path(one.points, toX, toY),
        style: `stroke:${stroke}`, 'stroke-dasharray': DASHES[one.dash ?? dashOf(one.system)] }));
      for (const [px, py] of one.dots ? one.points : []) {
        if (py != null) {
          inside.append(svg('circle', { cx: toX(px), cy: toY(py), r: 3.5,
            style: `fill:${stroke}` }));
        }
      }
    }
    const at = cursor();
    if (at !== null) {
      inside.append(svg('line', { class: 'zero', x1: toX(at), x2: toX(at), y1: 0, y2: height }));
    }
    root.append(inside);
    return [root, tip(root, { x, y, series, toX, width })];
  });
}

/** A box with the values at the pointer. */
function tip(root, { x, y, series, toX, width }) {
  const box = html('div', '', { class: 'tip', hidden: '' });
  root.addEventListener('pointermove', (event) => {
    const at = event.clientX - root.getBoundingClientRect().left;
    const all = series.flatMap((one) => one.points.map(([px]) => px));
    if (all.length === 0) return;
    const near = all.reduce((a, b) => (Math.abs(toX(b) - at) < Math.abs(toX(a) - at) ? b : a));
    box.replaceChildren(html('b', short(near) + x.unit));
    for (const one of series.filter(({ plain }) => !plain)) {
      const point = one.points.find(([px]) => px === near);
      if (!point) continue;
      const row = html('div', ` ${one.name} ${shown(point[1], y.unit)}`);
      row.prepend(html('span', '●', { style: `color:${one.colour ?? colour(one.system)}` }));
      box.append(row);
    }
    box.hidden = false;
    const isLeft = at > width / 2;
    box.style.left = isLeft ? '' : `${at + 14}px`;
    box.style.right = isLeft ? `${width - at + 14}px` : '';
  });
  root.addEventListener('pointerleave', () => {
    box.hidden = true;
  });
  return box;
}

/** A row per system on a logarithmic axis: a dot at the median, a line to the 95th percentile. */
function times(place, title, rows) {
  keepDrawn(place, (width) => {
    const seen = rows.filter(({ system }) => !hidden.has(system));
    const height = SPACE.top + SPACE.bottom + 26 * Math.max(1, seen.length);
    const low = Math.min(...seen.map(({ time }) => time.median), 1) / 1.5;
    const high = Math.max(...seen.map(({ time }) => time.p95), 1) * 1.5;
    const left = 20 + 7.2 * Math.min(16, Math.max(...seen.map(({ name }) => name.length), 4));
    const toX = (v) => left
      + Math.log(v / low) / Math.log(high / low) * (width - left - 70);
    const root = svg('svg', { width, height, role: 'img', 'aria-label': title });
    for (let power = -3; power < 6; power++) {
      const value = 10 ** power;
      if (value < low || value > high) continue;
      root.append(svg('line', { class: 'grid', x1: toX(value), x2: toX(value), y1: SPACE.top,
        y2: height - SPACE.bottom }));
      root.append(svg('text', { x: toX(value), y: height - SPACE.bottom + 16,
        'text-anchor': 'middle' }, `${short(value)} ms`));
    }
    seen.forEach(({ name, system, time }, i) => {
      const y = SPACE.top + 26 * i + 13;
      const style = `stroke:${colour(system)};fill:${colour(system)}`;
      root.append(svg('text', { x: left - 10, y: y + 4, 'text-anchor': 'end' },
        name.length > 16 ? `${name.slice(0, 15)}…` : name));
      root.append(svg('line', { x1: toX(time.median), x2: toX(time.p95), y1: y, y2: y, style,
        'stroke-width': 3 }));
      root.append(svg('circle', { cx: toX(time.median), cy: y, r: 5, style }));
      root.append(svg('text', { x: toX(time.p95) + 10, y: y + 4 }, shown(time.median, 'ms')));
    });
    return [root];
  });
}
