// Palette of structures: tools, and section, material, thickness and mesh size of new parts.

/** @import { Document } from "./types.d.ts" */

import { el } from "./dom.js";
import { icon } from "./icons.js";
import { numberOf } from "./space_numbers.js";
import { CELLS, MATERIALS, MEMBERS, SECTIONS } from "./structure_stock.js";
import { STRUCTURE_TOOLS } from "./structure_tools.js";

/** Settings that each tool uses. @type {Record<string, string[]>} */
const USES = { bar: ["section", "material"], beam: ["beam", "section", "material"], plate: ["material", "region"] };

export class StructurePalette {
  /** @param {HTMLElement} stage @param {(tool: string) => void} choose */
  constructor(stage, choose) {
    this.tools = STRUCTURE_TOOLS.map(({ name, title, key, hint }) => el("button", { type: "button", class: "button", "data-tool": name, "aria-pressed": String(name === "select"), title: hint.join("; then "), onclick: () => choose(name) }, icon(name), el("span", {}, title), el("kbd", {}, key === key.toUpperCase() ? `⇧${key}` : key.toUpperCase())));
    const options = (/** @type {string} */ id, /** @type {string} */ label, /** @type {Record<string, unknown>} */ table) => el("select", { id, "aria-label": label }, Object.keys(table).map((name) => el("option", { value: name }, name)));
    this.section = options("structure-section", "Cross-section of new bars and beams", SECTIONS);
    this.material = options("structure-material", "Material of new parts", MATERIALS);
    const input = (/** @type {string} */ id, /** @type {string} */ label, /** @type {string} */ value, /** @type {string} */ placeholder) => el("input", { type: "text", id, "aria-label": label, title: `${label}, such as 10 mm`, value, placeholder, size: "7", onchange: (event) => this.check(/** @type {HTMLInputElement} */ (event.target)) });
    this.thickness = input("structure-thickness", "Thickness of new regions", "10 mm", "10 mm");
    this.size = input("structure-size", "Length of the edges of triangles", "", "automatic");
    const kinds = (/** @type {string} */ id, /** @type {string} */ label, /** @type {Record<string, string>} */ titles, /** @type {string[]} */ names) => el("select", { id, "aria-label": label }, names.map((name) => el("option", { value: name }, titles[name].replace("Beam, ", ""))));
    this.beam = kinds("structure-beam", "Theory of new beams", MEMBERS, ["Frame", "TimoshenkoFrame"]);
    this.cell = kinds("structure-cell", "Elements of new regions", CELLS, ["Triangle6", "Triangle"]);
    this.strain = el("select", { id: "structure-state", "aria-label": "State of new regions" }, el("option", { value: "" }, "plane stress"), el("option", { value: "strain" }, "plane strain"));
    const row = (/** @type {string} */ use, /** @type {string} */ title, /** @type {Node} */ part) => el("label", { class: "setting", "data-use": use }, el("span", { class: "caption" }, title), part);
    const groups = [...new Set(STRUCTURE_TOOLS.map(({ group }) => group))].map((group) => el("div", { class: "tools", role: "group", "aria-label": group || "Selection" }, group && el("span", { class: "heading" }, group), this.tools.filter((_, k) => STRUCTURE_TOOLS[k].group === group)));
    this.node = el("div", { class: "palette space structure", id: "structure-palette", role: "toolbar", "aria-label": "Tools of structures", hidden: true }, groups, row("beam", "Theory", this.beam), row("section", "Section", this.section), row("material", "Material", this.material), row("region", "Elements", this.cell), row("region", "State", this.strain), row("region", "Thickness", this.thickness), row("region", "Mesh size", this.size));
    stage.append(this.node);
    this.show("select");
  }

  /** @param {HTMLInputElement} input */
  check(input) { input.setAttribute("aria-invalid", String(Boolean(input.value.trim()) && !(Number(lengthOf(input)) > 0))); }

  /** Quantities of new parts. */
  get settings() {
    return { beam: this.beam.value, cell: this.cell.value, section: SECTIONS[this.section.value], material: MATERIALS[this.material.value], strain: this.strain.value === "strain", thickness: lengthOf(this.thickness) ?? 0.01, size: lengthOf(this.size) };
  }

  /** Mark a tool, and show the settings that it uses. @param {string} tool */
  show(tool) {
    for (const node of this.tools) node.setAttribute("aria-pressed", String(node.dataset.tool === tool));
    for (const node of /** @type {NodeListOf<HTMLElement>} */ (this.node.querySelectorAll(".setting"))) node.hidden = !(USES[tool] ?? []).includes(node.dataset.use ?? "");
  }
}

/** Positive length in a field [m]; null for others. @param {HTMLInputElement} input */
function lengthOf({ value }) {
  const text = value.trim(), number = Number(text), length = text ? (Number.isFinite(number) ? number : numberOf(text, /** @type {Document} */ ({}))) : null;
  return length !== null && length > 0 ? Number(length.toPrecision(12)) : null;
}
