// Planar scenes: poses by position and angle, shapes, outlines.

/** @import { Cursor, Point } from "./types.d.ts" */
/** @import { BodyData, Ghost, Part, Shape } from "./scene_types.d.ts" */

import { cross, hull } from "./polygons.js";
import { Motion } from "./motion.js";
import { TAU, list, xy } from "./numbers.js";
import { degrees } from "./units.js";

/** Position, cosine, sine and angle of a body.
 * @typedef {{ x: number, y: number, c: number, s: number, a: number }} PlanarPose */

/** @type {PlanarPose} */
const ORIGIN = { x: 0, y: 0, c: 1, s: 0, a: 0 };

export class PlanarMotion extends Motion {
  /** @override @param {unknown} value @returns {[number, number]} */
  point(value) { return xy(value); }

  /** @override @param {BodyData} body @param {(values: unknown) => Float64Array} column @returns {Ghost} */
  readBody({ x, y, angle, shapes }, column) { return { x: column(x), y: column(y), a: column(angle), shapes: this.readShapes(shapes) }; }

  /** @override @param {Partial<Shape>[] | undefined} shapes @returns {Shape[]} */
  readShapes(shapes) {
    return list(shapes).filter(({ points }) => !points || points.length).map((shape) => {
      const points = list(shape.points).map(xy), size = (/** @type {unknown} */ value) => Math.abs(Number(value)) || 0;
      return /** @type {Shape} */ ({
        ...shape, kind: String(shape.kind), from: xy(shape.from), to: xy(shape.to), center: xy(shape.center), closed: Boolean(shape.closed),
        points: shape.kind === "polygon" ? untangled(points) : points, radius: size(shape.radius), width: size(shape.width), height: size(shape.height), angle: Number(shape.angle) || 0,
      });
    });
  }

  /** @override @param {Part | Ghost} body @returns {PlanarPose | null} */
  pose(body, cursor = this.cursor) {
    if (body.fixed) return ORIGIN;
    const [x, y, a] = [body.x, body.y, body.a].map((column) => this.sample(column, cursor));
    return Number.isNaN(x + y + a) || !this.n ? null : { x, y, a, c: Math.cos(a), s: Math.sin(a) };
  }

  /** @override @param {PlanarPose} pose @param {Point} point @returns {[number, number]} */
  placed({ x, y, c, s }, [u, v]) { return [x + c * u - s * v, y + s * u + c * v]; }

  /** @override @param {Part} body @param {number[]} direction @param {Cursor} cursor */
  turnedBack(body, [u, v], cursor) {
    const { c, s } = this.pose(body, cursor) ?? ORIGIN;
    return [c * u + s * v, c * v - s * u];
  }

  /** @override @param {Part} body @returns {[string, string]} */
  rotationRow(body) { return ["angle", degrees(this.pose(body)?.a ?? NaN)]; }

  /** @override @param {Shape} shape @returns {Point[]} */
  outline(shape) {
    const { center: [x, y], radius: r } = shape;
    switch (shape.kind) {
      case "bar": case "line": return [shape.from, shape.to];
      case "disc": return Array.from({ length: 12 }, (_, k) => [x + r * Math.cos((k * TAU) / 12), y + r * Math.sin((k * TAU) / 12)]);
      case "block": return corners(shape);
      case "particle": return [shape.center];
      default: return shape.points.filter((_, k) => k % Math.max(1, Math.floor(shape.points.length / 40)) === 0);
    }
  }
}

/** Corners of a block. @param {Shape} shape @returns {[number, number][]} */
export function corners({ center, width, height, angle }) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([u, v]) => [center[0] + c * u * width - s * v * height, center[1] + s * u * width + c * v * height]);
}

/** Point in the axes of a body. @param {PlanarPose} pose @param {Point} place @returns {[number, number]} */
export function local({ x, y, c, s }, place) {
  const [dx, dy] = [place[0] - x, place[1] - y];
  return [c * dx + s * dy, -s * dx + c * dy];
}

/** Points of a polygon; their hull if edges cross. @param {[number, number][]} points */
function untangled(points) {
  const n = points.length;
  for (let i = 0; n <= 60 && i < n; i++) {
    for (let j = i + 2; j < n - (i ? 0 : 1); j++) {
      const [a, b, c, d] = [points[i], points[i + 1], points[j], points[(j + 1) % n]];
      if (cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0) return hull(points);
    }
  }
  return points;
}
