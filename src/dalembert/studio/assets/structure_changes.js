// Changes of the model file for structures that are drawn, see `studio/drawing_edits.py` and `studio/list_edits.py`.

/** @import { Change, Operation } from "./operations.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Plan, Spot, Target } from "./structure_plan.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { MATERIALS, memberFields, stockOf } from "./structure_stock.js";

/** Settings of the palette: quantities of new parts, and names of nodes that the file does not have yet.
 * @typedef {{ plan: Plan, document: Document, beam: string, cell: string, section: import("./structure_stock.js").Section, material: import("./structure_stock.js").Material, thickness: number | string, size: number | string | null, strain: boolean, claimed: Map<string, Spot> }} Setting */

/** Default force [N], moment [N m], force per length [N/m], traction [Pa], displacement [m], change of temperature [K]. */
export const SIZES = { force: 1000, moment: 1000, line: 1000, traction: 1e6, displacement: 1e-3, temperature: 20 };
/** Steps of the direction of a roller [rad], and the angle within which it snaps. */
const STEP = Math.PI / 12, NEAR = 0.06;
/** Length of the link of an inclined roller relative to the drawing, and its stiffness relative to that of a new bar of this length. */
const LINK = 0.08, STIFF = 1e6;
/** Triangles along the extent of a region. */
const DIVISIONS = 12;

/** @param {string} label @param {(Operation | null)[]} operations @returns {Change | null} */
const change = (label, operations) => (operations.length ? { label, operations: /** @type {Operation[]} */ (operations) } : null);

/** Name that nothing in the file has. @param {{ document: Document, claimed: Map<string, unknown> }} setting @param {string} base */
export function freeName({ document, claimed }, base) {
  const used = new Set([...claimed.keys(), ...["parameters", "derived", "nodes", "elements", "meshes"].flatMap((section) => Object.keys(document[section] ?? {}))]);
  for (let k = 1; ; k++) if (!used.has(`${base}${k}`)) return `${base}${k}`;
}

/** Node at a place, with the operations that add it; a bar there is divided. @param {Place} place @param {Setting} setting @returns {{ name: string, operations: Operation[] }} */
function nodeOf(place, setting) {
  const { plan, document, claimed } = setting, at = /** @type {Spot} */ ([neat(place.x), neat(place.y)]);
  const known = place.names.find((name) => plan.nodes.has(name)) ?? plan.nodeAt(at) ?? [...claimed].find(([, p]) => p[0] === at[0] && p[1] === at[1])?.[0];
  if (known) return { name: known, operations: [] };
  const name = freeName(setting, "n"), bar = place.body === null ? null : plan.bars.find((one) => one.name === place.body && one.connect.length === 2);
  claimed.set(name, at);
  const operations = [{ op: "add", section: "nodes", name, fields: at }];
  if (!bar) return { name, operations };
  const base = bar.name.replace(/\d+$/, "") || bar.name, fields = { ...document.elements?.[bar.name], connect: [name, bar.connect[1]] };
  return { name, operations: [...operations, { op: "set", keys: ["elements", bar.name, "connect", 1], value: name }, { op: "add", section: "elements", base, fields }] };
}

/** Bar or beam between two places. @param {Place} from @param {Place} to @param {Setting} setting @param {string} type @returns {Change | null} */
export function member(from, to, setting, type) {
  if (!(Math.hypot(to.x - from.x, to.y - from.y) > 0)) return null;
  const a = nodeOf(from, setting), b = nodeOf(to, setting);
  const has = (/** @type {string} */ name) => setting.plan.bars.some(({ connect }) => connect.length === 2 && connect.includes(name) && connect.includes(name === a.name ? b.name : a.name));
  if (a.name === b.name || has(a.name)) return null;
  const fields = { type, connect: [a.name, b.name], ...memberFields(type, setting.section, setting.material) };
  return change(type === "Truss" ? "add bar" : "add beam", [...a.operations, ...b.operations, { op: "add", section: "elements", base: type === "Truss" ? "bar" : "beam", fields }]);
}

/** @param {Place[]} corners */
const spotsOf = (corners) => corners.map(({ x, y }) => [neat(x), neat(y)]);

