// Control points of a selected element, which are dragged: of the curve of a cam, and ends of joints, forces and flexible beams.

/** @import { Page } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { beamControls } from "./beam_ends.js";
import { endsOf, movedEnd } from "./ends.js";
import { neat } from "./neat.js";
import { inBody } from "./snapping.js";

/** Distance within which the pointer catches a control point [px]. */
const CATCH = 9;

/** Joint with a curve that is selected, itself or by the body of the curve. @param {Document} document @param {string | null} selected */
const camOf = ({ joints = {} }, selected) => Object.entries(joints).find(([name, { curve, connect }]) => curve && (name === selected || connect?.[0] === selected))?.[0] ?? null;

/** A control point. @typedef {{ x: number, y: number, label: string, change: (page: Page, document: Document, to: { x: number, y: number }) => import("./operations.js").Operation[] }} Control */

/** Control points of the curve of a selected joint or body at their places. @param {Page} page @param {Document} document @param {string | null} selected @returns {Control[]} */
function curvePoints({ motion }, document, selected) {
  const name = camOf(document, selected), joint = name === null ? null : document.joints?.[name], points = joint?.curve?.points, body = motion.bodies.find((/** @type {any} */ part) => part.name === joint?.connect?.[0]), pose = body && motion.pose(body);
  if (!name || !pose || !Array.isArray(points) || !points.flat().every((value) => typeof value === "number")) return [];
  return points.map((point, index) => {
    const [x, y] = motion.placed(pose, point);
    return { x, y, label: `shape ${name}`, change: (page, _, to) => [{ op: "set", keys: ["joints", name, "curve", "points", index], value: inBody(page, body.name, to.x, to.y)?.map(neat) }] };
  });
}

/** Control points of a selected element. @param {Page} page @param {Document} document @param {string | null} selected @returns {Control[]} */
export function controlPoints(page, document, selected) {
  const ends = endsOf(page, document, selected).map((end) => ({ x: end.x, y: end.y, label: `move ${end.name}`, change: (/** @type {Page} */ still, /** @type {Document} */ now, /** @type {{ x: number, y: number }} */ to) => movedEnd(still, now, end, to) }));
  return [...curvePoints(page, document, selected), ...ends, ...beamControls(page, document, selected)];
}

/** Control point under the pointer. @param {Page} page @param {Document} document @param {string | null} name @param {[number, number]} pixel */
export function controlAt(page, document, name, [u, v]) {
  return controlPoints(page, document, name).find(({ x, y }) => { const [a, b] = page.scene.view.screen([x, y]); return Math.hypot(a - u, b - v) < CATCH; }) ?? null;
}

/** Move a control point. @param {Page} page @param {Document} document @param {Control} control @param {{ x: number, y: number }} to @returns {Change} */
export const moveControl = (page, document, { label, change }, to) => ({ label, operations: change(page, document, to) });
