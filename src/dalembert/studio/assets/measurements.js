// Measurements of an identification: a table that is chosen or dropped, and what its columns measure.

import { numberField } from "./analysis.js";
import { button, el } from "./dom.js";
import { valueChange } from "./row_changes.js";

/** A column of numbers of a table. @typedef {{ name: string, samples: number, range: [number, number] | null }} Column */

/** Names of columns of times that need not be stated. */
const TIMES = ["time", "t"];

/** Name and columns of a file; or the reason why there are none. @typedef {{ name: string, columns: Column[], reason: string }} Answer */

/** @param {string} name @param {RequestInit} [options] @returns {Promise<Answer>} */
async function request(name, options) {
  const reply = await fetch(`measurements?${new URLSearchParams({ name })}`, options).catch(() => null);
  if (reply?.ok) return { ...await reply.json(), reason: "" };
  return { name, columns: [], reason: reply ? await reply.text() : "the program does not answer" };
}

export class Measurements {
  /** @param {{ set: (fields: Record<string, unknown>) => void, edit: (operations: import("./operations.js").Operation[]) => void, table: () => Record<string, any>, measures: () => string[], render: () => void }} actions */
  constructor(actions) {
    this.actions = actions;
    /** File whose columns are known or being read. */
    this.name = "";
    /** @type {Column[]} */
    this.columns = [];
    /** Why there are no columns. */
    this.reason = "";
    /** Why the last chosen file was refused; the former one stays. */
    this.refused = "";
    this.input = el("input", { type: "file", accept: ".csv,.txt", hidden: true, "aria-label": "File of measurements", onchange: () => void this.store(this.input.files?.[0]) });
  }

  /** Read the columns of a file beside the model. @param {string} name */
  async read(name) {
    this.name = name;
    const answer = await request(name);
    if (this.name === name) this.take(answer);  // no other file was chosen meanwhile
  }

  /** @param {Answer} answer */
  take({ name, columns, reason }) {
    [this.name, this.columns, this.reason] = [name, columns, reason];
    this.actions.render();
  }

  /** Store a file beside the model, and refer to it. @param {File | undefined} file */
  async store(file) {
    if (!file) return;
    [this.refused, this.input.value] = ["", ""];
    const answer = await request(file.name, { method: "PUT", body: file }), { name } = answer;
    if (answer.reason) {
      this.refused = answer.reason.includes(file.name) ? answer.reason : `${file.name}: ${answer.reason}`;
      return this.actions.render();
    }
    this.take(answer);
    const { columns } = this, names = columns.map((column) => column.name), known = this.actions.measures();
    const time = names.find((column) => TIMES.includes(column)) ?? names[0], same = names.filter((column) => column !== time && known.includes(column));
    const measures = same.length && same.length < names.length - 1 ? Object.fromEntries(same.map((column) => [column, column])) : null;
    this.actions.set({ data: name, time: TIMES.includes(time) ? null : time, measures });
  }

  /** Form of the file and its columns. */
  node() {
    const { data } = this.actions.table();
    if (typeof data === "string" && data && data !== this.name) void this.read(data);
    const box = el("fieldset", { class: "measurements", ondragover: (event) => { event.preventDefault(); box.classList.add("over"); }, ondragleave: () => box.classList.remove("over"),
      ondrop: (event) => {
        event.preventDefault();
        box.classList.remove("over");
        void this.store(/** @type {DragEvent} */ (event).dataTransfer?.files[0]);
      } }, el("legend", {}, "Measurements"),
    el("div", { class: "row file" }, numberField({ key: "data", label: "File beside the model", text: true, empty: "none" }, data, (value) => this.actions.set({ data: value })), button("Choose…", () => this.input.click(), { title: "Choose a CSV file, which is stored beside the model; or drop it here" }), this.input),
    (this.refused || this.reason) && el("p", { class: "reason" }, this.refused || this.reason), data && this.columns.length > 0 && this.name === data ? this.matches() : !this.refused && !this.reason && el("p", { class: "muted" }, "Choose a CSV file with a column of times, or drop it here."));
    return box;
  }

  /** What each column measures. */
  matches() {
    const table = this.actions.table(), names = this.columns.map(({ name }) => name), time = table.time ?? names.find((name) => TIMES.includes(name)), known = this.actions.measures();
    const own = /** @type {Record<string, string>} */ (table.measures ?? {}), stated = Object.keys(own).length > 0;
    const measured = Object.fromEntries(names.flatMap((name) => (stated ? (name in own ? [[name, own[name]]] : []) : name !== time && known.includes(name) ? [[name, name]] : [])));
    const set = (/** @type {string} */ column, /** @type {unknown} */ value) => {
      const others = Object.keys(own).some((other) => other !== column);
      if (stated && (value !== null || others)) return this.actions.edit(valueChange(["identify", "measures"], own, column, value));
      const next = Object.fromEntries(names.flatMap((name) => (name === column ? (value === null ? [] : [[name, value]]) : name in measured ? [[name, measured[name]]] : [])));
      this.actions.set({ measures: Object.keys(next).length ? next : null });
    };
    const choice = el("select", { name: "time", "aria-label": "Column of times", onchange: () => this.actions.set({ time: choice.value }) }, names.map((name) => el("option", { value: name }, name)));
    choice.value = time ?? "";
    return el("div", { class: "columns" }, el("label", { class: "field inline" }, el("span", {}, "Times [s]"), choice),
      ...this.columns.filter(({ name }) => name !== time).map(({ name, samples, range }) => {
        const input = el("input", { type: "text", name: `column-${name}`, list: "measures", value: measured[name] ?? "", placeholder: "not used", spellcheck: "false", autocomplete: "off", "aria-label": `Measure of ${name}`, onchange: () => set(name, input.value.trim() || null) });
        return el("label", { class: "field inline" }, el("span", {}, name, el("small", {}, ` ${samples} samples${range ? `, ${range.map((value) => Number(value.toPrecision(3))).join(" … ")}` : ""}`)), input);
      }));
  }
}
