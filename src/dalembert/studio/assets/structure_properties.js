// Properties of selected parts of a structure: numbers, supports and loads, shared parameters.

/** @import { Completion } from "./completion.js" */
/** @import { Structure } from "./structure.js" */
/** @import { Target } from "./structure_plan.js" */
/** @import { Document } from "./types.d.ts" */

import { ask } from "./ask.js";
import { button, el } from "./dom.js";
import { Properties } from "./properties.js";
import { conditionsOn, removed } from "./structure_changes.js";
import { CELLS, MATERIALS, MEMBERS, PLANE_MEMBERS, SECTIONS, SPACE_MEMBERS, retyped, stockOf, stocked } from "./structure_stock.js";

/** Singular of a section. @type {Record<string, string>} */
const TITLES = { supports: "Support", loads: "Load", tractions: "Traction", line_loads: "Line load", temperatures: "Temperature" };
/** Units of the keys of loads and supports, by their first letter. @type {Record<string, string>} */
const UNITS = { u: "m", r: "rad", f: "N", m: "N m", t: "Pa", p: "Pa", q: "N/m" };
/** Units of quantities of elements. @type {Record<string, string>} */
const QUANTITIES = { area: "m^2", second_moment: "m^4", second_moment_y: "m^4", second_moment_z: "m^4", torsion_constant: "m^4", shear_area: "m^2", shear_area_y: "m^2", shear_area_z: "m^2", shear_modulus: "Pa", stiffness: "N/m", expansion: "1/K", temperature: "K", temperature_gradient: "K/m", thickness: "m", modulus: "Pa", poisson: "", density: "kg/m^3" };
/** Keys of numbers of elements that several can share. */
const SHARED = ["area", "second_moment", "thickness", "modulus", "density"];

export class StructureProperties extends Properties {
  /** @param {HTMLElement} parent @param {Structure} structure @param {() => Completion | null} completion */
  constructor(parent, structure, completion) {
    super(parent, /** @type {any} */ (structure), completion);
    this.structure = structure;
    this.shown = "";
  }

  /** Show the selection as it is in the file. @override */
  show() {
    const { document, plan, selection } = this.structure;
    if (!document || !plan || !selection.length) {
      this.node.hidden = true;
      this.shown = "";
      return;
    }
    const state = JSON.stringify([selection, document]);
    if (state === this.shown) return;
    this.shown = state;
    this.node.hidden = false;
    const [part] = selection, rows = selection.length > 1 ? this.group(document) : part.section === "points" || part.section === "edges" ? this.point(document, part.name) : this.part(document, part.section, part.name);
    this.node.replaceChildren(...rows.filter((row) => row instanceof Node));
  }

  /** A node, a corner or an edge, with what acts on it. @param {Document} document @param {string} name */
  point(document, name) {
    const { plan } = this.structure, handle = plan?.handles.find((one) => one.name === name), target = handle ? this.targetOf(name) : this.structure.target;
    const isNode = plan?.nodes.has(name) ?? false, keys = handle?.keys ?? [], value = keys.reduce((/** @type {any} */ entry, key) => entry?.[key], document);
    const row = (/** @type {(string | number)[]} */ path, /** @type {unknown} */ number, /** @type {string} */ label) => this.labelled(label, this.row(path, number, String(path[0]), String(path[1])));
    const places = Array.isArray(value) ? value.map((number, k) => row([...keys, k], number, "xyz"[k])) : value === undefined ? [] : [row(keys, value, "radius")];
    const title = isNode ? button(name, () => void this.rename(name), { class: "name", title: "Rename (F2)" }) : el("span", {}, name);
    return [el("h3", {}, title, el("span", { class: "type" }, isNode ? "Node" : handle ? "" : "Edge")), el("div", { class: "rows" }, places), ...(target ? this.conditions(document, target) : []),
      (isNode || /vertex/.test(name)) && el("div", { class: "chips" }, button("Delete", () => this.removeSelection(), { title: "Delete" }))];
  }

  /** A row with another name. @param {string} label @param {HTMLElement} row */
  labelled(label, row) {
    row.querySelector("span")?.replaceChildren(label);
    row.querySelector("input")?.setAttribute("aria-label", label);
    return row;
  }

  /** @param {string} name @returns {Target | null} */
  targetOf(name) {
    const { plan } = this.structure, at = plan?.handles.find((one) => one.name === name)?.at;
    return at && (plan?.nodes.has(name) || /\.vertex\d+$/.test(name)) ? { kind: "node", name, fields: { nodes: name }, spots: [at] } : null;
  }

