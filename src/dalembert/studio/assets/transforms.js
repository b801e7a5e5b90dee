// Moved, rotated and mirrored elements of a model file.

/** @import { Page } from "./pictures.js" */
/** @import { Document } from "./types.d.ts" */

import { neat, neatSpot } from "./neat.js";

/** Rigid map of the plane: a reflection about the x axis if `mirrored`, then a rotation, then a shift.
 * @typedef {{ turn: number, mirrored: boolean, x: number, y: number }} Transform */
/** Names of mapped elements → new names, which are the same where elements are changed in place.
 * @typedef {{ page: Page, document: Document, map: Transform, names: Map<string, string> }} Context */
/** @typedef {Record<string, any>} Entry */

/** Connections that name whole bodies. */
const OF_BODIES = ["RotationalDriver", "TorsionSpring", "Torque", "Coupling"];
/** Keys of angles of the second body relative to the first. */
const RELATIVE = { Prismatic: "angle", Weld: "angle", TorsionSpring: "free_angle", RotationalDriver: "law" };
/** Keys of the ends of beams, and of their directions there. */
const FRAMES = { frame_i: "angle_i", frame_j: "angle_j" };

/** @param {number} x @param {number} y @returns {Transform} */
export const shift = (x, y) => ({ turn: 0, mirrored: false, x, y });

/** Rotation about a point. @param {{ x: number, y: number }} center @param {number} turn @returns {Transform} */
export const rotation = (center, turn) => about(center, { turn, mirrored: false, x: 0, y: 0 });

/** Reflection about a line through two points. @param {{ x: number, y: number }} p @param {{ x: number, y: number }} q @returns {Transform} */
export const reflection = (p, q) => about(p, { turn: 2 * Math.atan2(q.y - p.y, q.x - p.x), mirrored: true, x: 0, y: 0 });

/** The same map with a fixed point. @param {{ x: number, y: number }} center @param {Transform} map @returns {Transform} */
function about(center, map) {
  const [x, y] = image(map, [center.x, center.y]);
  return { ...map, x: center.x - x, y: center.y - y };
}

/** @param {Transform} map */
const basis = ({ turn, mirrored }) => [neat(Math.cos(turn)), neat(Math.sin(turn)), mirrored ? -1 : 1];

/** @param {Transform} map @param {number[]} point @returns {[number, number]} */
function image(map, [x, y]) {
  const [c, s, m] = basis(map);
  return [c * x - s * m * y + map.x, s * x + c * m * y + map.y];
}

/** Image of a point. @param {Transform} map @param {number[]} point @returns {[number, number]} */
export const applied = (map, point) => /** @type {[number, number]} */ (neatSpot(image(map, point), [...point, map.x, map.y]));

/** Image of a direction, whose components may be formulas. @param {Transform} map @param {any[]} vector */
export function turned(map, vector) {
  const [c, s, m] = basis(map), [a, b] = vector;
  if (typeof a === "number" && typeof b === "number") return [neat(c * a - s * m * b), neat(s * a + c * m * b)];
  if (s === 0 && c === 1) return [a, m < 0 ? minus(b) : b];
  const term = (/** @type {number} */ factor, /** @type {any} */ value) => (typeof value === "number" ? String(neat(factor * value)) : `${factor}*(${value})`);
  return [`${term(c, a)} + ${term(-s * m, b)}`, `${term(s, a)} + ${term(c * m, b)}`];
}

/** The negative of a number, a number with a unit, or a formula. @param {any} value */
export function minus(value) {
  if (typeof value === "number") return -value || 0;
  const measured = /^\s*(-?)([\d.]+(?:[eE][-+]?\d+)?\s*[^\W\d]*)\s*$/.exec(value);
  if (measured) return `${measured[1] ? "" : "-"}${measured[2]}`;
  return /^-\([^()]*\)$/.test(value) ? value.slice(2, -1) : `-(${value})`;
}

