// Table of numbers with their units, sorted by a click on a heading.

import { el } from "./dom.js";
import { isNum, number } from "./numbers.js";
import { scrollable } from "./panels.js";
import { labelled, prefixed } from "./units.js";

/** Limits of the rows on a screen, and on paper (see the style sheet). */
const SHOWN_ROWS = 200, PAPER_ROWS = 30;

/** Name of a row, then its numbers or texts; null where it has none.
 * @typedef {[string, ...(number | string | null | undefined)[]]} Row */
/** @typedef {{ name: string, unit?: string }} Column */

export class SortedTable {
  /** @param {string} title @param {Column[]} columns the first one of names @param {((name: string) => void) | null} [pick] called with the name of a row that is clicked */
  constructor(title, columns, pick = null) {
    this.columns = columns;
    this.pick = pick;
    /** Name of the marked row. */
    this.marked = "";
    /** @type {Row[]} */
    this.rows = [];
    /** Column by which the rows are sorted. @type {number | null} */
    this.by = null;
    this.descending = true;
    this.body = el("tbody");
    this.head = el("tr");
    this.note = el("p", { class: "caption note" });
    this.paper = el("p", { class: "caption on-paper" });
    this.node = el("div", {}, scrollable(title, el("table", { class: "figures" }, el("thead", {}, this.head), this.body)), this.note, this.paper);
    /** Units with prefixes, one for all columns of a unit. @type {Map<string, ReturnType<typeof prefixed>>} */
    this.units = new Map();
    this.fill([]);
  }

  headings() {
    this.head.replaceChildren(...this.columns.map(({ name, unit = "" }, k) => {
      const sorted = this.by === k ? (this.descending ? "descending" : "ascending") : "none", mark = this.by !== k ? "" : this.descending ? " ↓" : " ↑";
      const button = el("button", { type: "button", class: "sort", onclick: () => this.sort(k) }, labelled(name, this.units.get(unit)?.unit ?? unit) + mark);
      return el("th", { scope: "col", class: k ? "right" : "", "aria-sort": sorted }, button);
    }));
  }

  /** @param {number} k */
  sort(k) {
    this.descending = this.by === k ? !this.descending : k > 0;
    this.by = k;
    this.fill(this.rows);
  }

  /** Rows in the chosen order, numbers by their magnitude. */
  ordered() {
    const { by } = this;
    if (by === null) return this.rows;
    const sign = this.descending ? -1 : 1, size = (/** @type {Row} */ row) => (isNum(row[by]) ? Math.abs(row[by]) : -1);
    const texts = by === 0 || this.rows.some((row) => typeof row[by] === "string");
    return [...this.rows].sort((a, b) => sign * (texts ? String(a[by]).localeCompare(String(b[by]), undefined, { numeric: true }) : size(a) - size(b)));
  }

  /** Number in the unit of its column; round-off is zero. @param {Row[number]} value @param {number} k */
  cell(value, k) {
    if (!isNum(value)) return typeof value === "string" ? value : "";
    if (value === 0) return "0";
    const { factor, size } = this.units.get(this.columns[k].unit ?? "") ?? { factor: 1, size: 0 };
    return number(Math.abs(value) < 1e-10 * size ? 0 : value / factor, 5);
  }

  /** @param {Row[]} rows */
  fill(rows) {
    this.rows = rows;
    /** @type {Map<string, number>} */
    const largest = new Map();
    this.columns.forEach(({ unit }, k) => {
      if (unit) largest.set(unit, rows.reduce((most, row) => Math.max(most, Math.abs(Number(row[k])) || 0), largest.get(unit) ?? 0));
    });
    this.units = new Map([...largest].map(([unit, size]) => [unit, prefixed(size, unit)]));
    this.headings();
    const shown = this.ordered().slice(0, SHOWN_ROWS);
    this.body.replaceChildren(...shown.map(([name, ...values]) => el("tr", this.pick ? { class: "pickable", onclick: () => this.pick?.(name) } : {}, el("th", { scope: "row" }, name), values.map((value, k) => el("td", { class: "right" }, this.cell(value, k + 1))))));
    this.mark(this.marked);
    this.note.textContent = `${SHOWN_ROWS} of ${rows.length} rows; sort by a column to see its largest values`;
    this.note.hidden = rows.length <= shown.length;
    this.paper.textContent = rows.length > PAPER_ROWS ? `The first ${PAPER_ROWS} of ${rows.length} rows, in the order of the page` : "";
  }

  /** Mark a row. @param {string} name */
  mark(name) {
    this.marked = name;
    for (const row of this.body.rows) {
      const on = name !== "" && row.cells[0].textContent === name;
      row.classList.toggle("chosen", on);
      if (on) row.setAttribute("aria-current", "true"); else row.removeAttribute("aria-current");
    }
  }
}
