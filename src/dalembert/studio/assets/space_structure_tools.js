// Tools of the palette of spatial structures, and the changes that they make.

/** @import { Change, Operation } from "./operations.js" */
/** @import { SpacePlace, WorkingPlane } from "./space_places.js" */
/** @import { SpacePlan, SpaceTarget } from "./space_plan.js" */
/** @import { Vec } from "./space_math.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { SIZES, freed, freeName, heat } from "./structure_changes.js";
import { memberFields } from "./structure_stock.js";

/** @typedef {{ plan: SpacePlan, document: Document, plane: WorkingPlane, beam: string, section: import("./structure_stock.js").Section, material: import("./structure_stock.js").Material, claimed: Map<string, Vec> }} SpaceSetting */
/** A tool: a `chain` of members goes on from its last place; with a `target` the first click is on a node or a member. A `vector` is drawn or typed from there, a `scalar` is typed.
 * @typedef {{ name: string, key: string, group: string, title: string, hint: string[], clicks: number, chain?: boolean, target?: "nodes" | "bars" | "both", scalar?: boolean, units?: (target: SpaceTarget | null) => { size: number, units: Record<string, number> }, make: (places: SpacePlace[], setting: SpaceSetting, target: SpaceTarget | null, vector: Vec) => Change | null }} SpaceStructureTool */

const FORCES = { "": 1, N: 1, kN: 1e3, MN: 1e6 }, MOMENTS = { "": 1, Nm: 1, kNm: 1e3 }, LENGTHS = { "": 1, m: 1, mm: 1e-3, cm: 1e-2 };

/** @param {string} label @param {Operation[]} operations @returns {Change} */
const change = (label, operations) => ({ label, operations });

/** Node at a place, with the operations that add it. @param {SpacePlace} place @param {SpaceSetting} setting */
function nodeOf({ p, names }, setting) {
  const { plan, claimed } = setting, at = p.map(neat), known = names.find((name) => plan.nodes.has(name)) ?? plan.nodeAt(at) ?? [...claimed].find(([, q]) => q.every((v, k) => v === at[k]))?.[0];
  if (known) return { name: known, operations: [] };
  const name = freeName(setting, "n");
  claimed.set(name, at);
  return { name, operations: [{ op: "add", section: "nodes", name, fields: at }] };
}

/** @param {SpacePlace[]} places @param {SpaceSetting} setting @param {string} type @returns {Change | null} */
function member([from, to], setting, type) {
  if (!(Math.hypot(...to.p.map((v, k) => v - from.p[k])) > 0)) return null;
  const a = nodeOf(from, setting), b = nodeOf(to, setting);
  if (a.name === b.name || setting.plan.bars.some(({ connect }) => connect.length === 2 && connect.includes(a.name) && connect.includes(b.name))) return null;
  const fields = { type, connect: [a.name, b.name], ...memberFields(type, setting.section, setting.material) };
  return change(type === "Truss" ? "add bar" : "add beam", [...a.operations, ...b.operations, { op: "add", section: "elements", base: type === "Truss" ? "bar" : "beam", fields }]);
}

/** @param {SpaceTarget | null} target @param {Record<string, number>} values @param {SpaceSetting} setting @param {string} label @returns {Change | null} */
function support(target, values, { document }, label) {
  if (target?.kind !== "node") return null;
  return change(`add ${label}`, [...freed(document, target, label === "displacement" ? Object.keys(values) : null), { op: "append", section: "supports", fields: { ...target.fields, ...values } }]);
}

/** Components that are not zero, by their keys. @param {string} prefix @param {Vec} vector */
const components = (prefix, vector) => Object.fromEntries(vector.flatMap((v, k) => (v ? [[`${prefix}${"xyz"[k]}`, Number(v.toPrecision(6))]] : [])));

/** @param {SpaceTarget | null} target @param {Vec} vector @returns {Change | null} */
function load(target, vector) {
  if (!target || !vector.some(Boolean)) return null;
  if (target.kind === "element") return change("add line load", [{ op: "append", section: "line_loads", fields: { ...target.fields, ...components("q", vector) } }]);
  return change("add force", [{ op: "append", section: "loads", fields: { ...target.fields, ...components("f", vector) } }]);
}