/** Names that a value refers to, as wholes or before a dot. @param {unknown} value @param {(name: string) => boolean} known @returns {Set<string>} */
export function references(value, known) {
  if (typeof value === "string") return new Set([...value.matchAll(/(?<![\w.])[A-Za-z_]\w*/g)].map(([name]) => name).filter(known));
  if (typeof value !== "object" || value === null) return new Set();
  return new Set(Object.values(value).flatMap((item) => [...references(item, known)]));
}

/** A value with other names of elements. @param {any} value @param {Map<string, string>} names @returns {any} */
export function renamed(value, names) {
  if (typeof value === "string") return value.replace(/(?<![\w.])[A-Za-z_]\w*(?=\.|$)/g, (name) => names.get(name) ?? name);
  if (Array.isArray(value)) return value.map((item) => renamed(item, names));
  return typeof value === "object" && value !== null ? Object.fromEntries(Object.entries(value).map(([key, item]) => [key, key === "type" ? item : renamed(item, names)])) : value;
}

/** Image of a body. @param {Context} context @param {string} name @param {Entry} entry @param {boolean} free whether no joint places it @returns {Entry} */
export function mappedBody({ page, map }, name, entry, free) {
  const pose = page.motion.pose(page.motion.bodies.find((/** @type {any} */ body) => body.name === name)), next = structuredClone(entry);
  if (!pose) throw new Error(`${name} has no place in the picture`);
  const moves = map.turn !== 0 || map.mirrored;
  const own = (/** @type {any} */ written, /** @type {number} */ now) => { const value = inRadians(written); return value !== null && Math.abs(value - now) < 1e-6 ? value : now; };
  if (moves || free || entry.position) next.position = applied(map, [own(entry.position?.[0], pose.x), own(entry.position?.[1], pose.y)]).map(neat);
  if (entry.type !== "Particle" && moves) next.angle = neat((map.mirrored ? -1 : 1) * own(entry.angle, pose.a) + map.turn);
  if (map.mirrored && entry.points) next.points = Object.fromEntries(Object.entries(entry.points).map(([point, at]) => [point, flipped(at)]));
  if (entry.velocity && moves) next.velocity = turned(map, entry.velocity);
  if (entry.angular_velocity !== undefined && map.mirrored) next.angular_velocity = minus(entry.angular_velocity);
  return next;
}

/** A written coordinate or angle; null for a formula. @param {any} value */
function inRadians(value) {
  const degrees = typeof value === "string" ? /^\s*(-?[\d.]+(?:[eE][-+]?\d+)?)\s*(?:deg|°)\s*$/.exec(value) : null;
  return degrees ? (Number(degrees[1]) * Math.PI) / 180 : typeof value === "number" ? value : null;
}

/** A place or direction in the axes of a mirrored body. @param {any} at */
export const flipped = (at) => [at[0], minus(at[1])];

/** Image of a joint, driver or force. @param {Context} context @param {string} name @param {Entry} entry @returns {Entry} */
export function mapped(context, name, entry) {
  const { document, map, names } = context, next = renamed(entry, names), whole = OF_BODIES.includes(entry.type), moves = map.turn !== 0 || map.mirrored;
  if (Array.isArray(entry.connect) && !whole) next.connect = entry.connect.map((end, k) => mappedEnd(context, name, end, next.connect[k], entry.type === "PointOnCurve" && k === 0));
  if (Array.isArray(entry.points)) next.points = entry.points.map((end, k) => mappedEnd(context, name, end, next.points[k], false));
  if (entry.frame_i || entry.frame_j) return mappedBeam(context, name, entry, next);
  if (!moves) return next;
  const [first, second] = bodiesOf(document, entry), world = first === "ground";
  if (entry.axis || (world && ["Prismatic", "PinInSlot", "RackAndPinion", "RollingDisc", "TranslationalDriver"].includes(entry.type) && !entry.joint)) next.axis = world ? turned(map, entry.axis ?? [1, 0]) : map.mirrored ? flipped(entry.axis) : entry.axis;
  if (entry.vector && !entry.following) next.vector = turned(map, entry.vector);
  if (entry.vector && entry.following && map.mirrored) next.vector = flipped(entry.vector);
  if (entry.type === "Torque" && map.mirrored) next.value = minus(entry.value);
  if (["RackAndPinion", "RollingDisc"].includes(entry.type) && map.mirrored) next.side = -(entry.side ?? 1);
  if (entry.curve && map.mirrored) next.curve = { ...entry.curve, points: curvePoints(name, entry).map(flipped).reverse() };
  const key = RELATIVE[/** @type {keyof typeof RELATIVE} */ (entry.type)];
  if (key) {
    const offset = world ? map.turn : second === "ground" ? -map.turn : 0;
    if (offset !== 0 || map.mirrored) next[key] = relative(name, entry[key] ?? 0, map.mirrored, neat(offset));
  }
  return next;
}

