// Cards of the page: the views of the payload, in columns beside and below the drawing.

/** @import { Child, NotesView, RowsView, View } from "./types.d.ts" */

import { CurvesChart, chartKinds } from "./charts.js";
import { Choice } from "./choice.js";
import { FrontChart, MatrixChart, ParallelChart } from "./design_charts.js";
import { DesignTable, chosenCard } from "./design_table.js";
import { byId, el } from "./dom.js";
import { list, tidy } from "./numbers.js";
import { convergencePanel, optimumPanel } from "./optimum.js";
import { diagnosisPanel, pairs, panel, parameterPanel, scrollable, verdict } from "./panels.js";
import { payload } from "./payload.js";
import { raised } from "./units.js";

/** The designs of the page. */
export const choice = payload.designs ? new Choice(payload.designs) : null;

/** @param {RowsView} view */
function rowsTable(view) {
  const headings = ["", ...view.heads, ""].map((text, k) => el("th", { scope: "col", class: k && k <= view.heads.length ? "right" : "" }, text));
  const rows = view.rows.map(({ name, cells, unit }) =>
    el("tr", {}, el("th", { scope: "row" }, name), cells.map((v) => el("td", { class: "right" }, tidy(v, 6))), el("td", { class: "unit" }, raised(unit || ""))));
  return scrollable(view.title, el("table", { class: "figures" }, el("thead", {}, el("tr", {}, headings)), el("tbody", {}, rows)));
}

/** @param {NotesView} view */
const notesList = (view) => el("ul", { class: "messages" }, view.texts.map((text) => el("li", { class: "warning" }, el("span", {}, text))));

/** Colours of the designs and their values. @param {Choice} designs */
const colourLegend = (designs) => designs.coloured && el("span", { class: "tones" },
  el("span", {}, tidy(designs.colours.lo, 3)), el("i"), el("span", {}, tidy(designs.colours.hi, 3)), el("span", { class: "name" }, designs.title(designs.coloured)));

/** Content of the card of a view; nothing for an unknown kind, or designs that are missing.
 * @param {View} view @returns {Child} */
function contentOf(view) {
  switch (view.kind) {
    case "facts": return pairs(view.items);
    case "rows": return rowsTable(view);
    case "notes": return notesList(view);
    case "curves": return new CurvesChart(view, choice).node;
  }
  const chart = chartKinds[view.kind];
  if (chart) return chart(view);
  if (!choice?.count) return null;
  switch (view.kind) {
    case "front": return [new FrontChart(view, choice).node, colourLegend(choice)];
    case "parallel": return [new ParallelChart(view, choice).node, colourLegend(choice)];
    case "matrix": return [new MatrixChart(view, choice).node, colourLegend(choice)];
    case "table": return new DesignTable(view, choice).node;
  }
  return null;
}

/** @param {View} view @param {number} k */
function viewPanel(view, k) {
  const content = contentOf(view);
  if (!content) return null;
  const node = panel(view.title, `view-${k}`, content, view.note && el("p", { class: "caption note" }, view.note));
  if (view.wide) node.classList.add("wide");
  return node;
}

/** Cards of the views beside the drawing, or below it. @param {boolean} beside */
export function viewPanels(beside) {
  const panels = list(payload.views).map((view, k) => ((view.place === "board") === beside ? viewPanel(view, k) : null)).filter((node) => node !== null);
  if (beside && choice?.count) panels.unshift(chosenCard(choice));
  return panels;
}

/** Fill the columns below the drawing, and the verdict at the head of the page.
 * @param {Child[]} left @param {Child[]} right further cards of the columns */
export function buildColumns(left, right) {
  const cards = viewPanels(false), wide = cards.filter((node) => node.classList.contains("wide"));
  const [odd, even] = [0, 1].map((side) => cards.filter((node) => !wide.includes(node)).filter((_, k) => k % 2 === side));
  const statistics = payload.designs ? [] : list(payload.statistics), parameters = payload.optimum || payload.designs ? [] : list(payload.parameters);
  const columns = [
    [optimumPanel(payload.optimum), odd, diagnosisPanel(payload.diagnosis), left, parameterPanel(parameters)],
    [convergencePanel(payload.optimum, choice), even, statistics.length > 0 && panel("Statistics", "statistics", pairs(statistics)), right],
  ].map((column) => el("div", { class: "column" }, column));
  byId("panels").append(...wide, ...columns.filter((column) => column.children.length));
  verdict(byId("verdict"), payload.diagnosis, payload.verdict);
}
