// Spatial drawings without WebGL, and on paper: pieces painted from the farthest to the nearest.

/** @import { Paper } from "./scene_types.d.ts" */

import "./vendor/three.js";
import { fitCanvas, stroke } from "./canvas.js";
import { mix } from "./theme.js";

/** Vertex in the axes of the camera, and its pixel.
 * @typedef {{ x: number, y: number, z: number, u: number, v: number }} SeenVertex */
/** Face, or line of a width, at a depth.
 * @typedef {{ ends: SeenVertex[], depth: number, colour: string, alpha: number, width?: number, cap?: CanvasLineCap }} Piece */

export class FlatPainter {
  /** @param {HTMLCanvasElement | null} canvas */
  constructor(canvas = null) {
    this.canvas = canvas;
    /** @type {number | undefined} */
    this.ratio = undefined;
    this.w = 0;
    this.h = 0;
    /** @type {Piece[]} */
    this.pieces = [];
  }

  /** @param {number} ratio */
  setPixelRatio(ratio) { this.ratio = ratio; }
  setSize() {}

  /** @param {THREE.Scene} world @param {THREE.Camera} camera */
  render(world, camera) {
    if (this.canvas) this.paint(world, camera, fitCanvas(this.canvas, this.ratio));
  }

  /** @param {THREE.Scene} world @param {THREE.Camera} camera @param {Paper} paper */
  paint(world, camera, { ctx, w, h }) {
    [this.w, this.h, this.pieces] = [w, h, []];
    ctx.fillStyle = `#${world.background.getHexString()}`;
    ctx.fillRect(0, 0, w, h);
    world.updateMatrixWorld();
    world.traverseVisible((/** @type {THREE.Object3D} */ item) => {
      if (item.isLineSegments2) this.addLines(item, item.geometry.attributes.instanceStart.data.array, item.geometry.attributes.instanceColorStart?.data.array, camera);
      else if (item.isLineSegments) this.addLines(item, item.geometry.attributes.position.array, null, camera);
      else if (item.isMesh && !item.material.isShadowMaterial && item.material.side !== THREE.BackSide) this.addFaces(item, camera);
    });
    ctx.lineJoin = "round";
    for (const { ends, colour, alpha, width, cap } of this.pieces.sort((a, b) => b.depth - a.depth)) {
      if (ends.some(({ u }) => Number.isNaN(u))) continue;
      ctx.globalAlpha = alpha;
      ctx.lineCap = cap ?? "round";
      ctx.beginPath();
      ends.forEach(({ u, v }, k) => (k ? ctx.lineTo(u, v) : ctx.moveTo(u, v)));
      if (width) { stroke(ctx, colour, width); continue; }
      ctx.closePath();
      ctx.fillStyle = colour;
      ctx.fill();
      if (alpha === 1) stroke(ctx, colour, 0.7);
    }
    ctx.globalAlpha = 1;
  }

  /** @param {THREE.Object3D} item @param {ArrayLike<number>} array of positions @param {THREE.Camera} camera @returns {SeenVertex[]} */
  seen(item, array, camera) {
    const view = new THREE.Matrix4().multiplyMatrices(camera.matrixWorldInverse, item.matrixWorld);
    const { elements: e } = camera.projectionMatrix, p = new THREE.Vector3(), out = [];
    for (let k = 0; k + 2 < array.length; k += 3) {
      p.set(array[k], array[k + 1], array[k + 2]).applyMatrix4(view);
      const near = p.z > -camera.near;
      out.push({ x: p.x, y: p.y, z: p.z, u: near ? NaN : ((1 - (e[0] * p.x) / p.z) * this.w) / 2, v: near ? NaN : ((1 + (e[5] * p.y) / p.z) * this.h) / 2 });
    }
    return out;
  }

  /** @param {THREE.Object3D} item @param {ArrayLike<number>} array @param {ArrayLike<number> | null | undefined} colours @param {THREE.Camera} camera */
  addLines(item, array, colours, camera) {
    const { material } = item, ends = this.seen(item, array, camera), behind = material.fog, width = material.linewidth > 1 ? material.linewidth : behind ? 0.6 : 1;
    // Lines lie on faces; wider ones lie behind narrower ones.
    const bias = (0.006 - 0.0002 * width) * camera.position.length();
    for (let k = 0; k + 1 < ends.length; k += 2) {
      const pair = [ends[k], ends[k + 1]], depth = behind ? Infinity : -(pair[0].z + pair[1].z) / 2 - bias;
      this.pieces.push({ ends: pair, depth, colour: colours ? hex(colours, 3 * k) : `#${material.color.getHexString()}`, alpha: material.opacity, width, cap: colours ? "round" : "butt" });
    }
  }

  /** @param {THREE.Object3D} item @param {THREE.Camera} camera */
  addFaces(item, camera) {
    const { geometry, material } = item, places = this.seen(item, geometry.attributes.position.array, camera), index = geometry.index?.array;
    const count = index ? index.length : places.length, section = material.clippingPlanes?.[0], spot = new THREE.Vector3();
    const base = `#${material.color.getHexString()}`, front = material.depthTest ? 0 : Infinity, colours = material.vertexColors ? geometry.attributes.color.array : null;
    for (let k = 0; k + 2 < count; k += 3) {
      const [i, j, m] = [0, 1, 2].map((n) => (index ? index[k + n] : k + n)), ends = [places[i], places[j], places[m]], [a, b, c] = ends;
      const [ux, uy, uz, vx, vy, vz] = [b.x - a.x, b.y - a.y, b.z - a.z, c.x - a.x, c.y - a.y, c.z - a.z];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], size = Math.hypot(nx, ny, nz);
      if (!size || (material.side !== THREE.DoubleSide && nx * a.x + ny * a.y + nz * a.z >= 0)) continue;
      if (section && section.distanceToPoint(spot.set((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3).applyMatrix4(camera.matrixWorld)) < 0) continue;
      const lit = (0.3 * nx + 0.75 * ny + 0.6 * nz) / size, shaded = lit > 0 ? mix(base, "#ffffff", 0.25 * lit) : mix(base, "#000000", -0.45 * lit);
      this.pieces.push({ ends, depth: -(a.z + b.z + c.z) / 3 - front, colour: colours ? hex(colours, 3 * i) : shaded, alpha: material.opacity });
    }
  }
}

/** Colour of a vertex. @param {ArrayLike<number>} colours @param {number} k */
const hex = (colours, k) => `#${new THREE.Color(colours[k], colours[k + 1], colours[k + 2]).getHexString()}`;
