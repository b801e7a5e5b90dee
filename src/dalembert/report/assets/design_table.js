// Table of designs, and the card of the selected design.

/** @import { Choice } from "./choice.js" */
/** @import { DesignView } from "./types.d.ts" */

import { clipped } from "./charts.js";
import { el, iconButton } from "./dom.js";
import { clamp, isNum, tidy } from "./numbers.js";
import { withUnit } from "./units.js";

/** Upper limit of the rows of the table. */
const MAX_ROWS = 400;

/** The numbers, a row for each design; a click on a heading sorts. */
export class DesignTable {
  /** @param {DesignView} view @param {Choice} choice */
  constructor(view, choice) {
    this.choice = choice;
    /** Column by which the table is sorted. @type {number | null} */
    this.sorted = null;
    this.descending = false;
    this.scrolls = false;
    this.head = el("tr");
    this.body = el("tbody");
    this.note = el("p", { class: "caption note" });
    this.box = el("div", { class: "scroll" }, el("table", { class: "figures designs" }, el("thead", {}, this.head), this.body));
    this.node = el("div", {}, this.box, this.note);
    choice.bind(this.box, view.title);
    choice.onChoose.on(() => this.mark());
    choice.onRange.on(() => this.fill());
    this.fill();
  }

  /** @param {number} column */
  sort(column) {
    this.descending = this.sorted === column && !this.descending;
    this.sorted = column;
    this.fill();
  }

  /** Designs in the order of the table; missing numbers last. */
  order() {
    const designs = [...Array(this.choice.count).keys()];
    if (this.sorted === null) return designs;
    const sign = this.descending ? -1 : 1, { values } = this.choice.columns[this.sorted];
    return designs.sort((p, q) => (isNum(values[p]) ? (isNum(values[q]) ? sign * (values[p] - values[q]) : -1) : 1));
  }

  fill() {
    const { choice } = this, order = this.order();
    choice.order = order.filter((k) => !choice.failed(k));
    const rows = order.filter((k) => choice.inRanges(k) || choice.failed(k));
    this.head.replaceChildren(el("th", { scope: "col" }, "Design"), ...choice.columns.map((column, i) => {
      const direction = this.sorted !== i ? "none" : this.descending ? "descending" : "ascending";
      const mark = { none: "", descending: " ↓", ascending: " ↑" }[direction];
      return el("th", { scope: "col", class: "right", "aria-sort": direction }, el("button", { type: "button", class: "sort", onclick: () => this.sort(i) }, choice.title(column) + mark));
    }));
    this.note.textContent = rows.length > MAX_ROWS ? `${MAX_ROWS} of ${rows.length} designs; sort or select a range to see others.` : "";
    this.body.replaceChildren(...rows.slice(0, MAX_ROWS).map((k) => el("tr",
      { "data-design": String(k), class: choice.failed(k) ? "failed" : "pickable", title: choice.reasons[k] ?? "", onclick: () => choice.choose(k) },
      el("th", { scope: "row" }, choice.label(k)),
      choice.columns.map(({ role, values }) => el("td", { class: `right ${role}` }, isNum(values[k]) ? tidy(values[k], 5) : "–")))));
    this.mark();
  }

  /** Mark the selected design, and scroll to it after the first time. */
  mark() {
    for (const row of this.body.rows) {
      const on = Number(row.dataset.design) === this.choice.chosen;
      row.classList.toggle("chosen", on);
      if (on) row.setAttribute("aria-current", "true"); else row.removeAttribute("aria-current");
      if (on && this.scrolls) this.box.scrollTop = clamp(this.box.scrollTop, row.offsetTop + row.offsetHeight - this.box.clientHeight + 4, row.offsetTop - 34);
    }
    this.scrolls = true;
  }
}

/** Card with name, aims and parameters of the selected design. @param {Choice} choice */
export function chosenCard(choice) {
  const title = el("h2"), aims = el("dl", { class: "aims" }), parameters = el("dl", { class: "pairs" });
  const cells = (/** @type {string} */ role) => choice.columns.filter((column) => column.role === role).map(({ name, unit, values }) =>
    el("div", {}, el("dt", {}, name), el("dd", {}, withUnit(tidy(values[choice.chosen], 6), unit))));
  const fill = () => {
    const none = choice.chosen < 0;
    for (const list of [aims, parameters]) list.hidden = none;
    title.textContent = none ? "None of the designs" : clipped(choice.label(choice.chosen), 60).replace(/^./, (c) => c.toUpperCase());
    aims.replaceChildren(...cells("aim"));
    parameters.replaceChildren(...cells("parameter"));
  };
  fill();
  choice.onChoose.on(fill);
  return el("section", { class: "card panel chosen-design", "aria-live": "polite", "aria-label": "Selected design" },
    el("div", { class: "plot-head" }, title, el("div", { class: "plot-tools" },
      iconButton("back", "Previous design", () => choice.step(-1), { id: "previous-design" }),
      iconButton("next", "Next design", () => choice.step(1), { id: "next-design" }))), aims, parameters);
}
