// Responses of a live page: values, initial values, changes, and the selected one.

/** @import { LiveResponse, LiveResult } from "./types.d.ts" */

import { el, iconButton } from "./dom.js";
import { responseOf } from "./live_responses.js";
import { tidy } from "./numbers.js";
import { Signal } from "./theme.js";
import { raised } from "./units.js";

/** Text in place of a value until the first result. */
const COMPUTED = "…";

/** Change of a value as a percentage, or as a difference where that says more. @param {number} value @param {number} before */
export function changeText(value, before) {
  const share = (100 * (value - before)) / Math.abs(before);
  if (value === before || Number.isNaN(value - before)) return "";
  if (Math.abs(share) < 0.01) return "< 0.01 %";
  const [text, sign] = Math.abs(share) < 1e4 ? [`${tidy(share, 3)} %`, share > 0] : [tidy(value - before, 4), value > before];
  return `${sign ? "+" : ""}${text}`;
}

/** Value of a response in a result. @param {LiveResult} result @param {LiveResponse} response */
export const valueIn = ({ times, table, located }, response) => responseOf(response, times, (row) => table.subarray(times.length * row, times.length * (row + 1)), undefined, located).value;

/** A name that breaks at its dots and brackets. @param {string} name */
const breakable = (name) => name.split(/(?<=[.(])/).flatMap((part, k) => (k ? [el("wbr"), part] : [part]));

export class ResponseTable {
  /** @param {LiveResponse[]} responses */
  constructor(responses) {
    /** @type {LiveResponse[]} */
    this.responses = responses;
    this.selected = 0;
    /** @type {number[]} */
    this.values = [];
    /** Result of the initial design. @type {LiveResult | null} */
    this.initial = null;
    /** Another response is selected. @type {Signal} */
    this.onSelect = new Signal();
    /** Responses were added or removed. @type {Signal} */
    this.onList = new Signal();
    this.body = el("tbody");
    this.head = el("tr");
    /** Further cells of a row. @type {{ title: string, cell: (response: LiveResponse) => HTMLElement }[]} */
    this.columns = [];
    this.node = el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Responses" }, el("table", { class: "figures responses" }, el("thead", {}, this.head), this.body));
    this.fill();
  }

  fill() {
    const heads = ["Response", "Value", "Initial", "Change", ...this.columns.map(({ title }) => title)];
    this.head.replaceChildren(...heads.map((text, k) => el("th", { scope: "col", class: k > 0 && k < 4 ? "right" : "" }, text)), el("th", { "aria-label": "Remove" }));
    this.body.replaceChildren(...this.responses.map((response, k) => {
      const { label, unit } = response;
      const radio = el("input", { type: "radio", name: "response", value: String(k), "aria-label": `Slopes of ${label}`, onchange: () => { this.selected = k; this.onSelect.emit(); } });
      radio.checked = k === this.selected;
      radio.addEventListener("keydown", (event) => event.stopPropagation());
      const name = el("label", { title: `Show the slopes of ${label}` }, radio, el("span", { class: "label" }, breakable(label), unit && unit !== "1" ? el("small", {}, ` [${raised(unit)}]`) : ""));
      return el("tr", {}, el("th", { scope: "row" }, name), ["value", "was", "change"].map((look) => el("td", { class: `right ${look}` })),
        this.columns.map(({ cell }) => el("td", {}, cell(response))), el("td", {}, iconButton("close", `Remove ${label}`, () => this.remove(k), { class: "icon tiny" })));
    }));
    this.show(this.values);
  }

  /** @param {LiveResponse} response */
  add(response) {
    const same = this.responses.findIndex(({ label }) => label === response.label);
    this.selected = same < 0 ? this.responses.length : same;
    if (same < 0) this.responses = [...this.responses, response];
    this.fill();
    (same < 0 ? this.onList : this.onSelect).emit();
  }

  /** @param {number} k */
  remove(k) {
    const selected = this.responses[this.selected];
    this.responses = this.responses.filter((_, i) => i !== k);
    this.values = this.values.filter((_, i) => i !== k);
    this.selected = Math.max(0, this.responses.indexOf(selected));
    this.fill();
    this.onList.emit();
  }

  /** @param {number[]} values */
  show(values) {
    this.values = values;
    this.responses.forEach((response, k) => {
      const value = values[k] ?? NaN, before = this.initial ? valueIn(this.initial, response) : NaN, cells = /** @type {HTMLTableRowElement} */ (this.body.rows[k]).cells;
      const texts = values[k] === undefined ? [COMPUTED, "", ""] : [tidy(value, 5), tidy(before, 5), changeText(value, before)];
      texts.forEach((text, i) => { cells[i + 1].textContent = text; });
    });
  }
}
