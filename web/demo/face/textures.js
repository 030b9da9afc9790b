// Textures of the dense mesh that this page draws: a painted mask, make-up, and the template that
// shows where the parts of the face lie.

import { isLoop } from './geometry.js';

/** @typedef {import('../../tracker.js').MeshTables} MeshTables */
/** @typedef {[number, number]} Point2 */

/** Side of a texture [px]. */
export const SIDE = 1024;

const IVORY = '#f3e9d6';
const SHADE = '#c9a583';
const ROSE = 'rgb(214 96 90 / 0.55)';
const NOSE = 'rgb(150 105 75 / 0.4)';
const TEAL = '#0e6068';
const GOLD = '#d9a431';
const RED = '#a81f31';
const EDGE = 'rgb(110 150 205)';
const CONTOUR = 'rgb(225 130 20)';

/** An empty texture. */
export function emptyTexture() {
  const canvas = document.createElement('canvas');
  canvas.width = SIDE;
  canvas.height = SIDE;
  return /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
}

/**
 * Where a vertex lies in a texture [px].
 * @param {MeshTables} tables
 * @param {number} vertex
 * @returns {Point2}
 */
function placeOf({ uvs }, vertex) {
  return [SIDE * uvs[2 * vertex], SIDE * (1 - uvs[2 * vertex + 1])];
}

/**
 * @param {MeshTables} tables
 * @param {keyof MeshTables['lines']} name
 */
function lineOf(tables, name) {
  return Array.from(tables.lines[name], (vertex) => placeOf(tables, vertex));
}

/**
 * A path through points.
 * @param {Point2[]} points
 * @param {boolean} [isClosed]
 */
function pathOf([first, ...rest], isClosed = true) {
  const path = new Path2D();
  path.moveTo(...first);
  for (const point of rest) path.lineTo(...point);
  if (isClosed) path.closePath();
  return path;
}

/** @param {MeshTables} tables */
function lipsOf(tables) {
  const path = pathOf(lineOf(tables, 'outer-lips'));
  path.addPath(pathOf(lineOf(tables, 'inner-lips')));
  return path;
}

/**
 * Fills a path with a soft edge. Filters would do it too, but not in every browser.
 * @param {CanvasRenderingContext2D} context
 * @param {Path2D} path
 * @param {string} color
 * @param {number} blur Twice the standard deviation of the edge [px].
 */
function fillSoftly(context, path, color, blur) {
  context.save();
  // Only the shadow falls on the canvas.
  context.translate(-2 * SIDE, 0);
  Object.assign(context, { shadowColor: color, shadowBlur: blur, shadowOffsetX: 2 * SIDE });
  context.fill(path, 'evenodd');
  context.restore();
}

/**
 * The area between the upper lid of an eye and its brow, as far as colour is put on.
 * @param {MeshTables} tables
 * @param {'left' | 'right'} side The person's.
 */
function lidOf(tables, side) {
  const eye = lineOf(tables, `${side}-eye`).sort((a, b) => a[0] - b[0]);
  const brow = lineOf(tables, `${side}-brow`).sort((a, b) => a[0] - b[0]);
  const [from, to] = [eye[0], eye[eye.length - 1]];
  const chord = (/** @type {number} */ x) =>
    from[1] + ((to[1] - from[1]) * (x - from[0])) / (to[0] - from[0]);
  const upper = eye.filter(([x, y]) => y <= chord(x) + 0.5);
  const towardsBrow = upper.map(([x, y], i) => {
    // The brow reaches farther to both sides.
    const at = brow[Math.round((i / (upper.length - 1)) * (brow.length - 1))];
    return /** @type {Point2} */ ([x + 0.3 * (at[0] - x), y + 0.5 * (at[1] - y)]);
  });
  return pathOf([...upper, ...towardsBrow.reverse()]);
}

/**
 * Colour on lips and lids.
 * @param {MeshTables} tables
 * @param {string} lips A colour of CSS.
 * @param {string} lids
 */
export function makeUp(tables, lips, lids) {
  const context = emptyTexture();
  fillSoftly(context, lipsOf(tables), lips, 12);
  for (const side of /** @type {const} */ (['left', 'right'])) {
    fillSoftly(context, lidOf(tables, side), lids, 24);
    const eye = pathOf(lineOf(tables, `${side}-eye`));
    context.strokeStyle = lids;
    context.lineWidth = 8;
    context.stroke(eye);
  }
  return context.canvas;
}

/**
 * @param {Point2[]} points
 * @returns {Point2}
 */
