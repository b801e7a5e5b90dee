// Tables of the displacements, elements and reactions of a structure, sorted by a click on a heading.

/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */

import { el } from "./dom.js";
import { isNum, number } from "./numbers.js";
import { panel, scrollable } from "./panels.js";
import { labelled, prefixed, quantity } from "./units.js";

/** Limits of the rows on a screen, and on paper (see the style sheet). */
const SHOWN_ROWS = 200, PAPER_ROWS = 30;

/** Name of a row, then its numbers; null where it has none.
 * @typedef {[string, ...(number | null | undefined)[]]} Row */
/** @typedef {{ name: string, unit?: string }} Column */

class SortedTable {
  /** @param {string} title @param {Column[]} columns the first one of names */
  constructor(title, columns) {
    this.columns = columns;
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
    const sign = this.descending ? -1 : 1, size = (/** @type {Row} */ row) => Math.abs(Number(row[by] ?? -1)) - (isNum(row[by]) ? 0 : 2);
    return [...this.rows].sort((a, b) => sign * (by ? size(a) - size(b) : a[0].localeCompare(b[0], undefined, { numeric: true })));
  }

  /** Number in the unit of its column; round-off is zero. @param {number | null | undefined} value @param {number} k */
  cell(value, k) {
    if (!isNum(value)) return "";
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
    this.body.replaceChildren(...shown.map(([name, ...values]) => el("tr", {}, el("th", { scope: "row" }, name), values.map((value, k) => el("td", { class: "right" }, this.cell(value, k + 1))))));
    this.note.textContent = `${SHOWN_ROWS} of ${rows.length} rows; sort by a column to see its largest values`;
    this.note.hidden = rows.length <= shown.length;
    this.paper.textContent = rows.length > PAPER_ROWS ? `The first ${PAPER_ROWS} of ${rows.length} rows, in the order of the page` : "";
  }
}

/** Rows of the supported nodes. @param {Mesh} mesh @param {string[]} forces @returns {Row[]} */
function reactionRows({ nodes, reactions, state }, forces) {
  /** @type {Map<string, Row>} */
  const rows = new Map();
  for (const { node, name, values } of reactions) {
    const row = rows.get(node) ?? /** @type {Row} */ ([node, ...forces.map(() => null)]);
    row[1 + forces.indexOf(name)] = values[state];
    rows.set(node, row);
  }
  const order = new Map(nodes.map((name, k) => [name, k]));
  return [...rows.values()].sort((a, b) => (order.get(a[0]) ?? 0) - (order.get(b[0]) ?? 0));
}

/** Cards of a structure, which follow its state. @param {Motion} motion @param {Mesh} mesh */
export function structureTables(motion, mesh) {
  const title = mesh.relative ? "Shape" : "Displacements", forces = ["fx", "fy", "fz", "mx", "my", "mz"].filter((force) => mesh.reactions.some(({ name }) => name === force));
  const displacements = new SortedTable(title, [{ name: "node" }, ...mesh.directions.map((name) => ({ name, unit: mesh.unitOf(name) }))]);
  const reactions = new SortedTable("Reactions", [{ name: "node" }, ...forces.map((name) => ({ name, unit: name[0] === "m" ? "N m" : "N" }))]);
  const measured = mesh.fields.filter(({ atVertices }) => !atVertices);
  const elements = new SortedTable("Elements", [{ name: "element" }, ...measured.map(({ name, unit }) => ({ name: name.replaceAll("_", " "), unit: unit === "1" ? "" : unit }))]);
  const total = el("p", { class: "caption note" });
  /** State and mesh of the rows. */
  let shown = { state: -1, mesh };
  const refresh = () => {
    const { mesh: present, state } = motion;
    if (!present || (state === shown.state && present === shown.mesh)) return;
    shown = { state, mesh: present };
    present.cursor = motion.cursor;
    displacements.fill(present.nodes.map((name, k) => [name, ...present.components(k).map((c) => c?.value)]));
    elements.fill(present.elements.map((name, k) => [name, ...present.fields.filter(({ atVertices }) => !atVertices).map((field) => present.valueOf(field, k))]));
    const rows = reactionRows(present, forces), largest = Math.max(0, ...rows.flatMap(([, ...values]) => values.map((v) => Math.abs(v ?? 0))));
    reactions.fill(rows);
    const sums = forces.filter((name) => name[0] === "f").map((name) => {
      const sum = rows.reduce((s, row) => s + (Number(row[1 + forces.indexOf(name)]) || 0), 0);
      return `${name} ${quantity(Math.abs(sum) < 1e-10 * largest ? 0 : sum, "N")}`;
    });
    total.textContent = `sum: ${sums.join(", ")}`;
  };
  motion.onState.on(refresh);
  refresh();
  const relative = "Relative to the largest displacement, because a mode shape has no absolute scale. Element values are relative to the largest value as well.";
  return el("div", { class: "tables" },
    panel(title, "displacements", displacements.node, mesh.relative && el("p", { class: "caption note" }, relative)),
    measured.length > 0 && panel("Elements", "elements", elements.node),
    mesh.reactions.length > 0 && panel("Reactions", "reactions", reactions.node, total));
}
