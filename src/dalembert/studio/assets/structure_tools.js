// Tools of the palette of structures.

/** @import { Change } from "./operations.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Setting } from "./structure_changes.js" */
/** @import { Spot, Target } from "./structure_plan.js" */

import { SIZES, heat, hole, load, member, moment, region, roller, support } from "./structure_changes.js";

/** A tool: what its clicks are, and the change that they make. `clicks` is zero for a list that Enter or a click on its start ends; a `chain` goes on from
 * its last place. With `target` the first click is on a node, an edge or, with `bars`, a bar, with `parts` a bar or a region; a `vector` is from there,
 * `units` are those of a typed one. A `scalar` has no direction; drawn, it is positive to the left.
 * @typedef {{ name: string, key: string, group: string, title: string, hint: string[], clicks: number, chain?: boolean, target?: boolean, bars?: boolean, parts?: boolean, scalar?: boolean, units?: (target: Target | null) => { size: number, units: Record<string, number> }, closed?: boolean, make: (places: Place[], setting: Setting, target: Target | null, vector: Spot | null) => Change | null }} StructureTool */

const NODE = "click a node, a corner or an edge", FORCES = { "": 1, N: 1, kN: 1e3, MN: 1e6 }, MOMENTS = { "": 1, Nm: 1, kNm: 1e3 }, LENGTHS = { "": 1, m: 1, mm: 1e-3, cm: 1e-2 };
const STRESSES = { "": 1, Pa: 1, kPa: 1e3, MPa: 1e6, GPa: 1e9 };

/** Direction of an axis. @param {Spot} vector @returns {Spot} */
const alongAxis = ([x, y]) => (Math.abs(x) >= Math.abs(y) ? [x, 0] : [0, y]);

/** @type {StructureTool[]} */
export const STRUCTURE_TOOLS = [
  { name: "select", key: "v", group: "", title: "Select", hint: ["drag a node, a corner or the tip of a load; click, Shift+click or drag a rectangle to select; Alt+drag or the middle button pans"], clicks: -1, make: () => null },
  { name: "bar", key: "b", group: "Parts", title: "Bars", hint: ["click the first node of pinned bars", "click the next node, or type 0.3 or 0.3<45; Escape ends the chain"], clicks: 2, chain: true, make: ([from, to], setting) => member(from, to, setting, "Truss") },
  { name: "beam", key: "e", group: "Parts", title: "Beams", hint: ["click the first node of rigidly joined beams", "click the next node, or type 0.3 or 0.3<45; Escape ends the chain"], clicks: 2, chain: true, make: ([from, to], setting) => member(from, to, setting, setting.beam) },
  { name: "plate", key: "p", group: "Parts", title: "Region", hint: ["click the corners of a region; Enter, or a click on the first, closes it"], clicks: 0, closed: true, make: (places, setting) => region(places, setting) },
  { name: "round", key: "h", group: "Parts", title: "Round hole", hint: ["click the centre of the hole", "click its rim, or type the radius"], clicks: 2, make: (places, setting) => hole(places, setting, true) },
  { name: "hole", key: "H", group: "Parts", title: "Hole", hint: ["click the corners of a hole; Enter, or a click on the first, closes it"], clicks: 0, closed: true, make: (places, setting) => hole(places, setting, false) },
  { name: "pin", key: "o", group: "Supports", title: "Pin", hint: [NODE], clicks: 1, target: true, make: (_, setting, target) => support(target, { ux: 0, uy: 0 }, setting, "pin") },
  { name: "roller", key: "r", group: "Supports", title: "Roller", hint: [NODE, "click in the direction in which it rolls; an inclined one needs a node"], clicks: 2, target: true, make: ([from, to], setting, target) => roller(from, to, setting, target) },
  { name: "clamp", key: "c", group: "Supports", title: "Clamp", hint: [NODE], clicks: 1, target: true, make: (_, setting, target) => support(target, {}, setting, "clamp") },
  { name: "displacement", key: "d", group: "Supports", title: "Displacement", hint: [NODE, "click in the direction of the prescribed displacement, along x or y, or type 2 mm"], clicks: 2, target: true, units: () => ({ size: SIZES.displacement, units: LENGTHS }), make: (_, setting, target, vector) => {
    const [x, y] = alongAxis(vector ?? [0, 0]);
    return support(target, x ? { ux: x } : { uy: y }, setting, "displacement");
  } },
  { name: "force", key: "f", group: "Loads", title: "Force", hint: ["click a node, an edge or a beam", "click in the direction of the load, or type 5 kN, 5 kN<-90 or 0, -5000"], clicks: 2, target: true, bars: true, units: (target) => (target?.kind === "edge" ? { size: SIZES.traction, units: STRESSES } : { size: target?.kind === "element" ? SIZES.line : SIZES.force, units: FORCES }), make: (_, setting, target, vector) => load(target, vector ?? [0, 0], setting) },
  { name: "torque", key: "q", group: "Loads", title: "Moment", hint: ["click a node of beams", "click the side to which it turns: left of the node is positive, or type 2 kNm"], clicks: 2, target: true, scalar: true, units: () => ({ size: SIZES.moment, units: MOMENTS }), make: (_, __, target, vector) => moment(target, vector?.[0] ?? SIZES.moment) },
  { name: "heat", key: "t", group: "Loads", title: "Temperature", hint: ["click a bar, a beam or a region", "click once more for a rise of 20 K, or type 40 or -30 K"], clicks: 2, target: true, parts: true, scalar: true, units: () => ({ size: SIZES.temperature, units: { "": 1, K: 1 } }), make: (_, setting, target, vector) => heat(target, vector?.[0] ?? SIZES.temperature, setting) },
];

/** Vector that is typed: `5 kN` in the direction of the pointer, `5 kN<-90`, or `0, -5 kN`. @param {string} text @param {Record<string, number>} units @param {Spot} toward @returns {Spot | null} */
export function typedVector(text, units, toward) {
  const value = (/** @type {string} */ part) => {
    const match = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([a-z]*)\s*$/i.exec(part), factor = match ? units[match[2]] : undefined;
    return match && factor !== undefined ? Number((Number(match[1]) * factor).toPrecision(12)) : null;
  };
  const pair = text.split(",");
  if (pair.length === 2) {
    const [x, y] = pair.map(value);
    return x === null || y === null ? null : [x, y];
  }
  const [size, angle, ...more] = text.split("<"), length = value(size), degrees = angle === undefined ? null : Number(angle.replace(/°|deg/, ""));
  if (length === null || more.length || (degrees !== null && !Number.isFinite(degrees))) return null;
  const turn = degrees === null ? Math.atan2(toward[1], toward[0]) : (degrees * Math.PI) / 180;
  return [length * round(Math.cos(turn)), length * round(Math.sin(turn))];
}

/** Cosines of right angles without round-off. @param {number} value */
const round = (value) => (Math.abs(value) < 1e-12 ? 0 : value);

/** Load of a magnitude in the direction of the pointer, in steps of 15° where it is near. @param {Place} from @param {Place} to @param {number} size @returns {Spot} */
export function drawnVector(from, to, size) {
  const angle = Math.atan2(to.y - from.y, to.x - from.x), step = Math.PI / 12, near = Math.round(angle / step) * step, turn = Math.abs(angle - near) < 0.06 ? near : angle;
  return [size * round(Math.cos(turn)), size * round(Math.sin(turn))];
}