function middleOf(points) {
  const [low, high] = [Math.min, Math.max].map((f) => [0, 1].map((i) =>
    f(...points.map((point) => point[i]))));
  return [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
}

/**
 * A mask: ivory, with a domino about the eyes.
 * @param {MeshTables} tables
 */
export function paintedMask(tables) {
  const context = emptyTexture();
  const ground = context.createRadialGradient(
    SIDE / 2, 0.42 * SIDE, 0.1 * SIDE, SIDE / 2, 0.42 * SIDE, 0.5 * SIDE);
  ground.addColorStop(0, IVORY);
  ground.addColorStop(0.7, IVORY);
  ground.addColorStop(1, SHADE);
  context.fillStyle = ground;
  context.fillRect(0, 0, SIDE, SIDE);
  const eyes = /** @type {const} */ (['right', 'left']).map((side) =>
    middleOf(lineOf(tables, `${side}-eye`)));
  const apart = eyes[1][0] - eyes[0][0];

  const domino = new Path2D();
  eyes.forEach(([x, y], i) => {
    const cheek = new Path2D();
    cheek.arc(x, y + 0.75 * apart, 0.2 * apart, 0, 2 * Math.PI);
    fillSoftly(context, cheek, ROSE, 110);
    // Beside the nose and under it.
    const nose = new Path2D();
    const side = (/** @type {number} */ share) => SIDE / 2 + (i === 0 ? -1 : 1) * share * apart;
    nose.moveTo(side(0.09), y + 0.2 * apart);
    nose.lineTo(side(0.24), y + 0.62 * apart);
    nose.lineTo(SIDE / 2, y + 0.68 * apart);
    nose.lineTo(side(0.15), y + 0.6 * apart);
    nose.closePath();
    fillSoftly(context, nose, NOSE, 24);
    // Each half runs from the bridge of the nose around its eye into a tip.
    const out = i === 0 ? -1 : 1;
    const across = (/** @type {number} */ share) => x + out * share * apart;
    domino.moveTo(SIDE / 2, y - 0.02 * apart);
    domino.bezierCurveTo(across(-0.3), y - 0.3 * apart, across(0.2), y - 0.26 * apart,
      across(0.62), y - 0.32 * apart);
    domino.bezierCurveTo(across(0.45), y + 0.1 * apart, across(0.3), y + 0.3 * apart,
      across(-0.1), y + 0.24 * apart);
    domino.bezierCurveTo(across(-0.3), y + 0.2 * apart, across(-0.42), y + 0.1 * apart,
      SIDE / 2, y + 0.14 * apart);
    domino.closePath();
  });
  context.fillStyle = TEAL;
  context.fill(domino, 'nonzero');
  Object.assign(context, { lineJoin: 'round', lineCap: 'round', strokeStyle: GOLD });
  context.lineWidth = 10;
  context.stroke(domino);
  for (const side of /** @type {const} */ (['left', 'right'])) {
    context.lineWidth = 12;
    context.stroke(pathOf(lineOf(tables, `${side}-eye`)));
    context.lineWidth = 16;
    context.stroke(pathOf(lineOf(tables, `${side}-brow`), false));
  }
  fillSoftly(context, lipsOf(tables), RED, 4);
  context.fillStyle = GOLD;
  for (const [share, size] of [[1.02, 0.1], [0.78, 0.075], [0.59, 0.05]]) {
    const y = eyes[0][1] - share * apart * 0.6;
    const [half, x] = [size * apart, SIDE / 2];
    context.fill(pathOf([[x, y - half], [x + 0.6 * half, y], [x, y + half], [x - 0.6 * half, y]]));
  }
  return context.canvas;
}

/**
 * The triangles and contours in the texture, to paint on.
 * @param {MeshTables} tables
 */
export function template(tables) {
  const context = emptyTexture();
  const triangles = new Path2D();
  for (let i = 0; i < tables.triangles.length; i += 3) {
    const corners = Array.from(tables.triangles.subarray(i, i + 3), (v) => placeOf(tables, v));
    triangles.addPath(pathOf(corners));
  }
  context.lineJoin = 'round';
  context.strokeStyle = EDGE;
  context.stroke(triangles);
  context.strokeStyle = CONTOUR;
  context.lineWidth = 3;
  for (const name of /** @type {(keyof MeshTables['lines'])[]} */ (Object.keys(tables.lines))) {
    if (name === 'landmarks') continue;
    context.stroke(pathOf(lineOf(tables, name), isLoop(name)));
  }
  return context.canvas;
}

/**
 * A picture as a texture.
 * @param {File} file
 */
export async function textureFrom(file) {
  const size = /** @type {const} */ ({ resizeWidth: SIDE, resizeHeight: SIDE });
  const bitmap = await createImageBitmap(file, { ...size, resizeQuality: 'high' }).catch(() => {
    throw new Error(`The browser cannot read ${file.name} as a picture.`);
  });
  const context = emptyTexture();
  context.drawImage(bitmap, 0, 0, SIDE, SIDE);
  bitmap.close();
  return context.canvas;
}
