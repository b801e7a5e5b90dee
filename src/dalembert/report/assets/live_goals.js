// Goals of an improvement: one objective, and limits of other responses.

/** @import { LiveResponse } from "./types.d.ts" */

import { el } from "./dom.js";
import { isNum, tidy } from "./numbers.js";
import { Signal } from "./theme.js";

/** @typedef {"" | "minimise" | "maximise" | "atMost" | "atLeast"} GoalKind */
/** @typedef {{ kind: GoalKind, limit: number }} Goal */

/** @type {[GoalKind, string][]} */
const GOALS = [["", "–"], ["minimise", "minimise"], ["maximise", "maximise"], ["atMost", "≤"], ["atLeast", "≥"]];

/** Number in a text with true minus signs or a decimal comma; NaN for other texts. @param {string} text */
export const numberIn = (text) => (text.trim() ? Number(text.trim().replace("−", "-").replace(",", ".")) : NaN);

export class Goals {
  /** @param {(response: LiveResponse) => number} valueOf present value of a response */
  constructor(valueOf) {
    this.valueOf = valueOf;
    /** @type {Map<LiveResponse, Goal>} */
    this.goals = new Map();
    /** @type {Signal} */
    this.onChange = new Signal();
    /** Controls that show the goals. @type {Map<LiveResponse, () => void>} */
    this.updates = new Map();
  }

  /** @param {LiveResponse} response */
  of(response) { return this.goals.get(response) ?? { kind: /** @type {GoalKind} */ (""), limit: NaN }; }

  /** Set the goal of a response; there is one objective. @param {LiveResponse} response @param {GoalKind} kind @param {number} [limit] */
  set(response, kind, limit) {
    if (kind === "minimise" || kind === "maximise") for (const [other, goal] of this.goals) if (other !== response && (goal.kind === "minimise" || goal.kind === "maximise")) this.goals.set(other, { ...goal, kind: "" });
    const before = this.of(response).limit;
    this.goals.set(response, { kind, limit: limit ?? (isNum(before) ? before : this.valueOf(response)) });
    for (const update of this.updates.values()) update();
    this.onChange.emit();
  }

  /** Cell of the table with the goal of a response. @param {LiveResponse} response */
  cell(response) {
    const select = el("select", { "aria-label": `Goal of ${response.label}`, onchange: () => this.set(response, /** @type {GoalKind} */ (select.value)) }, GOALS.map(([kind, text]) => el("option", { value: kind }, text)));
    const entry = el("input", { type: "text", inputmode: "decimal", class: "entry", "aria-label": `Limit of ${response.label}` });
    entry.addEventListener("change", () => {
      const limit = numberIn(entry.value);
      if (isNum(limit)) this.set(response, this.of(response).kind, limit); else update();
    });
    const update = () => {
      const { kind, limit } = this.of(response);
      select.value = kind;
      entry.hidden = kind !== "atMost" && kind !== "atLeast";
      entry.value = tidy(limit, 6);
    };
    for (const node of [select, entry]) node.addEventListener("keydown", (event) => event.stopPropagation());
    this.updates.set(response, update);
    update();
    return el("span", { class: "goal" }, select, entry);
  }

  /** The objective and the limits of listed responses. @param {LiveResponse[]} responses */
  among(responses) {
    const set = responses.map((response, k) => ({ k, response, ...this.of(response) }));
    return { objective: set.find(({ kind }) => kind === "minimise" || kind === "maximise") ?? null, limits: set.filter(({ kind, limit }) => (kind === "atMost" || kind === "atLeast") && isNum(limit)) };
  }
}
