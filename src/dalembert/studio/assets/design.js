// Sheet "Design": tasks of the file as forms, run in a process of their own.

/** @import { Document, TaskMessage } from "./types.d.ts" */

import { numberField } from "./analysis.js";
import { button, el } from "./dom.js";
import { Measurements } from "./measurements.js";
import { inWords } from "./responses.js";
import { nameChange, rowChange, valueChange } from "./row_changes.js";
import { TaskCards } from "./tasks.js";

/** A task: what its form has. @typedef {{ section: string, title: string, note: string, aims?: boolean, response?: boolean, limits?: boolean, ranges?: boolean, tolerances?: boolean, data?: boolean, fields: import("./analysis.js").Field[] }} Task */

/** @type {Task[]} */
const TASKS = [
  { section: "optimize", title: "Optimise", note: "Parameter values with the least or greatest response, within limits.", aims: true, limits: true, ranges: true, fields: [{ key: "method", label: "Method", text: true }, { key: "max_iterations", label: "Iterations at most", whole: true }] },
  { section: "pareto", title: "Pareto", note: "Designs of which no aim improves without another one getting worse.", aims: true, limits: true, ranges: true, fields: [{ key: "method", label: "Method", text: true }, { key: "points", label: "Points", whole: true }, { key: "starts", label: "Starts per point", whole: true }] },
  { section: "tolerance", title: "Tolerance", note: "Scatter of a response within the tolerances of dimensions.", response: true, tolerances: true, fields: [{ key: "samples", label: "Samples", whole: true }] },
  { section: "reliability", title: "Reliability", note: "Probability that random parameters, [[random]] in the text, violate a limit.", limits: true, fields: [{ key: "samples", label: "Samples", whole: true }] },
  { section: "identify", title: "Identify", note: "Parameter values that explain measured time series.", data: true, ranges: true, fields: [{ key: "max_iterations", label: "Iterations at most", whole: true }] },
  { section: "sweep", title: "Sweep", note: "Responses at many designs.", fields: [{ key: "samples", label: "Designs", whole: true }, { key: "type", label: "Sampling", text: true }] },
];
/** Keys without which a section is not valid. @type {Record<string, (responses: string[]) => Record<string, unknown>>} */
const REQUIRED = { tolerance: (responses) => ({ response: responses[0] ?? "", tolerances: {} }), reliability: () => ({ limits: [] }) };
const REDUCTIONS = ["Maximum", "Minimum", "Mean", "RMS", "Integral", "Final"];

/** Title of a task. @param {string} section */
export const titleOf = (section) => TASKS.find((task) => task.section === section)?.title ?? `${section[0].toUpperCase()}${section.slice(1)}`;

export class DesignSheet {
  /** @param {{ start: (section: string) => void, stop: () => void, open: (task: TaskMessage) => void, edit: (label: string, operations: Record<string, unknown>[]) => void, reveal: (section: string) => void, measures: () => string[], digest: () => string }} actions */
  constructor(actions) {
    this.actions = actions;
    this.chosen = TASKS[0];
    /** @type {Document | null} */
    this.document = null;
    /** @type {Record<string, TaskMessage>} */
    this.tasks = {};
    this.tabs = el("div", { class: "picks", role: "tablist", "aria-label": "Design task" });
    this.form = el("div", { class: "form" });
    this.cards = new TaskCards(actions);
    this.state = this.cards.node;
    this.begin = button("Start", () => this.actions.start(this.chosen.section), { class: "button primary", id: "start-task" });
    /** Why it is not possible to start. */
    this.refusal = el("span", { class: "muted", role: "status" });
    this.measures = el("datalist", { id: "measures" });
    this.data = new Measurements({ set: (fields) => this.set(fields), edit: (operations) => this.edit(operations), table: () => this.document?.identify ?? {}, measures: () => actions.measures(), render: () => this.render() });
    this.node = el("section", { class: "sheet design" }, this.tabs, this.form, this.state, this.measures);
    this.render();
  }

  /** @param {Document | null} document */
  show(document) {
    if (document) this.document = document;
    this.render();
  }

  /** @param {TaskMessage} task */
  receive(task) {
    const before = this.tasks[task.section];
    this.tasks[task.section] = task;
    this.renderState();
    const changed = before?.number !== task.number || before.status !== task.status;
    if (changed && task.section === this.chosen.section) this.state.scrollIntoView({ block: "nearest" });
  }

