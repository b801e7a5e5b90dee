// What can be moved in space: bodies, points, frames and joints; their poses, and the changes of the file that move them.

/** @import { Poses, Pose } from "./space_poses.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Vec } from "./space_math.js" */

import { neat } from "./neat.js";
import { AXES, about, axisAngle, between, cross, euler, fromMatrix, inverse, matrix, minus, plus, product, size, times, turned, unit } from "./space_math.js";
import { numberOf, vectorOf } from "./space_numbers.js";

/** Element that is selected: a section and a name of the file, and a point or frame of a body, or of the ground.
 * @typedef {{ section: string, name: string, part?: "points" | "frames", key?: string }} Choice */
/** @typedef {(string | number)[]} Keys */

/** Rotations below this, and displacements below this share of the coordinate, are none. */
const NONE = 1e-9;

/** @param {Keys} keys @param {unknown} value @returns {Operation} */
const set = (keys, value) => ({ op: "set", keys, value });
const number = (/** @type {number} */ value) => neat(value);
/** Angle in the file [rad]. @param {number} value */
const radians = (value) => Number((Math.abs(value) < 1e-12 ? 0 : value).toPrecision(12));

/** Value of the file at keys. @param {Document} document @param {Keys} keys @returns {any} */
export const valueAt = (document, keys) => keys.reduce((/** @type {any} */ entry, key) => entry?.[key], document);

/** Operations that move a list of coordinates; those that do not change, or that are formulas, stay where possible.
 * @param {Document} document @param {Keys} keys @param {Vec} before @param {Vec} after @returns {Operation[]} */
export function coordinates(document, keys, before, after) {
  const old = valueAt(document, keys);
  if (!Array.isArray(old)) return size(minus(after, before)) > NONE ? [set(keys, after.map(number))] : [];
  return after.flatMap((value, k) => {
    const entry = old[k], moved = Math.abs(value - before[k]) > NONE * Math.max(1, Math.abs(value));
    if (!moved) return [];
    const shift = numberOf(entry, document);
    return shift !== null && Math.abs(shift - value) < 1e-12 ? [] : [set([...keys, k], number(value))];
  });
}

/** Rotation that a table of the file states; null for formulas beyond numbers. @param {any} table @param {Document} document @returns {Vec | null} */
export function rotationOf(table, document) {
  if (!table) return [1, 0, 0, 0];
  const read = (/** @type {unknown} */ entry) => numberOf(entry, document) ?? NaN;
  const chain = (/** @type {string} */ sequence, /** @type {number[]} */ angles) => [...sequence].reduce((q, axis, k) => product(q, about(AXES[axis], angles[k])), [1, 0, 0, 0]);
  const q = table.type === "axis_angle" ? about(table.axis.map(read), read(table.angle)) : table.type === "bryant" ? chain("xyz", [table.x, table.y, table.z].map(read))
    : table.type === "euler" ? chain(table.sequence, table.angles.map(read)) : fromMatrix(table.rows.map((/** @type {unknown[]} */ row) => row.map(read)));
  return q.every(Number.isFinite) ? q : null;
}

/** Operations that write a rotation in the form of the file. @param {Document} document @param {Keys} keys @param {Vec} q @returns {Operation[]} */
export function rotationChange(document, keys, q) {
  const table = valueAt(document, keys), { axis, angle } = axisAngle(q);
  const each = (/** @type {[Keys, number][]} */ entries) => entries.flatMap(([path, value]) => {
    const old = numberOf(valueAt(document, path), document);
    return old !== null && Math.abs(old - value) < NONE ? [] : [set(path, radians(value))];
  });
  if (table?.type === "bryant") return each(euler(q, "xyz").map((value, k) => [[...keys, "xyz"[k]], value]));
  if (table?.type === "euler") {
    if (table.sequence.length !== 3) throw new Error(`the rotation has the sequence ${table.sequence}; only three angles are written, change it in the text`);
    return each(euler(q, table.sequence).map((value, k) => [[...keys, "angles", k], value]));
  }
  if (table?.type === "from_matrix") return each(matrix(q).flatMap((row, r) => row.map((value, c) => /** @type {[Keys, number]} */ ([[...keys, "rows", r, c], value]))));
  if (table?.type === "axis_angle") {
    const old = table.axis.map((/** @type {unknown} */ entry) => numberOf(entry, document) ?? NaN), same = size(cross(unit(old), axis)) < 1e-6 && size(old) > 0;
    const sign = same && old.reduce((/** @type {number} */ sum, /** @type {number} */ v, /** @type {number} */ k) => sum + v * axis[k], 0) < 0 ? -1 : 1;
    return each([...(same ? [] : axis.map((value, k) => /** @type {[Keys, number]} */ ([[...keys, "axis", k], value]))), [[...keys, "angle"], sign * angle]]);
  }
  return [set(keys, { type: "axis_angle", axis: axis.map(number), angle: radians(angle) })];
}

