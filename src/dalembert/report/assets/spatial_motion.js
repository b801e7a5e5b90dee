// Spatial scenes: poses by position and Euler parameters, the scalar first.

/** @import { Cursor, Point } from "./types.d.ts" */
/** @import { Axis, BodyData, Ghost, Part, Shape } from "./scene_types.d.ts" */

import "./vendor/three.js";
import { Motion } from "./motion.js";
import { isNum, list } from "./numbers.js";
import { inUnits } from "./units.js";

/** @type {Record<Axis, [number, number, number]>} */
export const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

/** @param {unknown} p @returns {[number, number, number]} */
export const xyz = (p) => (Array.isArray(p) && p.length === 3 && p.every(isNum) ? [p[0], p[1], p[2]] : [0, 0, 0]);

/** @param {number[]} p @returns {THREE.Vector3} */
export const vector = (p) => new THREE.Vector3(...p);

/** Rotation of Euler parameters. @param {number[]} parameters @returns {THREE.Quaternion} */
export const quaternion = ([e0, e1, e2, e3]) => new THREE.Quaternion(e1, e2, e3, e0).normalize();

/** Position and rotation of a body.
 * @typedef {{ p: THREE.Vector3, q: THREE.Quaternion }} SpatialPose */

export class SpatialMotion extends Motion {
  /** @override @returns {2 | 3} */
  get dimension() { return 3; }

  /** @override @param {unknown} value @returns {[number, number, number]} */
  point(value) { return xyz(value); }

  /** @override @param {BodyData} body @param {(values: unknown) => Float64Array} column @returns {Ghost} */
  readBody(body, column) {
    return { position: ["x", "y", "z"].map((key) => column(body[key])), rotation: ["e0", "e1", "e2", "e3"].map((key) => column(body[key])), shapes: this.readShapes(body.shapes) };
  }

  /** Between two instants the origin moves straight and the body rotates about one axis. @override @param {Part | Ghost} body @returns {SpatialPose | null} */
  pose(body, cursor = this.cursor) {
    if (body.fixed) return { p: vector([0, 0, 0]), q: quaternion([1, 0, 0, 0]) };
    if (!this.n) return null;
    const position = this.vectorOf(body.position, cursor) ?? [], { i, f } = cursor;
    if (this.swing) return { p: vector(position), q: quaternion(this.vectorOf(body.rotation, cursor) ?? []) };
    const parameters = (/** @type {number} */ k) => body.rotation.map((/** @type {Float64Array} */ column) => column[k]);
    const finite = (/** @type {number[]} */ values) => values.every(Number.isFinite);
    const near = f < 0.5 || i + 1 >= this.n ? i : i + 1;
    if (!finite([...position, ...parameters(near)])) return null;
    const q = quaternion(parameters(finite(parameters(i)) ? i : near));
    if (f > 0 && i + 1 < this.n && finite(parameters(i + 1))) q.slerp(quaternion(parameters(i + 1)), f);
    return { p: vector(position), q };
  }

  /** @override @param {SpatialPose} pose @param {Point} point @returns {[number, number, number]} */
  placed({ p, q }, point) { return vector(point).applyQuaternion(q).add(p).toArray(); }

  /** @override @param {Part} body @param {number[]} direction @param {Cursor} cursor */
  turnedBack(body, direction, cursor) {
    const pose = this.pose(body, cursor);
    return pose ? vector(direction).applyQuaternion(pose.q.clone().invert()).toArray() : direction;
  }

  /** @override @param {Part} body @returns {[string, string]} */
  rotationRow(body) {
    const { q } = this.pose(body) ?? { q: quaternion([NaN, NaN, NaN, NaN]) };
    return ["Euler parameters", inUnits([q.w, q.x, q.y, q.z], "")];
  }

  /** @override @param {Shape} shape @returns {Point[]} */
  outline(shape) {
    const about = (/** @type {Point} */ center, /** @type {number} */ r) =>
      Object.values(AXES).flatMap((axis) => [r, -r].map((s) => xyz(center.map((c, k) => c + s * axis[k]))));
    switch (shape.kind) {
      case "bar": case "line": case "cylinder": case "capsule":
        return [shape.from, shape.to].flatMap((end) => (shape.radius ? about(end, shape.radius) : [xyz(end)]));
      case "sphere": case "disc": return about(xyz(shape.center), shape.radius || 0);
      case "ellipsoid": case "box": {
        const pose = { p: vector(xyz(shape.center)), q: quaternion(shape.turn ?? [1, 0, 0, 0]) }, half = shape.kind === "box" ? 0.5 : 0.35;
        const signs = [-half, half].flatMap((a) => [-half, half].flatMap((b) => [-half, half].map((c) => [a, b, c])));
        return signs.map((corner) => this.placed(pose, xyz(corner.map((v, k) => v * shape.size[k]))));
      }
      case "plate": case "curve": return list(shape.points).map(xyz);
      case "mesh": {
        const count = shape.vertices.length / 3, stride = Math.max(1, Math.floor(count / 200));
        return Array.from({ length: Math.ceil(count / stride) }, (_, k) => xyz(Array.from(shape.vertices.slice(3 * k * stride, 3 * k * stride + 3))));
      }
      default: return [xyz(shape.center)];
    }
  }
}