const NODE = "click a node";

/** @type {SpaceStructureTool[]} */
export const SPACE_STRUCTURE_TOOLS = [
  { name: "select", key: "v", group: "", title: "Select", hint: ["click a node, whose arrows move it, or a member; Shift+click selects several; Delete removes them"], clicks: -1, make: () => null },
  { name: "bar", key: "b", group: "Parts", title: "Bars", hint: ["click the first node of pinned bars", "click the next node; Shift moves along the normal of the plane; type 0, 0, 2 or a length along the normal; Escape ends the chain"], clicks: 2, chain: true, make: (places, setting) => member(places, setting, "Truss") },
  { name: "beam", key: "e", group: "Parts", title: "Beams", hint: ["click the first node of rigidly joined beams", "click the next node; Shift moves along the normal of the plane; type 0, 0, 2 or a length along the normal; Escape ends the chain"], clicks: 2, chain: true, make: (places, setting) => member(places, setting, setting.beam) },
  { name: "pin", key: "o", group: "Supports", title: "Ball joint", hint: [NODE], clicks: 1, target: "nodes", make: (_, setting, target) => support(target, { ux: 0, uy: 0, uz: 0 }, setting, "ball joint") },
  { name: "roller", key: "r", group: "Supports", title: "Roller", hint: ["click a node, which stays in a plane parallel to the working plane"], clicks: 1, target: "nodes", make: (_, setting, target) => support(target, { [`u${setting.plane.axis}`]: 0 }, setting, "roller") },
  { name: "clamp", key: "c", group: "Supports", title: "Clamp", hint: [NODE], clicks: 1, target: "nodes", make: (_, setting, target) => support(target, {}, setting, "clamp") },
  { name: "displacement", key: "d", group: "Supports", title: "Displacement", hint: [NODE, "type the displacement along the normal of the working plane, such as 2 mm, and Enter; a click takes 1 mm"], clicks: 2, target: "nodes", scalar: true, units: () => ({ size: SIZES.displacement, units: LENGTHS }), make: (_, setting, target, [, , v]) => support(target, { [`u${setting.plane.axis}`]: v }, setting, "displacement") },
  { name: "force", key: "f", group: "Loads", title: "Force", hint: ["click a node or a member", "click in the direction of the load, with Shift along the normal of the plane; or type 5 kN or 0, 0, -5 kN"], clicks: 2, target: "both", units: (target) => ({ size: target?.kind === "element" ? SIZES.line : SIZES.force, units: FORCES }), make: (_, __, target, vector) => load(target, vector) },
  { name: "torque", key: "q", group: "Loads", title: "Moment", hint: [NODE, "type the moment about the normal of the working plane, such as 2 kNm, and Enter; a click takes 1 kNm"], clicks: 2, target: "nodes", scalar: true, units: () => ({ size: SIZES.moment, units: MOMENTS }), make: (_, setting, target, [, , v]) => (target ? change("add moment", [{ op: "append", section: "loads", fields: { ...target.fields, [`m${setting.plane.axis}`]: v } }]) : null) },
  { name: "heat", key: "t", group: "Loads", title: "Temperature", hint: ["click a bar or a beam", "type the change, such as 40 or -30 K, and Enter; a click takes 20 K"], clicks: 2, target: "bars", scalar: true, units: () => ({ size: SIZES.temperature, units: { "": 1, K: 1 } }), make: (_, setting, target, [, , v]) => heat(target, v, setting) },
];

/** Vector that is typed: `5 kN` in a direction, or `0, 0, -5 kN`; null if it is none. @param {string} text @param {Record<string, number>} units @param {Vec} way unit vector @returns {Vec | null} */
export function typedForce(text, units, way) {
  const values = text.split(",").map((part) => {
    const match = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([a-z]*)\s*$/i.exec(part), factor = match ? units[match[2]] : undefined;
    return match && factor !== undefined ? Number((Number(match[1]) * factor).toPrecision(12)) : NaN;
  });
  if (!values.every(Number.isFinite)) return null;
  return values.length === 3 ? values : values.length === 1 ? way.map((v) => v * values[0]) : null;
}
