// Tools of the palette of spatial models.

/** @import { Change } from "./operations.js" */
/** @import { Poses } from "./space_poses.js" */
/** @import { SpacePlace } from "./space_places.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Vec } from "./space_math.js" */

import { across, dot, minus, plus, size, times } from "./space_math.js";
import { bar, box, connection, cylinder, force, joint, motor, plainBody, planeFrame, sphere, torque } from "./space_shapes.js";

/** What a tool needs besides its places: poses, the normal of the working plane, the axis and the kind of joints.
 * @typedef {{ poses: Poses, document: Document, normal: Vec, axis: Vec, kind: string }} Setting */
/** A tool: what its clicks are, the change that they make, and lines that show it before. The click number `lift` is along the normal of the plane.
 * @typedef {{ name: string, key: string, title: string, hint: string[], clicks: number, onBody?: boolean, lift?: number, make: (places: SpacePlace[], setting: Setting) => Change | null, sketch?: (places: SpacePlace[], setting: Setting) => Vec[][] }} SpaceTool */

/** @param {Vec} center @param {number} radius @param {Vec} normal */
function circle(center, radius, normal) {
  const [u, v] = across(normal);
  return Array.from({ length: 49 }, (_, k) => plus(center, plus(times(u, radius * Math.cos((k * Math.PI) / 24)), times(v, radius * Math.sin((k * Math.PI) / 24)))));
}

/** Edges of a box over two corners, up to a height. @param {SpacePlace[]} places @param {Setting} setting */
function edges([from, to, top], { normal }) {
  const [u, v] = planeFrame(normal), way = minus(to.p, from.p), [a, b] = [times(u, dot(way, u)), times(v, dot(way, v))], c = times(normal, top ? dot(minus(top.p, from.p), normal) : 0);
  const ring = (/** @type {Vec} */ p) => [p, plus(p, a), plus(plus(p, a), b), plus(p, b), p], low = ring(from.p), high = ring(plus(from.p, c));
  return top ? [low, high, ...low.slice(1).map((p, k) => [p, high[k + 1]])] : [low];
}

/** @param {SpacePlace[]} places @param {Setting} setting */
function drum([center, rim, top], { normal }) {
  const radius = size(minus(rim.p, center.p)), c = times(normal, top ? dot(minus(top.p, center.p), normal) : 0), low = circle(center.p, radius, normal), high = circle(plus(center.p, c), radius, normal);
  return top ? [low, high, ...[0, 12, 24, 36].map((k) => [low[k], high[k]])] : [low, [center.p, rim.p]];
}

/** @type {SpaceTool[]} */
export const SPACE_TOOLS = [
  { name: "select", key: "v", title: "Select", hint: ["click an element; its arrows move it, its rings rotate it, Delete removes it"], clicks: -1, make: () => null },
  { name: "box", key: "b", title: "Box", hint: ["click a corner", "click the opposite corner", "click the height"], clicks: 3, lift: 2, make: (places, { normal }) => box(places, normal), sketch: edges },
  { name: "cylinder", key: "c", title: "Cylinder", hint: ["click the centre", "click the radius", "click the height"], clicks: 3, lift: 2, make: (places, { normal }) => cylinder(places, normal), sketch: drum },
  { name: "sphere", key: "s", title: "Sphere", hint: ["click the centre", "click the radius"], clicks: 2, make: sphere, sketch: ([center, rim], { normal }) => planeFrame(normal).map((axis) => circle(center.p, size(minus(rim.p, center.p)), axis)) },
  { name: "bar", key: "r", title: "Bar", hint: ["click the start of the bar", "click its end; Shift moves along the normal of the plane"], clicks: 2, make: bar },
  { name: "body", key: "n", title: "Body", hint: ["click the mass centre of a body without a shape"], clicks: 1, make: plainBody },
  { name: "joint", key: "j", title: "Joint", hint: ["click the place of the joint on the first body", "click the second body, or the ground"], clicks: 2, onBody: true, make: (places, { poses, kind, axis }) => joint(places, poses, kind, axis) },
  { name: "link", key: "l", title: "Link", hint: ["click one end of the link", "click the other end"], clicks: 2, onBody: true, make: (places, { poses }) => connection(places, poses, "RigidLink") },
  { name: "spring", key: "k", title: "Spring", hint: ["click one end of the spring", "click the other end"], clicks: 2, onBody: true, make: (places, { poses }) => connection(places, poses, "Spring") },
  { name: "force", key: "f", title: "Force", hint: ["click the point on which the force acts", "click its direction"], clicks: 2, onBody: true, make: (places, { poses }) => force(places, poses) },
  { name: "torque", key: "t", title: "Torque", hint: ["click a body; the axis is that of the palette"], clicks: 1, onBody: true, make: (places, { axis }) => torque(places, axis) },
  { name: "motor", key: "m", title: "Motor", hint: ["click a joint"], clicks: 1, make: (places, { document }) => motor(places, document) },
];
