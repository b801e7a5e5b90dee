// Tips of the loads of a structure, which are dragged: direction and magnitude.

/** @import { Page } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Spot } from "./structure_plan.js" */

import { numberOf } from "./space_numbers.js";

/** Distance within which the pointer takes hold [px]. */
const REACH = 9;
/** Steps of the direction [rad], and the angle within which it snaps; digits of a force. */
const STEP = Math.PI / 12, NEAR = 0.06, DIGITS = 2;

/** Load of a node that states it alone: number in the list, pixel of the free end of its arrow, newtons per pixel, whether the head is at the node.
 * @typedef {{ index: number, node: string, pixel: Spot, base: Spot, scale: number, inward: boolean }} Tip */

/** Free end of an arrow at a pixel. @param {Page} page @param {Document} document @param {Spot} pixel @returns {Tip | null} */
export function tipAt({ scene, motion }, document, [px, py]) {
  const loads = /** @type {any[]} */ (/** @type {unknown} */ (document.loads ?? []));
  for (const { item, role, from, way, value, inward } of scene.arrows) {
    if (role !== "load" || !motion.mesh) continue;
    const end = inward ? from : [from[0] + way[0], from[1] + way[1]], base = inward ? [from[0] + way[0], from[1] + way[1]] : from;
    if (Math.hypot(end[0] - px, end[1] - py) > REACH) continue;
    const node = motion.mesh.nodes[item.node], own = loads.flatMap((entry, index) => ([entry.nodes].flat().includes(node) && ("fx" in entry || "fy" in entry) ? [{ entry, index }] : []));
    const single = own.length === 1 && ["fx", "fy"].every((key) => !(key in own[0].entry) || numberOf(own[0].entry[key], document) !== null);
    if (single) return { index: own[0].index, node, pixel: end, base, scale: value / Math.hypot(way[0], way[1]), inward };
  }
  return null;
}

/** Change of a load whose tip is dragged. @param {Document} document @param {Tip} tip @param {Spot} to @param {Page} page @returns {Change | null} */
export function tipChange(document, { index, node, base, scale, inward }, to, { scene }) {
  const [x, y] = scene.view.screen(to), sign = inward ? -1 : 1, [u, v] = [sign * (x - base[0]), -sign * (y - base[1])], angle = Math.atan2(v, u), straight = Math.round(angle / STEP) * STEP;
  const turn = Math.abs(angle - straight) < NEAR ? straight : angle, size = Number((scale * Math.hypot(u, v)).toPrecision(DIGITS)), entry = /** @type {any} */ (document.loads)?.[index];
  const values = { fx: size * Math.cos(turn), fy: size * Math.sin(turn) };
  const operations = Object.entries(values).flatMap(([key, value]) => {
    const next = Math.abs(value) < 1e-9 * size ? 0 : Number(value.toPrecision(6));
    return key in entry || next !== 0 ? [{ op: "set", keys: ["loads", index, key], value: next }] : [];
  });
  return size > 0 ? { label: `move the load on ${node}`, operations } : null;
}
