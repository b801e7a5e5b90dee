// Changes of the model file for what is drawn in space.

/** @import { Poses } from "./space_poses.js" */
/** @import { SpacePlace } from "./space_places.js" */
/** @import { Change, Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Vec } from "./space_math.js" */

import { neat } from "./neat.js";
import { axisAngle, across, between, cross, dot, inverse, minus, plus, size, times, turned, unit } from "./space_math.js";

/** Density of new solids [kg/m³]; mass [kg] and moments of inertia [kg m²] of a new body without a shape. */
const DENSITY = 1000, MASS = 1, INERTIA = 0.01;
/** Radius of a new bar relative to its length. */
const SLENDER = 0.03;
/** Stiffness of a new spring [N/m], new force [N], moment [N m], pitch of a screw [m], stroke [m] and time of a turn [s] of a motor. */
const STIFFNESS = 200, FORCE = 10, MOMENT = 1, PITCH = 0.01, STROKE = 0.05, TURN = 2;

/** Joints between frames, with the axis along z of both. */
export const JOINT_KINDS = ["Revolute", "Prismatic", "Cylindrical", "Spherical", "Universal", "Screw", "Weld", "Planar"];

/** Coordinates without noise, relative to the largest. @param {Vec} v */
const numbers = (v) => { const most = Math.max(...v.map(Math.abs)); return v.map((part) => (Math.abs(part) < 1e-7 * most ? 0 : neat(part))); };

/** Rotation as a table of the file; none where it is the identity. @param {Vec} q */
function rotation(q) {
  const { axis, angle } = axisAngle(q);
  return Math.abs(angle) < 1e-12 ? {} : { rotation: { type: "axis_angle", axis: numbers(axis), angle: Number(angle.toPrecision(12)) } };
}

/** @param {string} base @param {Record<string, unknown>} fields @param {Operation[]} [more] @returns {Change} */
const body = (base, fields, more = []) => ({ label: `add ${base}`, operations: [{ op: "add", section: "bodies", base, as: "$body", fields }, ...more] });

/** Axes of a working plane: two in it and its normal, right-handed. @param {Vec} normal */
export function planeFrame(normal) {
  const k = normal.findIndex((v) => Math.abs(v) > 0.999), [u, v] = k < 0 ? across(normal) : [[0, 1, 2].map((i) => Number(i === (k + 1) % 3)), [0, 1, 2].map((i) => Number(i === (k + 2) % 3))];
  return [u, v, normal];
}

/** Box over two corners of the plane and a height. @param {Vec} from @param {Vec} to @param {Vec} top @param {Vec} normal */
export function boxOf(from, to, top, normal) {
  const way = minus(top, from), span = planeFrame(normal).map((axis, k) => times(axis, k < 2 ? dot(minus(to, from), axis) : dot(way, normal)));
  return { center: plus(from, times(span.reduce(plus), 0.5)), size: [0, 1, 2].map((k) => Math.abs(span.reduce((sum, side) => sum + side[k], 0))) };
}

/** @param {SpacePlace[]} places @param {Vec} normal @returns {Change | null} */
export function box([from, to, top], normal) {
  const { center, size: lengths } = boxOf(from.p, to.p, top.p, normal);
  return lengths.every((length) => length > 0) ? body("box", { type: "Box", density: DENSITY, size: numbers(lengths), position: numbers(center) }) : null;
}

/** @param {SpacePlace[]} places @param {Vec} normal @returns {Change | null} */
export function cylinder([center, rim, top], normal) {
  const radius = size(minus(rim.p, center.p)), height = dot(minus(top.p, center.p), normal);
  if (!(radius > 0) || !(Math.abs(height) > 0)) return null;
  return body("cylinder", { type: "Cylinder", density: DENSITY, radius: neat(radius), length: neat(Math.abs(height)), position: numbers(plus(center.p, times(normal, height / 2))), ...rotation(between([0, 0, 1], normal)) });
}

/** @param {SpacePlace[]} places @returns {Change | null} */
export function sphere([center, rim]) {
  const radius = size(minus(rim.p, center.p));
  return radius > 0 ? body("sphere", { type: "Sphere", density: DENSITY, radius: neat(radius), position: numbers(center.p) }) : null;
}

/** Body without a shape. @param {SpacePlace[]} places @returns {Change} */
export const plainBody = ([place]) => body("body", { type: "Body", mass: MASS, inertia: [INERTIA, INERTIA, INERTIA], position: numbers(place.p) });

/** Bar between two places; its ends are joined to named points by spherical joints. @param {SpacePlace[]} places @returns {Change | null} */
export function bar([from, to]) {
  const way = minus(to.p, from.p), length = size(way);
  if (!(length > 0)) return null;
  const joined = [from, to].flatMap((place, k) => (place.names.length ? [{ op: "add", section: "joints", base: "", fields: { type: "Spherical", connect: [place.names[0], k ? "$body.end" : "$body.start"] } }] : []));
  const fields = { type: "Bar", length: neat(length), radius: neat(Number((SLENDER * length).toPrecision(2))), density: DENSITY, position: numbers(times(plus(from.p, to.p), 0.5)), ...rotation(between([1, 0, 0], way)) };
  return body("bar", fields, joined);
}

