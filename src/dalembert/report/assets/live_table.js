// Responses of a live page: values, changes, and the selected one.

/** @import { LiveResponse } from "./types.d.ts" */

import { el } from "./dom.js";
import { tidy } from "./numbers.js";
import { Signal } from "./theme.js";
import { raised } from "./units.js";

export class ResponseTable {
  /** @param {LiveResponse[]} responses */
  constructor(responses) {
    this.responses = responses;
    this.selected = 0;
    /** @type {number[] | null} */
    this.initial = null;
    /** @type {Signal} */
    this.onSelect = new Signal();
    this.cells = responses.map(() => [el("td", { class: "right" }), el("td", { class: "right change" })]);
    const rows = responses.map(({ label, unit }, k) => {
      const radio = el("input", { type: "radio", name: "response", value: String(k), "aria-label": `Slopes of ${label}`, onchange: () => { this.selected = k; this.onSelect.emit(); } });
      radio.checked = k === 0;
      return el("tr", {}, el("th", { scope: "row" }, el("label", {}, radio, " ", label)), this.cells[k], el("td", { class: "unit" }, unit && unit !== "1" ? raised(unit) : ""));
    });
    const heads = ["Response", "Value", "Change", "Unit"].map((text, k) => el("th", { scope: "col", class: k === 1 || k === 2 ? "right" : "" }, text));
    this.node = el("div", { class: "scroll" }, el("table", { class: "figures responses" }, el("thead", {}, el("tr", {}, heads)), el("tbody", {}, rows)));
  }

  /** @param {number[]} values */
  show(values) {
    this.initial ??= values;
    values.forEach((value, k) => {
      const [now, change] = this.cells[k], before = this.initial?.[k] ?? NaN, share = (100 * (value - before)) / Math.abs(before);
      now.textContent = tidy(value, 5);
      change.textContent = value === before ? "" : Number.isFinite(share) && Math.abs(share) < 1e4 ? `${share > 0 ? "+" : ""}${tidy(share, 3)} %` : tidy(value - before, 4);
    });
  }
}