  /** Supports and loads on a target. @param {Document} document @param {Target} target */
  conditions(document, target) {
    return conditionsOn(document, target).map(({ section, index, entry }) => {
      const names = [entry.nodes ?? entry.elements].flat(), keys = Object.keys(entry).filter((key) => /^([urfmtq][xyz]|pressure|temperature(_gradient(_[yz])?)?)$/.test(key));
      const rows = keys.map((key) => this.labelled(key, this.row([section, index, key], entry[key], section, String(index))));
      const note = !keys.length ? "all displacements are zero" : names.length > 1 ? `also of ${names.filter((name) => name !== target.name).slice(0, 3).join(", ")}` : entry.case ? `case ${entry.case}` : "";
      return el("fieldset", {}, el("legend", {}, TITLES[section], button("×", () => this.drawing.actions.change({ label: `delete ${TITLES[section].toLowerCase()}`, operations: [{ op: "remove_entry", section, index }] }), { class: "button small", title: `Delete the ${TITLES[section].toLowerCase()}`, "aria-label": `delete ${TITLES[section].toLowerCase()}` })), ...rows, note && el("p", { class: "muted" }, note));
    });
  }

  /** An element or a region. @param {Document} document @param {string} section @param {string} name */
  part(document, section, name) {
    const entry = document[section]?.[name] ?? {}, numbers = Object.entries(entry).filter(([key, value]) => key !== "type" && (typeof value === "number" || typeof value === "string"));
    const rows = numbers.map(([key, value]) => this.row([section, name, key], value, section, name)), missing = this.fields(section, name).filter(([key]) => !(key in entry)).map(([key]) => this.row([section, name, key], "", section, name));
    const size = entry.polygon && this.labelled("mesh size", this.row([section, name, "polygon", "size"], entry.polygon.size, section, name));
    const strain = section === "meshes" && el("label", { class: "check" }, el("input", { type: "checkbox", checked: entry.plane_strain === true, onchange: () => this.drawing.actions.change({ label: `set ${name}`, operations: [{ op: "set", keys: [section, name, "plane_strain"], value: entry.plane_strain !== true, written: true }] }) }), "plane strain");
    const target = /** @type {Target} */ ({ kind: "element", name, fields: { elements: name }, spots: [] });
    return [el("h3", {}, button(name, () => void this.rename(name), { class: "name", title: "Rename (F2)" }), el("span", { class: "type" }, String(entry.type ?? ""))), ...this.choices([{ keys: [section, name], entry }]), el("div", { class: "rows" }, rows, size), strain || null,
      missing.length ? el("details", {}, el("summary", {}, "More"), missing) : null, ...this.conditions(document, target), el("div", { class: "chips" }, button("Delete", () => this.removeSelection(), { title: "Delete" }))];
  }

  /** Choices of the type, the cross-section and the material of parts. @param {{ keys: string[], entry: Record<string, any> }[]} parts */
  choices(parts) {
    const same = (/** @type {string[]} */ values) => (new Set(values).size === 1 ? values[0] : ""), change = (/** @type {string} */ label, /** @type {import("./operations.js").Operation[]} */ operations) => this.drawing.actions.change({ label, operations });
    const row = (/** @type {string} */ title, /** @type {Record<string, string>} */ options, /** @type {string} */ value, /** @type {(name: string) => void} */ choose) => el("label", { class: "kind" }, el("span", {}, title), el("select", { "aria-label": title, onchange: (event) => choose(/** @type {HTMLSelectElement} */ (event.target).value) }, [...(value ? [] : [["", "other"]]), ...Object.entries(options)].map(([name, text]) => el("option", { value: name, selected: name === value }, text))));
    const every = (/** @type {string} */ key) => parts.length > 0 && parts.every(({ entry }) => key in entry), types = parts.map(({ entry }) => String(entry.type)), isMember = types.every((type) => type in MEMBERS), isCell = types.every((type) => type in CELLS);
    const members = this.structure.plan?.isPlanar === false ? SPACE_MEMBERS : PLANE_MEMBERS, cells = Object.keys(CELLS).filter((_, k) => k < 2 || parts.every(({ entry }) => entry.rectangle)), pick = (/** @type {string[]} */ names, /** @type {Record<string, string>} */ titles) => Object.fromEntries(names.map((name) => [name, titles[name]]));
    const stock = (/** @type {"section" | "material"} */ kind, /** @type {Record<string, unknown>} */ table) => row(kind === "section" ? "cross-section" : "material", Object.fromEntries(Object.keys(table).map((name) => [name, name])), same(parts.map(({ entry }) => stockOf(entry, kind))), (name) => name && change(`set ${kind}`, parts.flatMap(({ keys, entry }) => stocked(keys, entry, kind, name))));
    return [
      isMember ? row("element", pick(members, MEMBERS), same(types), (type) => change("set element type", parts.filter(({ entry }) => entry.type !== type).flatMap(({ keys, entry }) => retyped(keys, entry, type)))) : null,
      isCell ? row("elements", pick(cells, CELLS), same(types), (type) => change("set element type", parts.map(({ keys }) => ({ op: "set", keys: [...keys, "type"], value: type, written: true })))) : null,
      every("area") ? stock("section", SECTIONS) : null, every("modulus") ? stock("material", MATERIALS) : null,
    ].filter((node) => node !== null);
  }

