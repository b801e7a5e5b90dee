// Cards of an optimum: objective, variables, limits and prices; convergence.

/** @import { Choice } from "./choice.js" */
/** @import { Bounded, Line, Optimum } from "./types.d.ts" */

import { CurvesChart } from "./charts.js";
import { el } from "./dom.js";
import { clamp, isNum, list, tidy } from "./numbers.js";
import { panel, rangeBar, scrollable } from "./panels.js";
import { labelled, raised } from "./units.js";

/** Violation of limits that is shown, relative to their size. */
const VIOLATED = 1e-6;

/** @param {Optimum | undefined} optimum */
export function optimumPanel(optimum) {
  if (!optimum) return null;
  const unit = optimum.unit ? ` ${optimum.unit}` : "";
  const entries = [...list(optimum.variables), ...list(optimum.limits)], priced = entries.some(({ active, price }) => active && price);
  const headings = ["Name", "First", "Best", "Unit", "Range", ...(priced ? ["Costs"] : [])];
  const table = el("table", {},
    el("thead", {}, el("tr", {}, headings.map((text, k) => el("th", { scope: "col", class: k === 1 || k === 2 ? "right" : "" }, text)))),
    el("tbody", {}, entries.map((entry) => optimumRow(entry, optimum, priced))));
  return panel("Optimum", "optimum",
    el("p", { class: "objective" }, el("span", {}, `${optimum.label}: `), el("span", { class: "was" }, `${tidy(optimum.start)}${unit}`), " → ", el("b", {}, `${tidy(optimum.value)}${unit}`)),
    el("ul", { class: "messages" }, el("li", { class: optimum.success ? "info" : "warning" }, el("b", {}, optimum.success ? "Optimal" : "Not optimal"), el("span", {}, String(optimum.message)))),
    scrollable("Limits and parameters", table, "scroll tall"),
    list(optimum.prices).length > 0 && el("ul", { class: "prices" }, list(optimum.prices).map((text) => el("li", {}, String(text)))));
}

/** @param {Bounded} entry */
const isViolated = ({ value, lower, upper }) =>
  (isNum(lower) && value < lower - VIOLATED * (Math.abs(lower) || 1)) || (isNum(upper) && value > upper + VIOLATED * (Math.abs(upper) || 1));

/** Row of a variable or limit. @param {Bounded} entry @param {Optimum} optimum @param {boolean} priced */
function optimumRow(entry, { unit, success }, priced) {
  const price = entry.active && entry.price ? `${tidy(entry.price, 4)} ${unit || ""}${entry.unit ? ` / ${entry.unit}` : ""}` : "";
  return el("tr", { class: entry.active ? "active" : "" },
    el("th", { scope: "row" }, String(entry.name),
      entry.active && el("i", { class: "at", title: `at its ${entry.active} bound` }, entry.active === "lower" ? " ▼" : " ▲"),
      !success && isViolated(entry) && el("i", { class: "at broken", title: "violates its limit" }, " ✗")),
    el("td", { class: "right was" }, tidy(entry.start)), el("td", { class: "right" }, tidy(entry.value)),
    el("td", { class: "unit" }, entry.unit ? raised(entry.unit) : "–"), el("td", {}, boundsBar(entry)), priced && el("td", { class: "unit" }, price));
}

/** First and best value between the bounds; as a text where a bound is missing. @param {Bounded} entry */
function boundsBar({ start, value, lower, upper }) {
  if (isNum(lower) && isNum(upper) && lower === upper) return `= ${tidy(lower)}`;
  if (!isNum(lower)) return isNum(upper) ? `≤ ${tidy(upper)}` : "–";
  if (!isNum(upper)) return `≥ ${tidy(lower)}`;
  const first = el("i", { class: "first" });
  first.style.setProperty("--p", String(clamp((start - lower) / (upper - lower), 0, 1)));
  return rangeBar({ value, lower, upper }, first);
}

/** Objective over the iterations; hollow where limits are violated. @param {Optimum | undefined} optimum @param {Choice | null} choice iterates as designs */
export function convergencePanel(optimum, choice) {
  const history = list(optimum?.history).map((step, k) => ({ ...step, k })).filter(({ objective }) => isNum(objective));
  if (!optimum || history.length < 2) return null;
  const values = history.map(({ objective }) => objective), low = Math.min(...values), y = labelled(optimum.label, optimum.unit);
  const line = (/** @type {typeof history} */ steps, /** @type {Line["style"]} */ style, open = false) =>
    ({ name: optimum.label, x: steps.map(({ k }) => k), y: steps.map(({ objective }) => objective), style, open, ...(choice && style === "dots" ? { designs: steps.map(({ k }) => k) } : {}) });
  const violated = history.filter(({ violation }) => violation > VIOLATED), feasible = history.filter(({ violation }) => !(violation > VIOLATED));
  const chart = new CurvesChart({
    kind: "curves", title: `${y} over the iterations`, x: "iteration", y, logarithmic: low > 0 && Math.max(...values) > 100 * low ? "y" : "",
    lines: [line(history, "line"), line(feasible, "dots"), line(violated, "dots", true)],
  }, choice);
  return panel("Convergence", "convergence", chart.node, violated.length > 0 && el("p", { class: "caption note" }, "Hollow: a limit is violated."));
}
