// Control points of the curve of a selected cam, which are dragged.

/** @import { Page } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { inBody } from "./snapping.js";

/** Distance within which the pointer catches a control point [px]. */
const CATCH = 9;

/** Joint with a curve that is selected, itself or by the body of the curve. @param {Document} document @param {string | null} selected */
const camOf = ({ joints = {} }, selected) => Object.entries(joints).find(([name, { curve, connect }]) => curve && (name === selected || connect?.[0] === selected))?.[0] ?? null;

/** Control points of the curve of a selected joint or body at their places. @param {Page} page @param {Document} document @param {string | null} selected @returns {{ x: number, y: number, joint: string, body: string, index: number }[]} */
export function controlPoints({ motion }, document, selected) {
  const name = camOf(document, selected), joint = name === null ? null : document.joints?.[name], points = joint?.curve?.points, body = motion.bodies.find((/** @type {any} */ part) => part.name === joint?.connect?.[0]), pose = body && motion.pose(body);
  if (!name || !pose || !Array.isArray(points) || !points.flat().every((value) => typeof value === "number")) return [];
  return points.map((point, index) => {
    const [x, y] = motion.placed(pose, point);
    return { x, y, joint: name, body: body.name, index };
  });
}

/** Control point under the pointer. @param {Page} page @param {Document} document @param {string | null} name @param {[number, number]} pixel */
export function controlAt(page, document, name, [u, v]) {
  return controlPoints(page, document, name).find(({ x, y }) => { const [a, b] = page.scene.view.screen([x, y]); return Math.hypot(a - u, b - v) < CATCH; }) ?? null;
}

/** Move a control point. @param {Page} page @param {ReturnType<typeof controlPoints>[number]} control @param {{ x: number, y: number }} to @returns {Change | null} */
export function moveControl(page, { joint, body, index }, to) {
  const at = inBody(page, body, to.x, to.y);
  return at && { label: `shape ${joint}`, operations: [{ op: "set", keys: ["joints", joint, "curve", "points", index], value: at.map(neat) }] };
}
