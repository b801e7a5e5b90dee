// Cards with tables: diagnosis, parameters, events, values.

/** @import { Bounds, Child, Diagnosis, Fact, Message, Parameter, Payload } from "./types.d.ts" */
/** @import { Player } from "./player.js" */
/** @import { Timeline } from "./timeline.js" */

import { el } from "./dom.js";
import { clamp, clock, isNum, list, minus, number } from "./numbers.js";
import { raised, unitOf } from "./units.js";

const LEVELS = { info: "Note", warning: "Warning", error: "Error" };

/** @param {Message} message */
const levelOf = ({ level }) => /** @type {keyof typeof LEVELS} */ (level && level in LEVELS ? level : "info");

/** Card with a title. @param {string} title @param {string} id @param {...Child} children */
export function panel(title, id, ...children) {
  return el("section", { class: "card panel", id, "aria-labelledby": `${id}-title` }, el("h2", { id: `${id}-title` }, title), ...children);
}

/** Content that scrolls. @param {string} label @param {Child} content */
export const scrollable = (label, content, look = "scroll") => el("div", { class: look, tabindex: "0", role: "region", "aria-label": label }, content);

/** Labels and their values. @param {Fact[] | undefined} facts */
export const pairs = (facts) => el("dl", { class: "pairs" }, list(facts).map(({ label, value }) =>
  el("div", {}, el("dt", {}, String(label ?? "")), el("dd", { class: String(value ?? "").length <= 22 ? "short" : "" }, raised(value ?? "–")))));

/** @param {Diagnosis | undefined} diagnosis */
export function diagnosisPanel(diagnosis) {
  if (!diagnosis) return null;
  const messages = list(diagnosis.messages).map((message) =>
    el("li", { class: levelOf(message) }, el("b", {}, LEVELS[levelOf(message)]), el("span", {}, String(message.text ?? ""))));
  return panel("Diagnosis", "diagnosis",
    diagnosis.summary && el("p", { class: "summary" }, String(diagnosis.summary)),
    messages.length > 0 && el("ul", { class: "messages" }, messages),
    list(diagnosis.items).length > 0 && pairs(diagnosis.items));
}

/** Outcome at the head of the page: of the decision, else the summary of the diagnosis.
 * @param {HTMLElement} node @param {Diagnosis | undefined} diagnosis @param {Payload["verdict"]} outcome */
export function verdict(node, diagnosis, outcome) {
  if (!outcome && !diagnosis?.summary) return;
  node.hidden = false;
  if (outcome) {
    node.append(el("i", { class: "dot" }), el("span", {}, raised(outcome.text)));
    if (!outcome.success) node.classList.add("warning");
    node.removeAttribute("href");
    return;
  }
  const levels = list(diagnosis?.messages).map(levelOf);
  const worst = levels.includes("error") ? "error" : levels.includes("warning") ? "warning" : "info";
  const count = levels.filter((level) => level === worst).length;
  node.classList.add(worst);
  node.append(el("i", { class: "dot" }), el("span", {}, String(diagnosis?.summary)));
  if (worst !== "info") node.append(el("b", {}, `${count} ${LEVELS[worst].toLowerCase()}${count > 1 ? "s" : ""}`));
}

/** @param {Parameter[]} parameters */
export function parameterPanel(parameters) {
  if (!parameters.length) return null;
  const headings = ["Name", "Value", "Unit", "Range", "Description"].map((text, k) => el("th", { scope: "col", class: k === 1 ? "right" : "" }, text));
  const rows = parameters.map((parameter) => el("tr", {},
    el("th", { scope: "row" }, String(parameter.name ?? "")),
    el("td", { class: "right" }, number(parameter.value, 6).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "")),
    unitCell(unitOf(parameter)),
    el("td", {}, rangeBar(parameter)),
    el("td", { class: "wide" }, String(parameter.description ?? ""))));
  return panel("Parameters", "parameters", scrollable("Parameters", el("table", {}, el("thead", {}, el("tr", {}, headings)), el("tbody", {}, rows))));
}

/** @param {string} unit */
const unitCell = (unit) => el("td", { class: "unit" }, unit === "1" ? "–" : raised(unit));

/** Position of a value between its bounds. @param {Bounds} bounds @param {...Child} marks further marks */
export function rangeBar({ value, lower, upper }, ...marks) {
  if (!isNum(lower) || !isNum(upper) || !(upper > lower)) return "–";
  const bar = el("span", { class: "bar" }, ...marks);
  bar.style.setProperty("--p", String(isNum(value) ? clamp((value - lower) / (upper - lower), 0, 1) : 0));
  const short = (/** @type {number} */ x) => minus(String(+x.toPrecision(4)));
  return el("span", { class: "range" }, el("small", {}, short(lower)), bar, el("small", {}, short(upper)));
}

/** @param {Timeline} motion @param {Player} player */
export function eventPanel(motion, player) {
  if (!motion.events.length || !motion.moves) return null;
  return panel("Events", "events", el("div", { class: "event-list" }, motion.events.map(({ name, time }) => el("button",
    { type: "button", class: "event", onclick: () => { player.pause(); player.seek(time); } },
    el("span", {}, name), el("span", { class: "value" }, `${clock(time, motion.span)} s`)))));
}

/** Values of a result without motion. @param {Timeline} motion */
export function valuePanel(motion) {
  if (motion.moves || !motion.series.length) return null;
  const groups = motion.groups.map(([group, members]) => el("tbody", {},
    el("tr", { class: "group" }, el("th", { colspan: "3", scope: "colgroup" }, group)),
    members.map(({ name, unit, values }) => el("tr", {}, el("th", { scope: "row" }, name),
      el("td", { class: "right" }, number(motion.n ? values[0] : NaN, 6)), unitCell(unit)))));
  return panel("Values", "values", scrollable("Values", el("table", {}, groups)));
}
