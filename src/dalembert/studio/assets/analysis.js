// Sheet "Analysis": what the picture shows, its times and drivers, and what prevents it.

/** @import { FieldKind } from "./field_values.js" */
/** @import { Document, PictureMessage, Problem } from "./types.d.ts" */

import { button, el } from "./dom.js";
import { accept } from "./field_values.js";

/** A key of an analysis: its label and the kind of its value. @typedef {{ key: string, label: string, unit?: string, empty?: string } & FieldKind} Field */
/** A type of analysis. @typedef {{ type: string, title: string, note: string, fields: Field[] }} Kind */

const DURATION = { key: "duration", label: "Duration", unit: "s" }, OUTPUTS = { key: "outputs", label: "Instants", whole: true }, COUNT = { key: "count", label: "Modes", whole: true };
const STEP = { key: "step", label: "Step", unit: "s" }, INTEGRATOR = { key: "integrator", label: "Integrator", text: true };

/** @type {Record<"mechanism" | "structure", Kind[]>} */
const KINDS = {
  mechanism: [
    { type: "Equilibrium", title: "Equilibrium", note: "The position at which all forces balance.", fields: [] },
    { type: "Modal", title: "Modes", note: "Natural frequencies and modes of the linearised equations.", fields: [COUNT] },
    { type: "Kinematics", title: "Kinematics", note: "The motion that drivers prescribe, without masses and forces.", fields: [DURATION, OUTPUTS] },
    { type: "Dynamics", title: "Dynamics", note: "The motion under forces from the initial position and velocity.", fields: [DURATION, STEP, OUTPUTS, INTEGRATOR] },
    { type: "Nonsmooth", title: "Nonsmooth", note: "The motion with impacts and dry friction of contacts, by time stepping: all contacts of a step are solved together.", fields: [DURATION, STEP, OUTPUTS, INTEGRATOR] },
    { type: "InverseDynamics", title: "Inverse dynamics", note: "The efforts of drivers and the reactions of a prescribed motion.", fields: [DURATION, OUTPUTS] },
  ],
  structure: [
    { type: "Statics", title: "Statics", note: "Linear displacements and forces under the load cases.", fields: [] },
    { type: "Equilibrium", title: "Equilibrium", note: "Large displacements, in load steps.", fields: [{ key: "steps", label: "Load steps", whole: true }] },
    { type: "Modal", title: "Modes", note: "Natural frequencies and modes.", fields: [COUNT] },
    { type: "Buckling", title: "Buckling", note: "Critical load factors and buckling modes.", fields: [COUNT] },
    { type: "Dynamics", title: "Dynamics", note: "The motion under loads over time.", fields: [DURATION, STEP, OUTPUTS] },
  ],
};

/** Number field; `act` receives its value, null for an empty one that is not required. @param {Field} field @param {unknown} value @param {(value: unknown) => void} act */
export function numberField({ key, label, unit = "", empty = "default", ...kind }, value, act) {
  const former = value === undefined || typeof value === "object" ? "" : String(value);
  const input = el("input", { type: "text", name: key, value: former, inputmode: kind.whole ? "numeric" : "text", spellcheck: "false", autocomplete: "off", placeholder: empty, onchange: () => accept(input, kind, former, act) });
  return el("label", { class: "field" }, el("span", {}, label, unit && el("small", {}, ` [${unit}]`)), input);
}

export class AnalysisSheet {
  /** @param {{ request: (kind: string, more?: Record<string, unknown>) => void, edit: (label: string, operations: Record<string, unknown>[]) => void, draw: (tool: string) => void }} actions @param {HTMLElement[]} below further parts of the sheet */
  constructor(actions, below) {
    this.actions = actions;
    /** Keys that are shown without being written; null for those of the text. @type {Record<string, unknown> | null} */
    this.fields = null;
    /** @type {Document | null} */
    this.document = null;
    /** @type {Problem[]} */
    this.problems = [];
    /** Freedoms that no driver prescribes. */
    this.free = /** @type {number | null} */ (null);
    this.tabs = el("div", { class: "picks", role: "tablist", "aria-label": "Analysis of the picture" });
    this.form = el("div", { class: "form" });
    this.node = el("section", { class: "sheet analysis" }, this.tabs, this.form, ...below);
  }

