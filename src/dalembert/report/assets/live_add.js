// Menu of a live page that adds a response of a series.

/** @import { LiveData, LiveResponse, LiveTerm } from "./types.d.ts" */

import { el, icon, menu } from "./dom.js";
import { list } from "./numbers.js";
import { payload } from "./payload.js";

/** Upper limit of the responses that are listed by default. */
const MAX_RESPONSES = 6;

/** Reductions over time and their names in a label. @type {[LiveTerm["kind"], string][]} */
const REDUCTIONS = [["maximum", "maximum"], ["minimum", "minimum"], ["final", "final value"], ["mean", "mean"], ["rms", "rms"], ["integral", "integral"]];

/** Quantity with a row: name, unit, group of the menu and number of the row.
 * @typedef {{ name: string, unit: string, group: string, row: number }} Measured */

/** Way to make one number of the values of a quantity.
 * @typedef {{ text: string, kind: LiveTerm["kind"], instant?: number, number?: number }} Reduction */

/** Series over time, or parts of amplitudes over the frequency. @param {LiveData} live @returns {Measured[]} */
function measuredSeries(live) {
  if (live.measured) return live.measured;
  const series = list(payload.series);
  return live.columns.filter(([path]) => path[0] === "series").map(([[, k], row]) => {
    const { name = "", unit = "", group = "other" } = series[Number(k)] ?? {};
    return { name: String(name), unit: unit === "1" ? "" : String(unit), group: String(group || "other"), row };
  });
}

/** Displacements of nodes and quantities of elements of a structure. @param {LiveData} live @returns {Measured[]} */
function measuredStates(live) {
  const { nodes = [], elements = [] } = payload.scene?.mesh ?? {}, directions = list(payload.directions), fields = list(payload.scene?.fields);
  if (payload.states?.kind === "mode") return [];  // shapes have no absolute scale
  return list(live.states).flatMap(([[place, , k], rows]) => {
    const { name = "", unit = "" } = fields[Number(k)] ?? {};
    if (place === "scene" && rows.length === elements.length && name) return rows.map((row, i) => ({ name: `${elements[i]}.${name}`, unit, group: name.replaceAll("_", " "), row })).filter(({ row }) => row >= 0);
    if (place !== "displacements") return [];
    return list(payload.numbers).flatMap((number, i) => {
      const row = rows[number] ?? -1, direction = directions[i % directions.length];
      return row < 0 ? [] : [{ name: `${nodes[Math.floor(i / directions.length)]}.${direction}`, unit: direction.startsWith("u") ? "m" : "rad", group: "displacements", row }];
    });
  });
}

/** Whether results have a single instant, such as equilibria. */
const single = () => list(payload.states?.numbers ?? payload.time).length <= 1;

/** Reductions over time, or over load cases and one for each state; of modes, one for each. @returns {Reduction[]} */
function reductions() {
  if (single()) return [{ text: "", kind: "final" }];
  const { states } = payload;
  if (states?.kind === "frequency") return [...REDUCTIONS.slice(0, 2).map(([kind, text]) => ({ text, kind })), ...[1, 2, 3].map((number) => ({ text: `peak ${number}`, kind: /** @type {const} */ ("peak"), number }))];
  if (!states) return REDUCTIONS.map(([kind, text]) => ({ text, kind }));
  const each = list(states.names).map((name, instant) => ({ text: states.values ? `${states.kind} ${states.numbers?.[instant]}` : String(name), kind: /** @type {const} */ ("at"), instant }));
  return states.values ? each : [...REDUCTIONS.slice(0, 2).map(([kind, text]) => ({ text, kind })), ...each];
}

/** @param {Measured} measured @param {Reduction} reduction @returns {LiveResponse} */
function responseOfSeries({ name, unit, row }, { text, kind, instant, number }) {
  const integral = kind === "integral" ? (unit ? `${unit} s` : "s") : unit;
  const label = !text ? name : kind === "at" ? `${name}${payload.states?.values ? " of" : ","} ${text}` : `${text} of ${name}`;
  return { label, unit: integral, terms: [{ kind, row, weight: 1, instant, number }] };
}

/** Responses of the page, by default the maxima of the plotted series; of an equilibrium, angles, reactions and signals. @param {LiveData} live */
export function firstResponses(live) {
  if (live.responses?.length) return live.responses;
  const series = measuredSeries(live), plotted = list(payload.default_plots).flat();
  if (single()) return series.filter(({ name, group }) => group === "signals" || /\.(?:angle|force_norm)$/.test(name)).map((s) => responseOfSeries(s, { text: "", kind: "final" })).slice(0, MAX_RESPONSES);
  const moves = new Set(list(payload.series).filter(({ values }) => Array.from(values ?? []).some((value) => value)).map(({ name }) => name));  // others are zero
  return plotted.flatMap((name) => series.filter((s) => s.name === name && moves.has(name)).map((s) => responseOfSeries(s, { text: "maximum", kind: "maximum" }))).slice(0, MAX_RESPONSES);
}

/** @param {LiveData} live @param {(response: LiveResponse) => void} add */
export function addMenu(live, add) {
  const series = [...measuredSeries(live), ...measuredStates(live)], choices = reductions();
  if (!series.length) return null;
  const groups = [...new Set(series.map(({ group }) => group))], over = payload.states?.kind === "frequency" ? "Reduction over frequency" : payload.states?.values ? "Mode" : payload.states ? "Load case" : "Reduction over time";
  const kind = el("select", { "aria-label": over }, choices.map(({ text, kind }, k) => el("option", { value: payload.states ? String(k) : kind }, text)));
  const chosen = () => choices[kind.selectedIndex] ?? choices[0];
  const options = groups.map((group) => el("optgroup", { label: group }, series.flatMap((s, k) => (s.group === group ? [el("option", { value: String(k) }, s.name)] : []))));
  const measure = el("select", { class: "measure", "aria-label": payload.states ? "Quantity" : "Series" }, options);
  const button = el("button", { type: "button", class: "button primary menu-item", id: "add-response-now", onclick: () => add(responseOfSeries(series[Number(measure.value)], chosen())) }, "Add");
  const box = menu([icon("plus"), "Add"], [el("div", { class: "add-response" }, !single() && [kind, el("span", { class: "caption" }, "of")], measure, button)], { class: "button", id: "add-response", "aria-label": "Add a response" });
  box.addEventListener("keydown", (event) => { if (event.key !== "Escape") event.stopPropagation(); });
  return box;
}