/** Region with a polygonal outline. @param {Place[]} corners @param {Setting} setting @returns {Change | null} */
export function region(corners, { cell, thickness, size, material, strain }) {
  if (corners.length < 3) return null;
  const [w, h] = [corners.map(({ x }) => x), corners.map(({ y }) => y)].map((values) => Math.max(...values) - Math.min(...values));
  const { modulus, poisson, density } = material, edge = size ?? Number((Math.min(Math.max(w, h) / DIVISIONS, Math.max(Math.min(w, h) / 3, Math.max(w, h) / 40))).toPrecision(2));
  const fields = { type: cell, polygon: { vertices: spotsOf(corners), size: edge }, thickness, ...(strain && { plane_strain: true }), modulus, poisson, density };
  return change("add region", [{ op: "add", section: "meshes", base: "plate", fields }]);
}

/** Hole in the region at its first place. @param {Place[]} places @param {Setting} setting @param {boolean} round @returns {Change | null} */
export function hole(places, { plan, document }, round) {
  const [center, rim] = places, owner = plan.regionAt([center.x, center.y]) ?? plan.regions.find(({ loops: [{ spots }] }) => spots.length && places.length > 2), radius = round ? Math.hypot(rim.x - center.x, rim.y - center.y) : 0;
  const polygon = owner && document.meshes?.[owner.name]?.polygon;
  if (!owner || !polygon || (round ? !(radius > 0) : places.length < 3)) return null;
  const made = round ? { center: [neat(center.x), neat(center.y)], radius: neat(radius) } : spotsOf(places), keys = ["meshes", owner.name, "polygon", "holes"];
  return change("add hole", [{ op: "append_item", keys, value: made }]);
}

/** What conditions act on. @typedef {{ kind: string, name: string, fields: Record<string, unknown> }} Acted */

// Supports and loads -----------------------------------------------------------------------------------

/** Names in a table of supports or loads. @param {any} entry @param {"nodes" | "elements"} key @returns {string[]} */
const namesIn = (entry, key) => [entry?.[key] ?? []].flat();

/** Whether a table acts on a target alone. @param {any} entry @param {Acted} target */
const isOn = (entry, { fields }) => JSON.stringify({ n: namesIn(entry, "nodes"), w: entry?.where, near: entry?.nearest, e: namesIn(entry, "elements") }) === JSON.stringify({ n: [fields.nodes ?? []].flat(), w: fields.where, near: fields.nearest, e: [fields.elements ?? []].flat() });

/** Operations that free a target from its supports in some directions. @param {Document} document @param {Acted} target @param {string[] | null} directions null for all @returns {Operation[]} */
export function freed(document, target, directions) {
  const entries = /** @type {any[]} */ (/** @type {unknown} */ (document.supports ?? []));
  return entries.flatMap((entry, index) => {
    const own = Object.keys(entry).filter((key) => /^[ur][xyz]$/.test(key)), hits = !directions || !own.length || own.some((key) => directions.includes(key));
    if (!hits) return [];
    /** @type {Operation[]} */
    const none = [{ op: "remove_entry", section: "supports", index }];
    if (isOn(entry, target)) return none;
    if (target.fields.nearest) return [];
    const names = namesIn(entry, "nodes"), rest = names.filter((name) => name !== target.fields.nodes);
    return rest.length < names.length && !entry.where && !entry.nearest ? [{ op: "set", keys: ["supports", index, "nodes"], value: rest.length > 1 ? rest : rest[0], written: true }] : [];
  }).reverse();
}

/** Support of a node or an edge; without directions all its displacements are zero. @param {Target | null} target @param {Record<string, number>} values @param {Setting} setting @param {string} label @returns {Change | null} */
export function support(target, values, { document }, label) {
  if (!target || target.kind === "element") return null;
  return change(`add ${label}`, [...freed(document, target, label === "displacement" ? Object.keys(values) : null), { op: "append", section: "supports", fields: { ...target.fields, ...values } }]);
}