/** Axes of a frame of the file in its body, as a rotation. @param {any} entry @param {Document} document @returns {Vec | null} */
export function frameRotation(entry, document) {
  if (entry.rotation) return rotationOf(entry.rotation, document);
  const z = entry.axis ? vectorOf(entry.axis, document) : [0, 0, 1];
  if (!z || size(z) === 0) return null;
  const x = entry.x ? vectorOf(entry.x, document) : null;
  if (!x) return between([0, 0, 1], z);
  const w = unit(z), v = unit(cross(w, x)), u = cross(v, w);
  return fromMatrix([0, 1, 2].map((k) => [u[k], v[k], w[k]]));
}

/** Keys and body of an end of a joint or a force. @param {Document} document @param {Keys} keys of the end */
export function endOf(document, keys) {
  const end = valueAt(document, keys);
  if (end && typeof end === "object") return { body: end.body, part: "inline", keys };
  if (typeof end !== "string") return null;
  const [body, ...rest] = end.split("."), name = rest.join("."), owner = body === "ground" ? ["ground"] : ["bodies", body];
  for (const part of ["frames", "points"]) if (valueAt(document, [...owner, part, name]) !== undefined) return { body, part, keys: [...owner, part, name] };
  return document.bodies?.[body]?.type === "Bar" && (name === "start" || name === "end") ? { body, part: "bar", keys: ["bodies", body] } : null;
}

/** Pose of a point or frame of the file in its body; null where its coordinates have no value.
 * @param {Document} document @param {Keys} keys @returns {Pose | null} */
function localPose(document, keys) {
  const entry = valueAt(document, keys), p = Array.isArray(entry) ? vectorOf(entry, document) : entry?.at ? vectorOf(entry.at, document) : entry ? [0, 0, 0] : null;
  const q = Array.isArray(entry) ? [1, 0, 0, 0] : entry && frameRotation(entry, document);
  return p && q ? { p, q } : null;
}

/** Pose in space. @param {Pose} body @param {Pose} local @returns {Pose} */
export const placed = ({ p, q }, local) => ({ p: plus(p, turned(q, local.p)), q: product(q, local.q) });
/** Pose in a body. @param {Pose} body @param {Pose} pose @returns {Pose} */
export const within = ({ p, q }, pose) => ({ p: turned(inverse(q), minus(pose.p, p)), q: product(inverse(q), pose.q) });

/** Keys of a chosen element. @param {Choice} choice @returns {Keys} */
const keysOf = ({ section, name, part, key }) => (part ? [...(section === "ground" ? ["ground"] : ["bodies", name]), part, /** @type {string} */ (key)] : [section, name]);

/** Operation that deletes what is chosen, with all that depends on it. @param {Choice} choice @returns {Operation} */
export const removal = (choice) => (choice.part ? { op: "remove point", keys: keysOf(choice) } : { op: "remove", section: choice.section, name: choice.name });

/** Whether a choice exists: in the file, as an end of a bar, or as the ground. @param {Document} document @param {Choice} choice */
export const isStated = (document, choice) => isGround(choice) || isBarEnd(document, choice) || valueAt(document, keysOf(choice)) !== undefined;

/** Whether it can be deleted. @param {Document} document @param {Choice} choice */
export const isRemovable = (document, choice) => !isGround(choice) && valueAt(document, keysOf(choice)) !== undefined;

/** @param {Choice} choice */
const isGround = ({ section, part }) => section === "ground" && !part;

/** @param {Document} document @param {Choice} choice */
const isBarEnd = (document, { section, name, part, key }) => section === "bodies" && part === "points" && document.bodies?.[name]?.type === "Bar" && (key === "start" || key === "end");

/** Pose of what is chosen; null for what cannot be moved. @param {Poses} poses @param {Document} document @param {Choice} choice @returns {Pose | null} */
export function poseOf(poses, document, choice) {
  const { section, name, part, key } = choice;
  if (section === "bodies" && !part) return poses.of(name);
  if (part) {
    const body = poses.of(section === "ground" ? "ground" : name), local = localPose(document, keysOf(choice));
    if (body && local) return placed(body, local);
    const point = poses.page.motion.points.find((/** @type {any} */ item) => item.name === `${name}.${key}`);
    return point && body ? { p: poses.page.motion.at(point.body, point.point), q: body.q } : null;
  }
  const item = [...poses.page.motion.joints, ...poses.page.motion.symbols].find((/** @type {any} */ one) => one.name === name), body = item && poses.of(item.body?.fixed ? "ground" : item.body?.name);
  if (!item?.point || !body) return null;
  return placed(body, { p: item.point, q: item.axis ? between([0, 0, 1], item.axis) : [1, 0, 0, 0] });
}

