// Palette of structures: tools, and section, material, thickness and mesh size of new parts.

/** @import { Document } from "./types.d.ts" */

import { el } from "./dom.js";
import { icon } from "./icons.js";
import { numberOf } from "./space_numbers.js";
import { STRUCTURE_TOOLS } from "./structure_tools.js";

/** Properties of rectangular, circular and tubular cross-sections [m]. */
const rectangle = (/** @type {number} */ b, /** @type {number} */ h) => ({ area: b * h, second_moment: (b * h ** 3) / 12 });
const tube = (/** @type {number} */ d, /** @type {number} */ t) => ({ area: (Math.PI / 4) * (d ** 2 - (d - 2 * t) ** 2), second_moment: (Math.PI / 64) * (d ** 4 - (d - 2 * t) ** 4) });
/** Cross-sections; those of IPE are nominal values of EN 10365. @type {Record<string, { area: number, second_moment: number }>} */
export const SECTIONS = { "Tube 60 × 3": tube(0.06, 0.003), "Tube 100 × 5": tube(0.1, 0.005), "Round 20": tube(0.02, 0.01), "Square 50": rectangle(0.05, 0.05), "Timber 100 × 200": rectangle(0.1, 0.2), "IPE 100": { area: 10.3e-4, second_moment: 171e-8 }, "IPE 200": { area: 28.5e-4, second_moment: 1943e-8 } };
/** @type {Record<string, { modulus: number, poisson: number, density: number }>} */
export const MATERIALS = { Steel: { modulus: 210e9, poisson: 0.3, density: 7850 }, Aluminium: { modulus: 70e9, poisson: 0.33, density: 2700 }, Titanium: { modulus: 110e9, poisson: 0.34, density: 4430 }, Timber: { modulus: 11e9, poisson: 0.3, density: 450 }, Concrete: { modulus: 30e9, poisson: 0.2, density: 2400 } };
/** Settings that each tool uses. @type {Record<string, string[]>} */
const USES = { bar: ["section", "material"], beam: ["section", "material"], plate: ["material", "region"] };

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
    this.strain = el("select", { id: "structure-state", "aria-label": "State of new regions" }, el("option", { value: "" }, "plane stress"), el("option", { value: "strain" }, "plane strain"));
    const row = (/** @type {string} */ use, /** @type {string} */ title, /** @type {Node} */ part) => el("label", { class: "setting", "data-use": use }, el("span", { class: "caption" }, title), part);
    const groups = [...new Set(STRUCTURE_TOOLS.map(({ group }) => group))].map((group) => el("div", { class: "tools", role: "group", "aria-label": group || "Selection" }, group && el("span", { class: "heading" }, group), this.tools.filter((_, k) => STRUCTURE_TOOLS[k].group === group)));
    this.node = el("div", { class: "palette space structure", id: "structure-palette", role: "toolbar", "aria-label": "Tools of structures", hidden: true }, groups, row("section", "Section", this.section), row("material", "Material", this.material), row("region", "State", this.strain), row("region", "Thickness", this.thickness), row("region", "Mesh size", this.size));
    stage.append(this.node);
    this.show("select");
  }

  /** @param {HTMLInputElement} input */
  check(input) { input.setAttribute("aria-invalid", String(Boolean(input.value.trim()) && !(Number(lengthOf(input)) > 0))); }

  /** Quantities of new parts. */
  get settings() {
    return { section: SECTIONS[this.section.value], material: MATERIALS[this.material.value], strain: this.strain.value === "strain", thickness: lengthOf(this.thickness) ?? 0.01, size: lengthOf(this.size) };
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
