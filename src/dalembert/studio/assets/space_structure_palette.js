// Palette of spatial structures: tools, working plane, theory, cross-section and material of new members.

/** @import { Vec } from "./space_math.js" */

import { el } from "./dom.js";
import { icon } from "./icons.js";
import { PlaneChoice } from "./plane_choice.js";
import { SPACE_STRUCTURE_TOOLS } from "./space_structure_tools.js";
import { MATERIALS, SECTIONS } from "./structure_stock.js";

/** Settings that each tool uses. @type {Record<string, string[]>} */
const USES = { select: [], bar: ["section", "plane"], beam: ["beam", "section", "plane"], pin: [], clamp: [], heat: [] };

export class SpaceStructurePalette {
  /** @param {HTMLElement} stage @param {{ choose: (tool: string) => void, change: () => void, through: () => Vec | null }} actions */
  constructor(stage, actions) {
    this.tools = SPACE_STRUCTURE_TOOLS.map(({ name, title, key, hint }) => el("button", { type: "button", class: "button", "data-tool": name, "aria-pressed": String(name === "select"), title: hint.join("; then "), onclick: () => actions.choose(name) }, icon(name), el("span", {}, title), el("kbd", {}, key.toUpperCase())));
    const options = (/** @type {string} */ id, /** @type {string} */ label, /** @type {string[][]} */ rows) => el("select", { id, "aria-label": label }, rows.map(([value, text]) => el("option", { value }, text)));
    const names = (/** @type {Record<string, unknown>} */ table) => Object.keys(table).map((name) => [name, name]);
    this.beam = options("space-beam", "Theory of new beams", [["SpaceFrame", "Euler–Bernoulli"], ["TimoshenkoSpaceFrame", "Timoshenko"]]);
    this.section = options("space-section", "Cross-section of new bars and beams", names(SECTIONS));
    this.material = options("space-material", "Material of new parts", names(MATERIALS));
    this.choice = new PlaneChoice("structure", actions);
    const row = (/** @type {string} */ use, /** @type {string} */ title, /** @type {(Node | string)[]} */ ...parts) => el("div", { class: "setting", "data-use": use }, el("span", { class: "caption" }, title), parts);
    const groups = [...new Set(SPACE_STRUCTURE_TOOLS.map(({ group }) => group))].map((group) => el("div", { class: "tools", role: "group", "aria-label": group || "Selection" }, group && el("span", { class: "heading" }, group), this.tools.filter((_, k) => SPACE_STRUCTURE_TOOLS[k].group === group)));
    this.node = el("div", { class: "palette space structure", id: "space-structure-palette", role: "toolbar", "aria-label": "Tools of spatial structures", hidden: true },
      groups, row("beam", "Theory", this.beam), row("section", "Section", this.section), row("section", "Material", this.material), row("plane", "Plane", ...this.choice.planes), row("plane", "", this.choice.label, this.choice.offset, this.choice.through));
    stage.append(this.node);
    this.show("select");
  }

  get plane() { return this.choice.plane; }

  /** Quantities of new parts. */
  get settings() { return { beam: this.beam.value, section: SECTIONS[this.section.value], material: MATERIALS[this.material.value] }; }

  /** Mark a tool, and show the settings that it uses. @param {string} tool */
  show(tool) {
    for (const node of this.tools) node.setAttribute("aria-pressed", String(node.dataset.tool === tool));
    for (const node of /** @type {NodeListOf<HTMLElement>} */ (this.node.querySelectorAll(".setting"))) node.hidden = !(USES[tool] ?? ["plane"]).includes(node.dataset.use ?? "");
  }
}
