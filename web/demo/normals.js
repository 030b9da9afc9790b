// Normals of a surface, for the avatar and for the files of takes.

/**
 * Finds the normal of each vertex, of length 1: the mean of those of its triangles, by area. A
 * vertex of no triangle is not seen.
 * @param {Float32Array} places x, y, z of each vertex.
 * @param {Uint16Array} corners Three vertices of each triangle, counter-clockwise as seen from
 *   outside.
 * @param {Float32Array} normals Where they go, as many as places.
 */
export function findNormals(places, corners, normals) {
  normals.fill(0);
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [3 * corners[i], 3 * corners[i + 1], 3 * corners[i + 2]];
    const px = places[b] - places[a];
    const py = places[b + 1] - places[a + 1];
    const pz = places[b + 2] - places[a + 2];
    const qx = places[c] - places[a];
    const qy = places[c + 1] - places[a + 1];
    const qz = places[c + 2] - places[a + 2];
    const nx = py * qz - pz * qy;
    const ny = pz * qx - px * qz;
    const nz = px * qy - py * qx;
    for (const v of [a, b, c]) {
      normals[v] += nx;
      normals[v + 1] += ny;
      normals[v + 2] += nz;
    }
  }
  for (let v = 0; v < normals.length; v += 3) {
    const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]);
    if (length > 0) for (let i = v; i < v + 3; i++) normals[i] /= length;
    else normals[v + 2] = 1;
  }
}