/** Roller that rolls in any direction: along an axis a support, else a stiff link across it to a node that is held. @param {Place} from @param {Place} to @param {Setting} setting @param {Target | null} target @returns {Change | null} */
export function roller({ x, y }, to, setting, target) {
  const [u, v] = [to.x - x, to.y - y], angle = Math.atan2(v, u), straight = Math.round(angle / STEP) * STEP, turn = Math.abs(angle - straight) < NEAR ? straight : angle, way = [Math.cos(turn), Math.sin(turn)], { plan } = setting;
  const axis = way.findIndex((part) => Math.abs(part) > 1 - 1e-9);
  if (!(Math.hypot(u, v) > 0)) return null;
  if (axis >= 0 || target?.kind === "edge") return support(target, (axis >= 0 ? axis === 0 : Math.abs(u) >= Math.abs(v)) ? { uy: 0 } : { ux: 0 }, setting, "roller");
  const at = target && plan.nodes.get(target.name);
  if (!target || !at) return null;
  const sign = way[0] > 0 ? 1 : -1, size = Number((LINK * (plan.extent || 1)).toPrecision(2)), foot = /** @type {Spot} */ ([neat(at[0] + size * sign * way[1]), neat(at[1] - size * sign * way[0])]), name = freeName(setting, "foot"), { section, material } = setting;
  setting.claimed.set(name, foot);
  const stiffness = Number(((STIFF * section.area * material.modulus) / size).toPrecision(1));
  return change("add inclined roller", [...freed(setting.document, target, null), { op: "add", section: "nodes", name, fields: foot }, { op: "add", section: "elements", base: "link", fields: { type: "AxialSpring", connect: [target.name, name], stiffness } }, { op: "append", section: "supports", fields: { nodes: name } }]);
}

/** Change of temperature of an element or a region, with a coefficient of expansion where it has none. @param {Acted | null} target @param {number} temperature [K] @param {{ document: Document }} setting @returns {Change | null} */
export function heat(target, temperature, { document }) {
  const section = target && ["elements", "meshes"].find((one) => document[one]?.[target.name]), entry = section ? document[section]?.[target.name] : null;
  if (!target || !section || !entry || !("modulus" in entry)) return null;
  const expansion = (MATERIALS[stockOf(entry, "material")] ?? MATERIALS.Steel).expansion;
  return change("add change of temperature", [...("expansion" in entry ? [] : [{ op: "set", keys: [section, target.name, "expansion"], value: expansion }]), { op: "append", section: "temperatures", fields: { elements: target.name, temperature } }]);
}

/** Load: a force on a node, a traction on an edge, a force per length on a bar. @param {Target | null} target @param {Spot} vector of the force, traction or line load @param {Setting} setting @returns {Change | null} */
export function load(target, [x, y], { plan, document }) {
  if (!target) return null;
  const [u, v] = [neat(x), neat(y)];
  if (target.kind === "element") return change("add line load", [{ op: "append", section: "line_loads", fields: { ...target.fields, qx: u, qy: v } }]);
  const region = plan.regions.find(({ loops }) => loops.some(({ edges }) => edges.includes(target.name)));
  if (target.kind === "edge" && region) return change("add traction", [{ op: "append", section: "tractions", fields: { elements: region.name, ...target.fields, tx: u, ty: v } }]);
  return document && change("add force", [{ op: "append", section: "loads", fields: { ...target.fields, fx: u, fy: v } }]);
}

/** @param {Target | null} target @param {number} moment @returns {Change | null} */
export const moment = (target, moment) => (target?.kind === "node" ? change("add moment", [{ op: "append", section: "loads", fields: { ...target.fields, mz: moment } }]) : null);

/** Tables that act on a target. @param {Document} document @param {Acted} target @returns {{ section: string, index: number, entry: any }[]} */
export function conditionsOn(document, target) {
  return ["supports", "loads", "tractions", "line_loads", "temperatures"].flatMap((section) => /** @type {any[]} */ (/** @type {unknown} */ (document[section] ?? [])).flatMap((entry, index) => {
    const names = namesIn(entry, target.kind === "element" ? "elements" : "nodes"), own = target.kind === "element" ? target.name : target.fields.nodes, same = JSON.stringify(entry.where) === JSON.stringify(target.fields.where);
    return names.includes(String(own)) && same && !entry.nearest ? [{ section, index, entry }] : [];
  }));
}

/** Remove parts of the file with all that depends on them. @param {{ section: string, name: string }[]} parts @returns {Change | null} */
export const removed = (parts) => change(parts.length > 1 ? `delete ${parts.length} parts` : `delete ${parts[0]?.name}`, parts.map(({ section, name }) => ({ op: "remove", section, name, missing: true })));