/** Whether what is chosen can be rotated. @param {Document} document @param {Choice} choice */
export const rotates = (document, { section, name, part }) => (part ? part === "frames" : section === "joints" ? document.joints?.[name]?.type !== "Spherical" : section === "bodies" && document.bodies?.[name]?.type !== "Particle");

/** Operations that move what is chosen. @param {Poses} poses @param {Document} document @param {Choice} choice @param {Pose} before @param {Pose} after @returns {Operation[]} */
export function moved(poses, document, choice, before, after) {
  const { section, name, part } = choice, isTurned = 1 - Math.abs(before.q.reduce((sum, v, k) => sum + v * after.q[k], 0)) > 1e-13;
  if (section === "bodies" && !part) {
    const keys = ["bodies", name];
    return [...coordinates(document, [...keys, "position"], before.p, after.p), ...(isTurned ? rotationChange(document, [...keys, "rotation"], after.q) : [])];
  }
  if (part === "points" && valueAt(document, keysOf(choice)) === undefined) return barEnd(poses, document, name, /** @type {string} */ (choice.key), after.p);
  const ends = part ? [{ body: section === "ground" ? "ground" : name, part, keys: keysOf(choice) }]
    : [0, 1].map((k) => endOf(document, [section, name, "connect", k])).filter((end) => end !== null);
  return ends.flatMap(({ body, part: kind, keys }) => {
    const pose = poses.of(body);
    if (!pose) return [];
    if (kind === "bar") return barEnd(poses, document, body, valueAt(document, [section, name, "connect", 0]) === `${body}.start` || valueAt(document, [section, name, "connect", 1]) === `${body}.start` ? "start" : "end", after.p);
    const [old, now] = [within(pose, before), within(pose, after)];
    return [...coordinates(document, kind === "points" ? keys : [...keys, "at"], old.p, now.p), ...(isTurned && kind !== "points" ? axesChange(document, keys, product(product(inverse(pose.q), product(after.q, inverse(before.q))), pose.q)) : [])];
  });
}

/** Operations that rotate the axes of a frame in its body. @param {Document} document @param {Keys} keys @param {Vec} turn */
function axesChange(document, keys, turn) {
  const entry = valueAt(document, keys), now = frameRotation(entry, document);
  if (!now) throw new Error("the axes of this frame are formulas; change them in the text");
  if (entry.rotation) return rotationChange(document, [...keys, "rotation"], product(turn, now));
  const turnAxis = (/** @type {string} */ key, /** @type {Vec} */ old) => coordinates(document, [...keys, key], old, turned(turn, old).map((v) => neat(v)));
  const [axis, x] = [entry.axis, entry.x].map((value) => value && vectorOf(value, document));
  const changes = [...turnAxis("axis", axis ?? [0, 0, 1]), ...(x ? turnAxis("x", x) : [])], isFrame = keys.at(-2) === "frames";
  return changes.length || x || !isFrame ? changes : [set([...keys, "x"], turned(product(turn, now), [1, 0, 0]).map((v) => neat(v)))];  // about its own axis
}

/** Operations that move an end of a bar, whose other end stays. @param {Poses} poses @param {Document} document @param {string} name @param {string} end @param {Vec} to */
function barEnd(poses, document, name, end, to) {
  const pose = poses.of(name), point = (/** @type {string} */ key) => poses.page.motion.points.find((/** @type {any} */ item) => item.name === `${name}.${key}`);
  const other = point(end === "start" ? "end" : "start");
  if (!pose || !other) return [];
  const fixed = poses.page.motion.at(other.body, other.point).map((/** @type {number} */ v) => Number(v.toPrecision(7))), [from, last] = end === "start" ? [to, fixed] : [fixed, to], way = minus(last, from);
  const q = product(between(turned(pose.q, [1, 0, 0]), way), pose.q);
  return [set(["bodies", name, "length"], number(size(way))), ...coordinates(document, ["bodies", name, "position"], pose.p, times(plus(from, last), 0.5)), ...rotationChange(document, ["bodies", name, "rotation"], q)];
}

/** Two directions and the axis of a frame. @param {Pose} pose */
export const axesOf = ({ q }) => Object.values(AXES).map((axis) => turned(q, axis));
