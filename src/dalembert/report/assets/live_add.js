// Menu of a live page that adds a response of a series.

/** @import { LiveData, LiveResponse, LiveTerm } from "./types.d.ts" */

import { el, icon, menu } from "./dom.js";
import { list } from "./numbers.js";
import { payload } from "./payload.js";

/** Upper limit of the responses that are listed by default. */
const MAX_RESPONSES = 6;

/** Reductions and their names in a label. @type {[LiveTerm["kind"], string][]} */
const REDUCTIONS = [["maximum", "maximum"], ["minimum", "minimum"], ["final", "final value"], ["mean", "mean"], ["rms", "rms"], ["integral", "integral"]];

/** Series with a row: name, unit, group and number of the row. @param {LiveData} live */
function measuredSeries(live) {
  const series = list(payload.series);
  return live.columns.filter(([path]) => path[0] === "series").map(([[, k], row]) => {
    const { name = "", unit = "", group = "other" } = series[Number(k)] ?? {};
    return { name: String(name), unit: unit === "1" ? "" : String(unit), group: String(group || "other"), row };
  });
}

/** Whether results have a single instant, such as equilibria. */
const single = () => list(payload.time).length <= 1;

/** Value of a series in a state. @param {ReturnType<typeof measuredSeries>[number]} series @param {number} instant @returns {LiveResponse} */
function responseOfState({ name, unit, row }, instant) {
  const { kind, numbers } = /** @type {import("./scene_types.d.ts").States} */ (payload.states);
  return { label: `${name} of ${kind} ${numbers?.[instant]}`, unit, terms: [{ kind: "at", row, weight: 1, instant }] };
}

/** @param {ReturnType<typeof measuredSeries>[number]} series @param {LiveTerm["kind"]} kind @returns {LiveResponse} */
function responseOfSeries({ name, unit, row }, kind) {
  const text = REDUCTIONS.find(([key]) => key === kind)?.[1], integral = kind === "integral" ? (unit ? `${unit} s` : "s") : unit;
  return { label: single() ? name : `${text} of ${name}`, unit: integral, terms: [{ kind, row, weight: 1 }] };
}

/** Responses of the page, by default the maxima of the plotted series; of an equilibrium, angles and reactions. @param {LiveData} live */
export function firstResponses(live) {
  if (live.responses?.length) return live.responses;
  const series = measuredSeries(live), plotted = list(payload.default_plots).flat();
  if (single()) return series.filter(({ name }) => /\.(?:angle|force_norm)$/.test(name)).map((s) => responseOfSeries(s, "final")).slice(0, MAX_RESPONSES);
  const moves = new Set(list(payload.series).filter(({ values }) => Array.from(values ?? []).some((value) => value)).map(({ name }) => name));  // others are zero
  return plotted.flatMap((name) => series.filter((s) => s.name === name && moves.has(name)).map((s) => responseOfSeries(s, "maximum"))).slice(0, MAX_RESPONSES);
}

/** @param {LiveData} live @param {(response: LiveResponse) => void} add */
export function addMenu(live, add) {
  const series = measuredSeries(live);
  if (!series.length) return null;
  const groups = [...new Set(series.map(({ group }) => group))];
  const { states } = payload, choices = states ? Array.from(list(states.numbers), (number, k) => [String(k), `${states.kind} ${number}`]) : REDUCTIONS.filter(([key]) => key === "final" || !single());
  const kind = el("select", { "aria-label": states ? "State" : "Reduction over time" }, choices.map(([key, text]) => el("option", { value: key }, text)));
  const chosen = () => (states ? responseOfState(series[Number(measure.value)], Number(kind.value)) : responseOfSeries(series[Number(measure.value)], /** @type {LiveTerm["kind"]} */ (kind.value)));
  const options = groups.map((group) => el("optgroup", { label: group }, series.flatMap((s, k) => (s.group === group ? [el("option", { value: String(k) }, s.name)] : []))));
  const measure = el("select", { class: "measure", "aria-label": "Series" }, options);
  const button = el("button", { type: "button", class: "button primary menu-item", id: "add-response-now", onclick: () => add(chosen()) }, "Add");
  const box = menu([icon("plus"), "Add"], [el("div", { class: "add-response" }, states ? kind : !single() && [kind, el("span", { class: "caption" }, "of")], measure, button)], { class: "button", id: "add-response", "aria-label": "Add a response" });
  box.addEventListener("keydown", (event) => { if (event.key !== "Escape") event.stopPropagation(); });
  return box;
}
