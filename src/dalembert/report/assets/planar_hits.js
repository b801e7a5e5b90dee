// Parts of a planar scene under the pointer.

/** @import { Hit, Pixel, Shape } from "./scene_types.d.ts" */
/** @import { PlanarPainter } from "./planar_painter.js" */

import { corners, local } from "./planar_motion.js";
import { distanceToSegment, inside } from "./polygons.js";

/** Order in which shapes are found. */
const ORDER = ["bar", "line", "particle", "block", "polygon", "curve", "disc"];

/** Part of a scene at a pixel. @param {PlanarPainter} painter @param {Pixel} pixel @returns {Hit | null} */
export function planarHit(painter, pixel) {
  const { half, motion, view } = painter, near = (/** @type {Pixel | null} */ p, /** @type {number} */ r) => p !== null && Math.hypot(p[0] - pixel[0], p[1] - pixel[1]) <= r;
  for (const item of motion.joints) if (near(painter.placeOf(item), Math.max(8, half))) return { kind: "joint", item };
  for (const item of motion.spots) if (near(painter.place(item), 8)) return { kind: "point", item };
  const reach = (half + 2) / view.s, at = (/** @type {any} */ body) => { const pose = painter.poses.get(body); return pose && local(pose, view.world(pixel)); };
  for (const body of motion.bodies) {  // smaller than what ends at it
    const p = at(body);
    if (p && body.shapes.some((shape) => shape.kind === "particle" && inShape(shape, p, reach))) return { kind: "body", item: body };
  }
  for (const item of motion.links) {
    const p = painter.place(item.i), q = painter.place(item.j);
    if (p && q && distanceToSegment(pixel, p, q) < half * (1.3 + 3.4 * Math.abs(item.offset)) + 3) return { kind: "link", item };
  }
  for (const item of motion.symbols) if (!item.at && item.node === null && !item.nodes.length && near(painter.place(item), 3 * half)) return { kind: "symbol", item };
  /** @type {Hit | null} */
  let hit = null;
  let rank = Infinity;
  for (const body of motion.bodies) {
    const p = at(body);
    if (!p) continue;
    if (!body.shapes.length && Math.hypot(...p) < reach) hit = { kind: "body", item: body };
    for (const shape of body.shapes) {
      const order = ORDER.indexOf(shape.kind) + (shape.radius ? 1 - 1 / (1 + shape.radius) : 0);
      if (order < rank && inShape(shape, p, reach)) [hit, rank] = [{ kind: "body", item: body }, order];
    }
  }
  return hit;
}

/** Whether a point in the axes of a body lies on a shape. @param {Shape} shape @param {Pixel} p @param {number} reach */
export function inShape(shape, p, reach) {
  const [from, to, center] = /** @type {Pixel[]} */ ([shape.from, shape.to, shape.center]), points = /** @type {Pixel[]} */ (shape.points);
  const onEdge = (/** @type {boolean} */ closed) => points.some((q, k) => (k || closed) && distanceToSegment(p, points[(k || points.length) - 1], q) < reach);
  switch (shape.kind) {
    case "bar": case "line": return distanceToSegment(p, from, to) < reach;
    case "disc": return Math.hypot(p[0] - center[0], p[1] - center[1]) < shape.radius + reach / 3;
    case "particle": return Math.hypot(p[0] - center[0], p[1] - center[1]) < reach;
    case "block": return inside(p, corners(shape));
    case "curve": return onEdge(shape.closed) || (shape.closed && inside(p, points));
    default: return onEdge(true) || inside(p, points);
  }
}