/** Reference to a place on a body: a point with a name, or coordinates. @param {Poses} poses @param {Vec} p @param {string} name of the body @param {string[]} names @param {Record<string, Vec>} axes in space */
function reference(poses, p, name, names = [], axes = {}) {
  const own = names.find((point) => point.slice(0, point.lastIndexOf(".")) === name);
  if (own && !Object.keys(axes).length) return own;
  const pose = /** @type {import("./space_poses.js").Pose} */ (poses.of(name)), back = inverse(pose.q);
  const local = numbers(turned(back, minus(p, pose.p)));
  return { body: name, at: local, ...Object.fromEntries(Object.entries(axes).map(([key, axis]) => [key, numbers(turned(back, unit(axis)))])) };
}

/** @param {SpacePlace} place */
const owner = ({ body: name }) => name ?? "ground";

/** Second axis of a universal joint: perpendicular to the first and, as in a shaft, to the line from the joint to the mass centre of the second body.
 * @param {Vec} z @param {Vec} p @param {import("./space_poses.js").Pose | null} pose @returns {Vec} */
function crossAxis(z, p, pose) {
  const line = pose ? minus(pose.p, p) : z, axis = cross(z, line);
  return size(axis) > 1e-6 * size(line) ? unit(axis) : across(z)[0];
}

/** Joint at the first place between the bodies of both. @param {SpacePlace[]} places @param {Poses} poses @param {string} type @param {Vec} axis @returns {Change | null} */
export function joint([first, second], poses, type, axis) {
  if (owner(first) === owner(second)) return null;
  const { p } = first, z = unit(axis), ends = [first, second].sort((a, b) => Number(b.body === null) - Number(a.body === null));  // the ground comes first
  const axes = (/** @type {number} */ k) => (type === "Spherical" ? undefined : { axis: type === "Universal" && k ? crossAxis(z, p, poses.of(owner(ends[1]))) : z });
  const names = [...first.names, ...(size(minus(second.p, p)) < 1e-9 ? second.names : [])];
  const connect = ends.map((end, k) => reference(poses, p, owner(end), names, axes(k)));
  const fields = { type, connect, ...(type === "Screw" ? { pitch: PITCH } : {}) };
  return { label: `add ${type.toLowerCase()} joint`, operations: [{ op: "add", section: "joints", base: "", fields }] };
}

/** Element between two points. @param {SpacePlace[]} places @param {Poses} poses @param {"RigidLink" | "Spring"} type @returns {Change | null} */
export function connection([from, to], poses, type) {
  const length = size(minus(to.p, from.p));
  if (!(length > 0) || owner(from) === owner(to)) return null;
  const connect = [from, to].map((place) => reference(poses, place.p, owner(place), place.names));
  const isLink = type === "RigidLink", fields = isLink ? { type, connect, length: neat(length) } : { type, connect, stiffness: STIFFNESS, free_length: neat(length) };
  return { label: `add ${isLink ? "link" : "spring"}`, operations: [{ op: "add", section: isLink ? "joints" : "forces", base: isLink ? "link" : "spring", fields }] };
}

/** @param {SpacePlace[]} places @param {Poses} poses @returns {Change | null} */
export function force([place, toward], poses) {
  const way = minus(toward.p, place.p);
  if (!place.body || !(size(way) > 0)) return null;
  const fields = { type: "Force", connect: [reference(poses, place.p, place.body, place.names)], vector: numbers(times(unit(way), FORCE)) };
  return { label: "add force", operations: [{ op: "add", section: "forces", base: "force", fields }] };
}

/** @param {SpacePlace[]} places @param {Vec} axis @returns {Change | null} */
export function torque([place], axis) {
  if (!place.body) return null;
  return { label: "add torque", operations: [{ op: "add", section: "forces", base: "torque", fields: { type: "Torque", connect: [place.body], vector: numbers(times(unit(axis), MOMENT)) } }] };
}

/** Motor in a joint with a free rotation or displacement. @param {SpacePlace[]} places @param {Document} document @returns {Change | null} */
export function motor([{ joint: name }], document) {
  const type = name === null ? null : document.joints?.[name]?.type;
  if (!type || !["Revolute", "Cylindrical", "Screw", "Prismatic"].includes(type)) return null;
  const fields = type === "Prismatic" ? { type: "TranslationalDriver", joint: name, law: `${STROKE}*sin(2*pi*t/${TURN})` } : { type: "RotationalDriver", joint: name, law: `2*pi*t/${TURN}` };
  return { label: "add motor", operations: [{ op: "add", section: "drivers", base: "motor", fields }] };
}