  get responses() { return Object.keys(this.document?.responses ?? {}); }

  /** Keys of the section. @returns {Record<string, any>} */
  get table() { return this.document?.[this.chosen.section] ?? {}; }

  /** @param {Record<string, unknown>} fields */
  set(fields) {
    const fresh = !(this.chosen.section in (this.document ?? {})), required = fresh ? REQUIRED[this.chosen.section]?.(this.responses) : {};
    this.change({ ...required, ...fields });
  }

  /** @param {Record<string, unknown>} fields */
  change(fields) { this.actions.edit(`set ${this.chosen.section}`, [{ op: "section", section: this.chosen.section, fields }]); }

  /** @param {import("./operations.js").Operation[]} operations */
  edit(operations) { if (operations.length) this.actions.edit(`set ${this.chosen.section}`, operations); }

  render() {
    const { chosen, document } = this;
    this.tabs.replaceChildren(...TASKS.map((task) => button(task.title, () => { this.chosen = task; this.render(); }, { role: "tab", class: "pick", "aria-selected": String(task === chosen), title: task.note })));
    const focused = /** @type {HTMLInputElement | null} */ (this.form.querySelector(":focus"))?.name;
    this.measures.replaceChildren(...this.actions.measures().map((value) => el("option", { value })));
    this.form.replaceChildren(
      el("p", { class: "muted" }, chosen.note),
      this.responseList(),
      ...(document ? [chosen.aims && this.aims(), chosen.response && this.responseChoice(), chosen.tolerances && this.tolerances(), chosen.data && this.data.node(), chosen.limits && this.limits(), chosen.ranges && this.ranges()] : []).filter((node) => node instanceof Node),
      el("div", { class: "fields" }, chosen.fields.map((field) => numberField(field, this.table[field.key], (value) => this.set({ [field.key]: value })))),
      el("div", { class: "chips" }, this.begin, button("In the text", () => this.actions.reveal(chosen.section), { title: "Show the section in the text" }), this.refusal),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.form.querySelector(`[name="${CSS.escape(focused)}"]`))?.focus();
    this.renderState();
  }

  renderState() {
    const task = this.tasks[this.chosen.section], running = Object.values(this.tasks).find(({ status }) => status === "running");
    const others = running && running !== task ? [running] : [];
    this.refusal.textContent = running ? `${titleOf(running.section)} runs; stop it to start a task.` : "";
    this.begin.disabled = Boolean(running);
    this.cards.show([...(task ? [task] : []), ...others], titleOf);
  }

  /** Responses of the file: reductions of measures to numbers. */
  responseList() {
    const entries = Object.entries(this.document?.responses ?? {});
    const name = el("input", { name: "new-response", placeholder: "name", "aria-label": "Name of the response" });
    const type = el("select", { "aria-label": "Reduction" }, REDUCTIONS.map((value) => el("option", { value }, value)));
    const measure = el("input", { name: "new-measure", placeholder: "measure or formula", list: "measures", "aria-label": "Measure or formula" });
    const add = () => name.value.trim() && measure.value.trim() && this.actions.edit(`add ${name.value.trim()}`, [{ op: "section", section: "responses", fields: { [name.value.trim()]: { type: type.value, measure: measure.value.trim() } } }]);
    return el("fieldset", {}, el("legend", {}, "Responses"),
      el("ul", { class: "plain" }, entries.map(([key, entry]) => el("li", {}, el("b", {}, `${key}:`), ` ${inWords(entry, this.document)}`, button("×", () => this.actions.edit(`remove ${key}`, [{ op: "section", section: "responses", fields: { [key]: null } }]), { class: "button quiet", "aria-label": `Remove ${key}` })))),
      el("div", { class: "row" }, name, type, measure, button("Add", () => void add())));
  }

  /** Aims: a response to minimise or maximise, several of a front. */
  aims() {
    const { table, responses, chosen } = this, several = chosen.section === "pareto";
    const row = (/** @type {string} */ name) => {
      const has = (/** @type {string} */ key) => (several ? [table[key] ?? []].flat().includes(name) : table[key] === name);
      const select = el("select", { "aria-label": name, name: `aim-${name}`, onchange: () => {
        const chosenKey = select.value;
        if (several) this.edit(["minimize", "maximize"].flatMap((key) => nameChange([chosen.section, key], table[key], name, key === chosenKey)));
        else this.set({ minimize: chosenKey === "minimize" ? name : null, maximize: chosenKey === "maximize" ? name : null });
      } }, ["", "minimize", "maximize"].map((value) => el("option", { value }, value || "–")));
      select.value = has("minimize") ? "minimize" : has("maximize") ? "maximize" : "";
      return el("label", { class: "field inline" }, el("span", {}, name), select);
    };
    return el("fieldset", {}, el("legend", {}, several ? "Aims" : "Objective"), responses.length ? responses.map(row) : el("p", { class: "muted" }, "Add a response first."));
  }

