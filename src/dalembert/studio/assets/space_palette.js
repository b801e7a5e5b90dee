// Palette of spatial models: tools, working plane, kind and axis of joints.

/** @import { Vec } from "./space_math.js" */

import { el } from "./dom.js";
import { PlaneChoice } from "./plane_choice.js";
import { AXES, size } from "./space_math.js";
import { JOINT_KINDS } from "./space_shapes.js";
import { SPACE_TOOLS } from "./space_tools.js";

export class SpacePalette {
  /** @param {HTMLElement} stage @param {{ choose: (tool: string) => void, change: () => void, through: () => Vec | null }} actions */
  constructor(stage, actions) {
    this.actions = actions;
    /** Axis of joints; null for that of the face or the plane. @type {Vec | null} */
    this.axis = null;
    this.kind = JOINT_KINDS[0];
    this.tools = SPACE_TOOLS.map(({ name, title, key, hint }) =>
      el("button", { type: "button", class: "button", "data-tool": name, "aria-pressed": String(name === "select"), title: hint.join("; then "), onclick: () => actions.choose(name) }, title, el("kbd", {}, key.toUpperCase())));
    this.choice = new PlaneChoice("plane", actions);
    const kinds = el("select", { id: "joint-kind", "aria-label": "Kind of joint", onchange: () => { this.kind = kinds.value; actions.choose("joint"); } }, JOINT_KINDS.map((kind) => el("option", { value: kind }, kind)));
    const direction = el("input", { type: "text", id: "joint-direction", "aria-label": "Direction of the axis: x, y, z", placeholder: "0, 0, 1", size: "8", hidden: true, onchange: () => this.readAxis(axis.value, direction.value) });
    const axis = el("select", { id: "joint-axis", "aria-label": "Axis of joints and torques", title: "Axis of joints and torques; that of the face below the pointer, or of the working plane, by default", onchange: () => { direction.hidden = axis.value !== "typed"; this.readAxis(axis.value, direction.value); } },
      ["face", ...Object.keys(AXES), "typed"].map((name) => el("option", { value: name }, { face: "face", typed: "typed" }[name] ?? name)));
    const row = (/** @type {string} */ use, /** @type {string} */ title, /** @type {(Node | string)[]} */ ...parts) => el("div", { class: "setting", "data-use": use }, el("span", { class: "caption" }, title), parts);
    this.node = el("div", { class: "palette space", id: "space-palette", role: "toolbar", "aria-label": "Tools of spatial models", hidden: true },
      this.tools, row("kind", "Joint", kinds), row("axis", "Axis", axis, direction), row("plane", "Plane", ...this.choice.planes), row("plane", "", this.choice.label, this.choice.offset, this.choice.through));
    stage.append(this.node);
    this.show("select");
  }

  /** @param {string} kind @param {string} typed */
  readAxis(kind, typed) {
    const values = typed.split(/[\s,;]+/).filter(Boolean).map(Number), valid = values.length === 3 && values.every(Number.isFinite) && size(values) > 0;
    this.axis = kind === "typed" ? (valid ? values : null) : AXES[kind] ?? null;
    this.actions.change();
  }

  get plane() { return this.choice.plane; }

  throughSelected() { this.choice.throughSelected(); }

  /** Mark a tool, and show the settings that it uses. @param {string} tool */
  show(tool) {
    for (const node of this.tools) node.setAttribute("aria-pressed", String(node.dataset.tool === tool));
    const uses = { select: [], joint: ["kind", "axis"], torque: ["axis"], motor: [] }[tool] ?? ["plane"];
    for (const node of /** @type {NodeListOf<HTMLElement>} */ (this.node.querySelectorAll(".setting"))) node.hidden = !uses.includes(node.dataset.use ?? "");
  }
}
