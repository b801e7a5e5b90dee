// Selected design and selected ranges of a table of designs, shared by all views of it.

/** @import { DesignColumn, DesignsData, Range } from "./types.d.ts" */

import { Scale } from "./charts.js";
import { clamp, isNum, list, tidy } from "./numbers.js";
import { PALETTE, Signal, Theme, mix } from "./theme.js";
import { labelled, withUnit } from "./units.js";

export class Choice {
  /** @param {DesignsData} designs */
  constructor(designs) {
    /** @type {DesignColumn[]} */
    this.columns = list(designs.columns).map(({ name, unit, role, values }) => ({ name: String(name), unit: unit || "", role, values: list(values) }));
    this.count = this.columns[0]?.values.length ?? 0;
    /** Reasons of failed designs. */
    this.reasons = list(designs.reasons);
    this.labels = list(designs.labels);
    this.alternatives = list(designs.alternatives);
    this.chosen = clamp(designs.chosen | 0, 0, Math.max(0, this.count - 1));
    /** Successful designs, in the order of the table. */
    this.order = [...Array(this.count).keys()].filter((k) => !this.reasons[k]);
    /** Column → selected range. @type {Map<number, Range>} */
    this.ranges = new Map();
    /** @type {Signal<number>} */
    this.onChoose = new Signal();
    /** @type {Signal} */
    this.onRange = new Signal();
    /** Column that colours the designs: the first aim. @type {DesignColumn | undefined} */
    this.coloured = this.columns.find((column) => column.role === "aim") ?? this.columns[0];
    this.colours = new Scale(this.coloured?.values ?? [], false, 0);
  }

  /** @param {DesignColumn} column */
  title(column) { return labelled(column.name, column.unit); }

  /** @param {number} k */
  label(k) { return this.labels[k] || `design ${k + 1}`; }

  /** @param {number} k */
  failed(k) { return Boolean(this.reasons[k]); }

  /** Whether a design lies in all selected ranges. @param {number} k */
  inRanges(k) { return [...this.ranges].every(([c, [lo, hi]]) => this.columns[c].values[k] >= lo && this.columns[c].values[k] <= hi); }

  /** Name and values of a design. @param {number} k */
  summary(k) { return `${this.label(k)}: ${this.columns.map(({ name, unit, values }) => `${name} ${withUnit(tidy(values[k], 5), unit)}`).join(", ")}`; }

  /** Select a design, or none by -1. @param {number} k */
  choose(k) {
    if (k === this.chosen || k < -1 || k >= this.count) return;
    this.chosen = k;
    this.onChoose.emit(k);
  }

  /** Select another design in the ranges, in the order of the table. @param {number} by */
  step(by) {
    const selectable = this.order.filter((k) => this.inRanges(k));
    if (!selectable.length) return;
    const at = selectable.indexOf(this.chosen);
    this.choose(selectable[at < 0 ? 0 : clamp(at + by, 0, selectable.length - 1)]);
  }

  /** Select a range of a column, or clear it. @param {number} column @param {Range | null} range */
  limit(column, range) {
    if (range) this.ranges.set(column, range); else this.ranges.delete(column);
    this.onRange.emit();
  }

  /** Colour of a design by its first aim: from blue (minimum) over green to orange. @param {number} k */
  colour(k) {
    const share = clamp(this.colours.share(this.coloured?.values[k] ?? NaN), 0, 1), stops = PALETTE[Theme.name];
    if (!isNum(share)) return "var(--muted)";
    return share < 0.5 ? mix(stops[0], stops[2], 2 * share) : mix(stops[2], stops[1], 2 * share - 1);
  }

  /** Let the arrow keys select designs while a view has the focus. @param {Element} node @param {string} title */
  bind(node, title) {
    node.setAttribute("tabindex", "0");
    node.setAttribute("role", "group");
    node.setAttribute("aria-label", `${title}. Arrow keys select a design.`);
    node.addEventListener("keydown", (event) => {
      const e = /** @type {KeyboardEvent} */ (event);
      /** @type {Record<string, number>} */
      const steps = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1, Home: -this.count, End: this.count };
      if (!steps[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
      e.preventDefault();
      e.stopPropagation();
      this.step(steps[e.key]);
    });
  }
}
