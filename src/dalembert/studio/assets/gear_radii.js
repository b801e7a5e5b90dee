// Radii of gears whose centres are moved: the pitch circles keep touching, and the ratio stays.

/** @import { Page } from "./pictures.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Spot } from "./ends.js" */

import { ownerOf, placeOfEnd } from "./ends.js";
import { neat } from "./neat.js";

/** Difference up to which pitch circles touch, relative to the distance of the centres. */
const TOUCH = 1e-6;

/** New radii of gear pairs of which a centre is moved; formulas, and radii that do not fit the centres, stay.
 * @param {Page} page @param {Document} document @param {(place: Spot, body: string) => Spot | null | undefined} moved new place of a centre, if it is moved
 * @param {(name: string) => boolean} [which] the pairs that may change @returns {Operation[]} */
export function gearRadii(page, document, moved, which = () => true) {
  return Object.entries(document.joints ?? {}).flatMap(([name, { type, connect, radius_i: i, radius_j: j, internal }]) => {
    if (type !== "GearPair" || typeof i !== "number" || typeof j !== "number" || !Array.isArray(connect) || !which(name)) return [];
    const now = connect.map((end) => placeOfEnd(page, end)), next = now.map((place, k) => place && (moved(place, ownerOf(connect[k])) ?? place)), [p, q] = now, [to, other] = next;
    if (!p || !q || !to || !other) return [];
    const before = Math.hypot(q.x - p.x, q.y - p.y), scale = Math.hypot(other.x - to.x, other.y - to.y) / before;
    if (!(Math.abs((internal ? Math.abs(j - i) : i + j) - before) < TOUCH * before) || !(Math.abs(scale - 1) > TOUCH)) return [];
    return [["radius_i", i * scale], ["radius_j", j * scale]].map(([key, value]) => ({ op: "set", keys: ["joints", name, key], value: neat(Number(value)) }));
  });
}