/** Image of a flexible beam. @param {Context} context @param {string} name @param {Entry} entry @param {Entry} next with other names @returns {Entry} */
function mappedBeam(context, name, entry, next) {
  const { map } = context;
  for (const [key, angle] of Object.entries(FRAMES)) {
    if (entry[key] === undefined) continue;
    next[key] = mappedEnd(context, name, entry[key], next[key], false);
    const offset = bodyOf(entry[key]) === "ground" ? map.turn : 0;
    if (offset || (map.mirrored && entry[angle] !== undefined)) next[angle] = relative(name, entry[angle] ?? 0, map.mirrored, neat(offset));
  }
  for (const key of ["curvature", "angular_velocity"]) if (map.mirrored && entry[key] !== undefined) next[key] = minus(entry[key]);
  if (entry.angle !== undefined) next.angle = relative(name, entry.angle, map.mirrored, neat(map.turn));
  if (entry.position) next.position = applied(map, entry.position).map(neat);
  if (entry.velocity) next.velocity = turned(map, entry.velocity);
  return next;
}

/** @param {string} name @param {Entry} entry @returns {any[]} */
function curvePoints(name, { curve }) {
  if (!Array.isArray(curve.points)) throw new Error(`${name}: this curve is mirrored in the text`);
  return curve.points;
}

/** @param {string} name @param {any} value @param {boolean} mirrored @param {number} offset */
function relative(name, value, mirrored, offset) {
  if (typeof value === "object") throw new Error(`${name}: this law is changed in the text`);
  if (typeof value === "number") return neat((mirrored ? -value : value) + offset);
  const own = mirrored ? minus(value) : value;
  return offset ? `${offset} + ${own}` : own;
}

/** The first and the second body of an element. @param {Document} document @param {Entry} entry @returns {string[]} */
export function bodiesOf(document, entry) {
  const owner = entry.joint ? document.joints?.[entry.joint] ?? {} : entry;
  return (owner.connect ?? []).map(bodyOf);
}

/** Body of an end. @param {any} end @returns {string} */
const bodyOf = (end) => (typeof end === "string" ? end.split(".")[0] : end.body);

/** @param {Context} context @param {string} name @param {any} end @param {any} next with other names @param {boolean} isBody */
function mappedEnd({ document, map, names }, name, end, next, isBody) {
  const [body, point] = typeof end === "string" ? end.split(".") : [end.body, null];
  if (body === "ground") {
    const at = typeof end === "object" ? end.at : point ? document.ground?.points?.[point] : [0, 0];
    if (isBody || !at || at.some((/** @type {any} */ v) => typeof v !== "number")) throw new Error(`${name}: its place on the ground is a formula; change it in the text`);
    return { body, at: applied(map, at).map(neat) };
  }
  return typeof end === "object" && map.mirrored && names.has(body) ? { ...next, at: flipped(end.at) } : next;
}