  responseChoice() {
    const { table, responses } = this, select = el("select", { name: "response", onchange: () => this.set({ response: select.value }) }, ["", ...responses].map((value) => el("option", { value }, value || "–")));
    select.value = table.response ?? "";
    return el("label", { class: "field inline" }, el("span", {}, "Response"), select);
  }

  /** Limits of responses. */
  limits() {
    const key = this.chosen.section === "reliability" ? "limits" : "subject_to", limits = /** @type {any[]} */ (this.table[key] ?? []);
    const change = (/** @type {string} */ response, /** @type {string} */ side, /** @type {unknown} */ value) => {
      if (!limits.length) return value === null ? undefined : this.set({ [key]: [{ response, [side]: value }] });
      this.edit(rowChange([this.chosen.section, key], limits, limits.findIndex((limit) => limit.response === response), { response }, side, value));
    };
    return el("fieldset", {}, el("legend", {}, "Limits"), this.responses.map((name) => {
      const limit = limits.find(({ response }) => response === name) ?? {};
      return el("div", { class: "row three" }, el("span", {}, name), numberField({ key: `lower-${name}`, label: "≥", empty: "none" }, limit.lower, (value) => change(name, "lower", value)), numberField({ key: `upper-${name}`, label: "≤", empty: "none" }, limit.upper, (value) => change(name, "upper", value)));
    }));
  }

  /** Parameters to vary, with their bounds. */
  ranges() {
    const parameters = Object.entries(this.document?.parameters ?? {}), { table } = this, all = parameters.filter(([, entry]) => Array.isArray(entry?.bounds)).map(([name]) => name), vary = table.vary?.length ? table.vary : all;
    if (!parameters.length) return el("p", { class: "muted" }, "The model has no parameters yet: place the cursor in a number of the text and press “Parameter”.");
    return el("fieldset", {}, el("legend", {}, "Vary"), parameters.map(([name, entry]) => {
      const bounds = /** @type {unknown[]} */ (Array.isArray(entry?.bounds) ? entry.bounds : [undefined, undefined]), box = el("input", { type: "checkbox", name: `vary-${name}`, onchange: () => vary === all || vary.length < 2 ? this.set({ vary: box.checked ? [...vary, name] : vary.filter((/** @type {string} */ other) => other !== name) }) : this.edit(nameChange([this.chosen.section, "vary"], vary, name, box.checked)) });
      box.checked = vary.includes(name);
      const single = typeof entry !== "object", keys = single ? ["parameters", name] : ["parameters", name, "bounds"], isBound = Array.isArray(entry?.bounds);
      const bound = (/** @type {number} */ k) => (/** @type {unknown} */ value) => {
        if (isBound) return this.actions.edit(`bounds of ${name}`, [{ op: "set", keys: [...keys, k], value, written: true }]);
        bounds[k] = value ?? undefined;
        if (!bounds.includes(undefined)) this.actions.edit(`bounds of ${name}`, [{ op: "set", keys, value: single ? { value: entry, bounds } : bounds }]);
      };
      const field = (/** @type {string} */ key, /** @type {string} */ label, /** @type {number} */ k) => numberField({ key: `${key}-${name}`, label, empty: "none", required: isBound ? "Both bounds are needed; the former one is kept" : "" }, bounds[k], bound(k));
      return el("div", { class: "row three" }, el("label", { class: "check" }, box, name), field("low", "from", 0), field("high", "to", 1));
    }));
  }

  /** Half widths of tolerances. */
  tolerances() {
    const own = this.table.tolerances ?? {};
    return el("fieldset", {}, el("legend", {}, "Tolerances ±"), Object.keys(this.document?.parameters ?? {}).map((name) =>
      numberField({ key: `tolerance-${name}`, label: name, empty: "exact" }, own[name], (value) => (this.table.tolerances ? this.edit(valueChange([this.chosen.section, "tolerances"], own, name, value)) : value !== null && this.set({ tolerances: { [name]: value } })))));
  }
}