  /** Several parts: numbers that they share, which one parameter can give. @param {Document} document */
  group(document) {
    const parts = this.structure.selection.filter(({ section }) => section === "elements" || section === "meshes");
    const entries = parts.map(({ section, name }) => ({ keys: [section, name], entry: document[section]?.[name] ?? {} })), keys = SHARED.filter((key) => entries.length && entries.every(({ entry }) => key in entry));
    const rows = keys.map((key) => {
      const values = [...new Set(entries.map(({ entry }) => entry[key]))], same = values.length === 1, all = (/** @type {unknown} */ value) => entries.map(({ keys: path }) => ({ op: "set", keys: [...path, key], value, written: true }));
      const input = el("input", { type: "text", value: same ? String(values[0]) : "", placeholder: same ? "" : "several", "aria-label": key, spellcheck: "false", autocomplete: "off" });
      input.addEventListener("change", () => {
        const text = input.value.trim(), number = Number(text);
        if (text) this.drawing.actions.change({ label: `set ${key} of ${entries.length} parts`, operations: all(Number.isFinite(number) ? number : text) });
      });
      const number = Number(values.find((value) => typeof value === "number") ?? NaN), share = button("p", () => {
        const operations = [{ op: "add", section: "parameters", base: key, as: "$shared", fields: { value: number, unit: this.unit(parts[0].section, parts[0].name, [key]), bounds: [Number((0.1 * number).toPrecision(3)), Number((10 * number).toPrecision(3))] } }, ...all("$shared")];
        this.drawing.actions.change({ label: `${key} of ${entries.length} parts as a parameter`, operations });
      }, { class: "make", title: "One parameter with a slider for all", "aria-label": `make ${key} a parameter`, disabled: values.some((value) => typeof value !== "number") });
      return el("label", { class: "number" }, el("span", {}, key), input, el("span", { class: "unit" }, this.unit(parts[0].section, parts[0].name, [key])), share);
    });
    return [el("h3", {}, `${this.structure.selection.length} parts`), ...this.choices(entries), el("div", { class: "rows" }, rows), el("div", { class: "chips" }, button("Delete", () => this.removeSelection(), { title: "Delete" }))];
  }

  /** @override @param {string} section @param {string} name @param {(string | number)[]} keys */
  unit(section, name, keys) {
    const known = QUANTITIES[String(keys[0])];
    if (known !== undefined) return known;
    if (section in TITLES) return UNITS[String(keys[0])[0]] ?? "";
    return section === "nodes" || keys[0] === "polygon" ? "m" : super.unit(section, name, keys);
  }

  /** @override @param {string} name */
  async rename(name) {
    const { document } = this.structure, section = ["nodes", "elements", "meshes"].find((one) => document?.[one]?.[name] !== undefined);
    const reply = section && (await ask(`Rename ${name}`, "References and formulas get the new name.", { rename: "Rename" }, { name: "Name", value: name })), to = reply ? reply.value.trim() : "";
    if (!section || !to || to === name) return;
    this.structure.select([]);
    this.drawing.actions.change({ label: `rename ${name}`, operations: [{ op: "rename", section, name, to }] });
  }

  removeSelection() {
    const { structure } = this, { document, selection, plan } = structure;
    const parts = selection.flatMap(({ section, name }) => (section === "points" ? (plan?.nodes.has(name) ? [{ section: "nodes", name }] : []) : section === "edges" ? [] : [{ section, name }]));
    const corner = selection.length === 1 && !parts.length ? plan?.handles.find(({ name, kind }) => name === selection[0].name && kind === "vertex") : null;
    const list = corner && corner.keys.slice(0, -1).reduce((/** @type {any} */ entry, key) => entry?.[key], document), last = corner?.keys.at(-1);
    structure.select([]);
    if (parts.length) return this.drawing.actions.change(/** @type {import("./operations.js").Change} */ (removed(parts)));
    if (!corner || !document) return;
    const holes = corner.keys.slice(0, 4), hole = corner.keys[3] === "holes" ? Number(corner.keys[4]) : -1;
    if (Array.isArray(list) && typeof last === "number" && list.length > 3) this.drawing.actions.change({ label: `delete ${corner.name}`, operations: [{ op: "remove_item", keys: corner.keys }] });
    else if (hole >= 0) this.drawing.actions.change({ label: "delete hole", operations: [{ op: "remove_item", keys: [...holes, hole] }] });
    else this.drawing.actions.refuse("a region has at least three corners; delete the region");
  }
}