  /** Contents of a valid text. @param {Document | null} document */
  show(document) {
    if (!document || JSON.stringify(document) === JSON.stringify(this.document)) return;
    this.document = document;
    this.render();
  }

  /** Keys of the preview. @param {{ fields: Record<string, unknown> | null }} message */
  receive({ fields }) {
    this.fields = fields;
    this.render();
  }

  /** What the picture shows, and what prevents it. @param {PictureMessage} message */
  describe({ live, problems, facts }) {
    if (live) return;
    this.problems = (problems ?? []).filter(({ level }) => level === "error");
    this.free = facts?.free ?? null;
    this.render();
  }

  /** Keys of the shown analysis. @returns {Record<string, unknown>} */
  get shown() {
    const own = this.document?.analysis ?? {};
    return this.fields ? Object.fromEntries(Object.entries({ ...own, ...this.fields }).filter(([, value]) => value !== null)) : own;
  }

  get kinds() { return KINDS[/** @type {unknown} */ (this.document?.kind) === "structure" ? "structure" : "mechanism"]; }

  /** @param {string | null} type @param {Record<string, unknown>} [fields] */
  preview(type, fields = {}) { this.actions.request("preview", type === null ? {} : { type, fields }); }

  render() {
    const { shown, kinds, fields, document } = this, type = String(shown.type ?? ""), kind = kinds.find((item) => item.type === type);
    const focused = /** @type {HTMLInputElement | null} */ (this.form.querySelector(":focus"))?.name;
    this.tabs.replaceChildren(...kinds.map(({ type: name, title, note }) => button(title, () => (name === document?.analysis?.type ? this.preview(null) : this.preview(name)), { role: "tab", class: "pick", "aria-selected": String(name === type), title: note })));
    /** @param {Record<string, unknown>} changed */
    const change = (changed) => this.preview(type, { ...Object.fromEntries(Object.entries(fields ?? {}).filter(([key]) => key !== "type" && kind?.fields.some((field) => field.key === key))), ...changed });
    this.form.replaceChildren(
      el("p", { class: "muted" }, kind?.note ?? (type ? `${type}: its keys are edited in the text.` : kinds === KINDS.structure ? "The file states no analysis: the picture shows the linear displacements under the loads." : "The file states no analysis: the picture shows 3 s of motion, by drivers if they determine it, by time stepping with contacts of several shapes, else by dynamics.")),
      !kind ? "" : el("div", { class: "fields" }, kind.fields.map((field) => numberField(field, shown[field.key], (value) => change({ [field.key]: value })))),
      this.driverFields(), this.problemList(),
      fields ? el("div", { class: "chips" }, button("Write into the text", () => this.actions.request("write_preview"), { class: "button primary", title: "Replace [analysis] of the file" }), button("Back to the text", () => this.preview(null))) : "",
    );
    if (focused) /** @type {HTMLElement | null} */ (this.form.querySelector(`[name="${CSS.escape(focused)}"]`))?.focus();
  }

  /** Laws of the drivers, which are written into the text. */
  driverFields() {
    const drivers = Object.entries(this.document?.drivers ?? {}).filter(([, driver]) => typeof driver?.law === "string" || typeof driver?.law === "number");
    if (!drivers.length || this.kinds !== KINDS.mechanism) return "";
    return el("fieldset", {}, el("legend", {}, "Drivers"), drivers.map(([name, { law }]) =>
      numberField({ key: `law-${name}`, label: name, text: true, required: "A driver needs a law; its former one is kept" }, law, (value) => this.actions.edit(`set ${name}`, [{ op: "set", keys: ["drivers", name, "law"], value, written: true }]))));
  }

  /** Errors of the picture, with remedies. */
  problemList() {
    const { problems, free, shown } = this;
    if (shown.type === "Modal" && free === 0) return el("p", { class: "obstacle", role: "status" }, "No degree of freedom is free, so that there are no modes; remove a driver or a joint.");
    if (!problems.length) return "";
    const driven = shown.type === "Kinematics" || shown.type === "InverseDynamics";
    return el("div", { class: "obstacle", role: "status" }, el("strong", {}, "The picture shows the drawn position."), problems.map(({ message }) => el("p", {}, message)),
      driven && free !== null && free > 0 && el("div", { class: "chips" }, button("Draw a motor", () => this.actions.draw("motor")), button("Show the dynamics", () => this.preview("Dynamics"))));
  }
}
