// Draws a result over its picture: points, mesh, axes, box, in the colours of `track --overlay`.

/** @typedef {import('../layout.js').Result} Result */
/** @typedef {import('../layout.js').Landmark} Landmark */
/** @typedef {import('../layout.js').Intrinsics} Intrinsics */
/** @typedef {[number, number]} Point2 */

const MESH = 'rgb(120 160 200)';
const BOX = 'rgb(240 220 60)';
const BOX_COASTING = 'rgb(240 140 40)';
const AXES = ['rgb(255 60 60)', 'rgb(60 220 60)', 'rgb(80 120 255)'];
/** Length of the axes [mm]. */
const AXIS_MM = 60;
/** Triangles below this area, as a part of the square of their longest side, are not drawn. */
const SLIVER = 0.12;

/** @type {[number, number, number][]} */
let triangles = [];

/**
 * The columns of a rotation: the head's axes in the camera frame.
 * @param {readonly number[]} quaternion x, y, z, w
 */
export function axesOf([x, y, z, w]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
}

/**
 * Twice the signed area of a triangle, > 0 when its corners go clockwise on screen.
 * @param {Point2} a
 * @param {Point2} b
 * @param {Point2} c
 */
function twiceArea(a, b, c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/**
 * Whether none of the points lies in the circle through a, b, c, which go clockwise on screen.
 * @param {Point2} a
 * @param {Point2} b
 * @param {Point2} c
 * @param {Point2[]} points
 */
function isEmptyCircle([ax, ay], [bx, by], [cx, cy], points) {
  for (const [x, y] of points) {
    const [aX, aY, bX, bY, cX, cY] = [ax - x, ay - y, bx - x, by - y, cx - x, cy - y];
    const inside = (aX * aX + aY * aY) * (bX * cY - cX * bY)
      - (bX * bX + bY * bY) * (aX * cY - cX * aY)
      + (cX * cX + cY * cY) * (aX * bY - bX * aY);
    if (inside > 0) return false;
  }
  return true;
}

/**
 * Triangles between the points as seen from in front of the head: those whose circle holds no
 * other point (Delaunay). 68 points once: 50,000 triangles to look at.
 * @param {Result} result
 * @param {Landmark[]} landmarks
 */
function triangulate(result, landmarks) {
  const axes = axesOf(result.rotation);
  const points = landmarks.map((l) => {
    const p = [l.xMm, l.yMm, l.zMm].map((v, i) => v - result.translationMm[i]);
    const along = (/** @type {number[]} */ axis) => p.reduce((sum, v, j) => sum + v * axis[j], 0);
    return /** @type {Point2} */ ([along(axes[0]), along(axes[1])]);
  });
  /** @type {[number, number, number][]} */
  const found = [];
  for (let i = 0; i < points.length; i++) {
    for (let j = i + 1; j < points.length; j++) {
      for (let k = j + 1; k < points.length; k++) {
        const area = twiceArea(points[i], points[j], points[k]);
        const [a, b, c] = area > 0 ? [i, j, k] : [i, k, j];
        const corners = /** @type {const} */ ([points[a], points[b], points[c]]);
        // Hardly any circle is empty, so nothing else is computed before.
        if (!isEmptyCircle(...corners, points)) continue;
        const sides = corners.map((p, n) => {
          const q = corners[(n + 1) % 3];
          return Math.hypot(p[0] - q[0], p[1] - q[1]);
        });
        const isSliver = Math.abs(area) < SLIVER * Math.max(...sides) ** 2 && k < 27;
        if (!isSliver) found.push([a, b, c]);
      }
    }
  }
  return found;
}

/**
 * Red for no confidence through yellow to green.
 * @param {number} confidence
 */
function colorOf(confidence) {
  const ramp = (/** @type {number} */ v) => 255 * Math.min(1, Math.max(0, v));
  return `rgb(${ramp(2 - 2 * confidence)} ${ramp(2 * confidence)} 0)`;
}

/**
 * The camera of a frame.
 * @param {{ width: number, height: number, camera?: Intrinsics }} frame Without a camera it is one
 *   with a horizontal field of view of 60 degrees, as the tracker assumes.
 * @returns {Pick<Intrinsics, 'fx' | 'fy' | 'cx' | 'cy'>}
 */
export function cameraOf({ width, height, camera }) {
  const focal = width / 2 / Math.tan(Math.PI / 6);
  return camera ?? { fx: focal, fy: focal, cx: (width - 1) / 2, cy: (height - 1) / 2 };
}

/**
 * Draws what is wanted of a result.
 * @param {CanvasRenderingContext2D} context In pixels of the frame.
 * @param {Parameters<typeof cameraOf>[0]} frame
 * @param {Result} result
 * @param {Landmark[]} landmarks
 * @param {Set<string>} wanted points, mesh, axes, box
 */
export function draw(context, frame, result, landmarks, wanted) {
  if (result.state === 'searching') return;
  const { fx, fy, cx, cy } = cameraOf(frame);
  const project = (/** @type {number[]} */ [x, y, z]) =>
    /** @type {Point2} */ ([(fx * x) / z + cx, (fy * y) / z + cy]);
  const size = Math.max(result.faceBox[2], result.faceBox[3]);
  context.lineWidth = Math.max(1, size / 180);
  if (wanted.has('mesh')) {
    if (triangles.length === 0) triangles = triangulate(result, landmarks);
    drawMesh(context, landmarks, landmarks.map((l) => project([l.xMm, l.yMm, l.zMm])));
  }
  if (wanted.has('box')) {
    context.strokeStyle = result.state === 'coasting' ? BOX_COASTING : BOX;
    context.strokeRect(...result.faceBox);
  }
  if (wanted.has('points')) drawPoints(context, landmarks, size);
  if (wanted.has('axes')) {
    context.lineWidth *= 2;
    axesOf(result.rotation).forEach((axis, i) => {
      const sign = i === 2 ? -1 : 1;
      const tip = result.translationMm.map((v, j) => v + sign * AXIS_MM * axis[j]);
      drawLine(context, project(result.translationMm), project(tip), AXES[i]);
    });
  }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Point2} from
 * @param {Point2} to
 * @param {string} color
 */
function drawLine(context, from, to, color) {
  context.strokeStyle = color;
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

/**
 * Triangles that face away would clutter the far side.
 * @param {CanvasRenderingContext2D} context
 * @param {Landmark[]} landmarks
 * @param {Point2[]} solid The points of the 3D face in the picture.
 */
function drawMesh(context, landmarks, solid) {
  context.strokeStyle = MESH;
  context.beginPath();
  for (const corners of triangles) {
    const [a, b, c] = corners.map((i) => solid[i]);
    if (twiceArea(a, b, c) <= 0) continue;
    const [from, ...rest] = corners.map((i) => landmarks[i]);
    context.moveTo(from.x, from.y);
    for (const { x, y } of rest) context.lineTo(x, y);
    context.closePath();
  }
  context.stroke();
}

/**
 * Coloured by confidence; hidden landmarks smaller.
 * @param {CanvasRenderingContext2D} context
 * @param {Landmark[]} landmarks
 * @param {number} size Longer side of the face's box [px].
 */
function drawPoints(context, landmarks, size) {
  const radius = Math.min(6, Math.max(1, size / 110));
  for (const { x, y, confidence, visibility } of landmarks) {
    context.fillStyle = colorOf(confidence);
    context.beginPath();
    context.arc(x, y, visibility < 0.5 ? radius / 2 : radius, 0, 2 * Math.PI);
    context.fill();
  }
}
