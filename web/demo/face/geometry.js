// The triangles of the dense mesh as the surfaces draw them: each with three corners of its own.

/** @typedef {import('../../tracker.js').MeshTables} MeshTables */

/** Lines that a wire shows by themselves: the contours of lips, eyes and brows. */
const CONTOURS = /** @type {const} */ ([
  'outer-lips', 'inner-lips', 'left-eye', 'right-eye', 'left-brow', 'right-brow',
]);

/**
 * @typedef {object} Corners
 * @property {Uint16Array} vertices The vertex of each corner, three for each triangle,
 *   counter-clockwise as seen from outside of the face.
 * @property {Float32Array} places u and v of each corner.
 * @property {Uint8Array} contours For each corner, of its triangle's three edges which ones are
 *   parts of contours: 1 or 0. Edge k is opposite of corner k.
 */

/**
 * Whether the line of a name ends where it begins.
 * @param {string} name
 */
export function isLoop(name) {
  return !name.endsWith('brow') && name !== 'landmarks';
}

/**
 * The pairs of neighbours on the contours, both ways.
 * @param {MeshTables} tables
 */
function contourEdges({ lines }) {
  const edges = new Set();
  for (const name of CONTOURS) {
    const line = lines[name];
    line.forEach((vertex, i) => {
      if (i + 1 === line.length && !isLoop(name)) return;
      const next = line[(i + 1) % line.length];
      edges.add(`${vertex},${next}`).add(`${next},${vertex}`);
    });
  }
  return edges;
}

/**
 * @param {MeshTables} tables
 * @returns {Corners}
 */
export function cornersOf(tables) {
  const { triangles, uvs } = tables;
  const edges = contourEdges(tables);
  const places = new Float32Array(2 * triangles.length);
  const contours = new Uint8Array(3 * triangles.length);
  triangles.forEach((vertex, corner) => {
    places.set(uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * corner);
    const first = corner - (corner % 3);
    for (let k = 0; k < 3; k++) {
      const [a, b] = [(k + 1) % 3, (k + 2) % 3].map((n) => triangles[first + n]);
      contours[3 * corner + k] = Number(edges.has(`${a},${b}`));
    }
  });
  return { vertices: triangles, places, contours };
}

/**
 * The part of a canvas that a mesh may change [px], and its least and greatest distance.
 * @param {Float32Array} mesh x, y, z and visibility of each vertex.
 * @param {number} scale Pixels of the canvas for one of the picture.
 * @param {{ width: number, height: number }} canvas
 */
export function extentOf(mesh, scale, { width, height }) {
  const least = [Infinity, Infinity, Infinity];
  const most = [-Infinity, -Infinity, -Infinity];
  mesh.forEach((value, i) => {
    if (i % 4 === 3) return;
    least[i % 4] = Math.min(least[i % 4], value);
    most[i % 4] = Math.max(most[i % 4], value);
  });
  const within = (/** @type {number} */ v, /** @type {number} */ end) =>
    Math.min(end, Math.max(0, v));
  const [left, right] = [
    within(Math.floor(scale * least[0]), width), within(Math.ceil(scale * (most[0] + 1)), width),
  ];
  const [top, bottom] = [
    within(Math.floor(scale * least[1]), height), within(Math.ceil(scale * (most[1] + 1)), height),
  ];
  return { left, right, top, bottom, near: least[2], far: most[2] };
}
