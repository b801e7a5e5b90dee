// Changes of the targets of a synthesis in the text: of one number or one row, so that all others stay as they are written.

/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { numberOf } from "./space_numbers.js";

/** Keys of [synthesis]. @param {Document | null} document @returns {Record<string, any>} */
export const synthesisOf = (document) => document?.synthesis ?? {};

/** Columns of the types of targets: keys, and the parts of each item. @type {Record<string, [string, (number | null)[]][]>} */
export const COLUMNS = {
  path: [["points", [0, 1]]],
  motion: [["points", [0, 1]], ["coupler_angles", [null]]],
  function: [["crank_angles", [null]], ["outputs", [null]]],
};
/** Keys of the columns of all targets. */
const KEYS = ["points", "coupler_angles", "outputs", "crank_angles"];

/** Entries in SI units: NaN in place of what is no number of the file. @typedef {{ type: string, closed: boolean, points: number[][], angles: number[], crank: number[], outputs: number[] }} Target */

/** Numbers of the target of a document in SI units. @param {Document | null} document @returns {Target} */
export function targetOf(document) {
  const table = synthesisOf(document), number = (/** @type {unknown} */ value) => numberOf(value, {}) ?? NaN;
  const list = (/** @type {string} */ key) => /** @type {any[]} */ (Array.isArray(table[key]) ? table[key] : []);
  return {
    type: table.type ?? "path", closed: table.closed === true,
    points: list("points").map((point) => [0, 1].map((k) => number(point?.[k]))),
    angles: list("coupler_angles").map(number), crank: list("crank_angles").map(number), outputs: list("outputs").map(number),
  };
}

/** @param {(string | number)[]} keys @param {unknown} value @returns {Operation} */
const set = (keys, value) => ({ op: "set", keys: ["synthesis", ...keys], value });
/** @param {string} key @param {unknown} value @returns {Operation} */
const append = (key, value) => ({ op: "append_item", keys: ["synthesis", key], value });
/** Numbers without the noise of pixels. @param {number} value */
export const short = (value) => Number(value.toPrecision(6));

/** Angle without the noise of pixels in the unit of the file. @param {unknown} written number of the file @param {number} value [rad] */
const shortAngle = (written, value) => (typeof written === "string" && /\d\s*(?:deg|°)\s*$/.test(written) ? (short((value * 180) / Math.PI) * Math.PI) / 180 : short(value));

/** Write a number, a quantity with its unit or a formula into a cell. @param {string} key @param {number} row @param {number | null} part @param {unknown} value @returns {Operation[]} */
export const typed = (key, row, part, value) => [{ ...set(part === null ? [key, row] : [key, row, part], value), written: true }];

/** Operations that give numbers new values; those of an equal value stay as they are written. @param {[(string | number)[], number, number][]} changes keys, old and new value of each @returns {Operation[]} */
const changed = (changes) => changes.flatMap(([keys, old, value]) => (Math.abs(old - value) <= 1e-12 * Math.abs(value) ? [] : [set(keys, value)]));

/** Move a point of a path, or a pose. @param {Document | null} document @param {number} row @param {number[]} to */
export function movedPoint(document, row, to) {
  const old = targetOf(document).points[row];
  return changed([0, 1].map((k) => [["points", row, k], old[k], short(to[k])]));
}

/** Turn a pose. @param {Document | null} document @param {number} row @param {number} angle */
export const turnedPose = (document, row, angle) => changed([[["coupler_angles", row], targetOf(document).angles[row], shortAngle(synthesisOf(document).coupler_angles?.[row], angle)]]);

/** Remove an entry from the columns that have it. @param {Document | null} document @param {number} row @returns {Operation[]} */
export function removedRow(document, row) {
  const table = synthesisOf(document), own = COLUMNS[table.type ?? "path"]?.map(([key]) => key) ?? [];
  return [...new Set([...own, "crank_angles"])].flatMap((key) => (row < (table[key]?.length ?? 0) ? [{ op: "remove_item", keys: ["synthesis", key, row] }] : []));
}

/** Operation that makes the target one of a type, without columns of others; none if it is one. Crank angles of paths and poses stay. @param {Document | null} document @param {string} type @returns {Operation[]} */
function ofType(document, type) {
  const table = synthesisOf(document), former = table.type ?? "path", own = COLUMNS[type].map(([key]) => key);
  const stays = (/** @type {string} */ key) => (former === type ? own.includes(key) || key === "crank_angles" : key === "crank_angles" && former !== "function");
  const fields = { ...(table.type !== type && { type }), ...Object.fromEntries(KEYS.filter((key) => key in table && !stays(key)).map((key) => [key, null])) };
  return Object.keys(fields).length ? [{ op: "section", section: "synthesis", fields }] : [];
}

/** A further point of a path; a former motion or function becomes a path. @param {Document | null} document @param {number[]} at @returns {Operation[]} */
export const addedPoint = (document, at) => [...ofType(document, "path"), append("points", at.map(short))];

/** A further pose, whose angle is near that of the last one. @param {Document | null} document @param {number[]} at @param {number} angle @returns {Operation[]} */
export function addedPose(document, at, angle) {
  const { type, angles } = targetOf(document), last = type === "motion" ? angles.at(-1) ?? NaN : NaN;
  const near = Number.isFinite(last) ? angle + 2 * Math.PI * Math.round((last - angle) / (2 * Math.PI)) : angle;
  return [...ofType(document, "motion"), append("points", at.map(short)), append("coupler_angles", short(near))];
}

/** Insert a point of a function in the order of the crank angles. @param {number[]} crank of the other points @param {number[]} point crank angle and output @returns {Operation[]} */
function insertedFunctionPoint(crank, point) {
  const next = crank.findIndex((angle) => angle > point[0]);
  return ["crank_angles", "outputs"].map((key, k) => (next < 0 ? append(key, point[k]) : { op: "insert_item", keys: ["synthesis", key, next], value: point[k] }));
}

/** A further point of a function; crank angles of a former path have no outputs, and are removed. @param {Document | null} document @param {number[]} point crank angle and output @returns {Operation[]} */
export function addedFunctionPoint(document, point) {
  const { crank, outputs } = targetOf(document), alone = crank.length && !outputs.length;
  return [...ofType(document, "function"), ...(alone ? [{ op: "section", section: "synthesis", fields: { crank_angles: null } }] : []), ...insertedFunctionPoint(alone ? [] : crank, point)];
}

/** Move a point of a function; one that passes others is written at another place of the columns. @param {Document | null} document @param {number} row @param {number[]} point crank angle and output @returns {Operation[]} */
export function movedFunctionPoint(document, row, point) {
  const { crank, outputs } = targetOf(document), others = crank.filter((_, k) => k !== row), before = (/** @type {number} */ angle) => others.filter((other) => other <= angle).length;
  const table = synthesisOf(document);
  if (before(point[0]) === before(crank[row])) return changed([[["crank_angles", row], crank[row], shortAngle(table.crank_angles[row], point[0])], [["outputs", row], outputs[row], shortAngle(table.outputs[row], point[1])]]);
  const to = others.filter((angle) => angle <= point[0]).length;
  return ["crank_angles", "outputs"].flatMap((key, k) => [{ op: "move_item", keys: ["synthesis", key, row], to }, ...changed([[[key, to], [crank, outputs][k][row], shortAngle(table[key][row], point[k])]])]);
}
