// A surface that WebGL draws.

import { extentOf } from './geometry.js';

/** @typedef {import('./geometry.js').Corners} Corners */
/** @typedef {import('./surface.js').Look} Look */

// Pixels have their centres at whole numbers. The distance is w, so that textures lie right in
// perspective.
const VERTEX_SHADER = `#version 300 es
uniform vec2 size;
uniform vec2 range;
in vec4 vertex;
in vec2 place;
in vec3 corner;
in vec3 contour;
out vec2 at;
out vec3 inside;
out float seen;
flat out vec3 isContour;
void main() {
  vec2 xy = (2.0 * (vertex.xy + 0.5) / size - 1.0) * vec2(1.0, -1.0);
  float depth = 2.0 * (vertex.z - range.x) / (range.y - range.x) - 1.0;
  gl_Position = vec4(xy, 0.99 * depth, 1.0) * vertex.z;
  at = place;
  inside = corner;
  isContour = contour;
  seen = vertex.w;
}`;

// Of a surface's visibility, 0.5 is its outline. Back faces are culled, so that what is left may be
// solid up to there.
const SOLIDITY = `#version 300 es
precision highp float;
float solidity(float visibility) {
  return clamp(4.0 * visibility - 1.0, 0.0, 1.0);
}`;

const TEXTURE_SHADER = `${SOLIDITY}
uniform sampler2D picture;
in vec2 at;
in float seen;
out vec4 color;
void main() {
  color = texture(picture, at) * solidity(seen);
}`;

// The distance to each edge in pixels says how much of a pixel its line covers. Edges are thin, so
// that the face is seen between them.
const WIRE_SHADER = `${SOLIDITY}
uniform vec3 edgeColor;
uniform vec3 contourColor;
uniform float lineWidth;
in vec3 inside;
in float seen;
flat in vec3 isContour;
out vec4 color;
void main() {
  vec3 slope = vec3(
    length(vec2(dFdx(inside.x), dFdy(inside.x))),
    length(vec2(dFdx(inside.y), dFdy(inside.y))),
    length(vec2(dFdx(inside.z), dFdy(inside.z))));
  vec3 away = inside / slope;
  vec3 covered = clamp(0.5 * lineWidth * (1.0 + isContour) + 0.5 - away, 0.0, 1.0);
  vec3 of = covered * isContour;
  float contour = max(max(of.x, of.y), of.z);
  float edge = max(max(covered.x, covered.y), covered.z);
  color = vec4(mix(edgeColor, contourColor, contour), 1.0) * max(0.6 * edge, contour)
    * solidity(seen);
}`;

/**
 * Whether a processor does the work of graphics: Chromium counts that as no caveat.
 * @param {WebGL2RenderingContext} gl
 */
function isSoftware(gl) {
  const name = gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL;
  return /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(name ?? gl.RENDERER));
}

/** A canvas with the face as WebGL draws it. */
export class GpuSurface {
  #gl;
  #wire;
  #textured;
  #positions;
  #corners;
  /** @type {HTMLCanvasElement | undefined} What is in the texture now. */
  #uploaded;

  /**
   * A surface, if the browser has WebGL 2.
   * @param {Corners} corners
   * @param {boolean} [isSlowFine] Whether a WebGL without a graphics processor will do.
   */
  static create(corners, isSlowFine = false) {
    const canvas = document.createElement('canvas');
    const gl = canvas.getContext('webgl2', { failIfMajorPerformanceCaveat: !isSlowFine });
    return gl && (isSlowFine || !isSoftware(gl)) ? new GpuSurface(canvas, gl, corners) : undefined;
  }

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {WebGL2RenderingContext} gl
   * @param {Corners} corners
   */
  constructor(canvas, gl, corners) {
    this.canvas = canvas;
    this.#gl = gl;
    this.#corners = corners;
    this.#positions = new Float32Array(4 * corners.vertices.length);
    this.#wire = this.#program(WIRE_SHADER);
    this.#textured = this.#program(TEXTURE_SHADER);
    const inside = Float32Array.from({ length: 9 * (corners.vertices.length / 3) },
      (_, i) => Number(i % 9 % 4 === 0));
    this.#attribute(1, 2, corners.places);
    this.#attribute(2, 3, inside);
    this.#attribute(3, 3, Float32Array.from(corners.contours));
    this.#attribute(0, 4, this.#positions);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
  }

  /** Whether the browser took the context away. */
  get isLost() {
    return this.#gl.isContextLost();
  }

  /** Gives its memory back: browsers have few contexts. */
  free() {
    this.#gl.getExtension('WEBGL_lose_context')?.loseContext();
  }

  /** @param {string} fragmentShader */
  #program(fragmentShader) {
    const gl = this.#gl;
    const program = gl.createProgram();
    for (const [kind, source] of /** @type {const} */ ([
      [gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, fragmentShader],
    ])) {
      const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ['vertex', 'place', 'corner', 'contour'].forEach((name, i) =>
      gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
    }
    return program;
  }

  /**
   * @param {number} index
   * @param {number} size
   * @param {Float32Array} values
   */
  #attribute(index, size, values) {
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, gl.FLOAT, false, 0, 0);
  }

  /** @param {HTMLCanvasElement} texture */
  #upload(texture) {
    const gl = this.#gl;
    if (texture === this.#uploaded) return;
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, texture);
    gl.generateMipmap(gl.TEXTURE_2D);
    this.#uploaded = texture;
  }

  /**
   * Draws a mesh in a picture. Returns the part of the canvas that is new.
   * @param {Float32Array} mesh x, y, z and visibility of each vertex.
   * @param {number} width Width of the picture [px].
   * @param {number} height
   * @param {number} scale Pixels of the canvas for one of the picture.
   * @param {Look} look
   */
  draw(mesh, width, height, scale, look) {
    const gl = this.#gl;
    const { canvas } = this;
    if (canvas.width !== scale * width) canvas.width = scale * width;
    if (canvas.height !== scale * height) canvas.height = scale * height;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.#corners.vertices.forEach((vertex, corner) => {
      for (let i = 0; i < 4; i++) this.#positions[4 * corner + i] = mesh[4 * vertex + i];
    });
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.#positions);
    const extent = extentOf(mesh, scale, canvas);
    const program = look.texture ? this.#textured : this.#wire;
    const uniform = (/** @type {string} */ name) => gl.getUniformLocation(program, name);
    gl.useProgram(program);
    gl.uniform2f(uniform('size'), width, height);
    gl.uniform2f(uniform('range'), extent.near, extent.far);
    if (look.texture) {
      this.#upload(look.texture);
    } else {
      gl.uniform3fv(uniform('edgeColor'), look.edge.map((v) => v / 255));
      gl.uniform3fv(uniform('contourColor'), look.contour.map((v) => v / 255));
      gl.uniform1f(uniform('lineWidth'), look.width);
    }
    gl.drawArrays(gl.TRIANGLES, 0, this.#corners.vertices.length);
    return extent;
  }
}
