// Improvement of a live page: goals, the iterations of an optimisation, their history.

/** @import { LiveResponse } from "./types.d.ts" */
/** @import { Design } from "./live_design.js" */
/** @import { Evaluated, Iterate, Outcome } from "./live_optimizer.js" */
/** @import { Solver } from "./live_solver.js" */
/** @import { ResponseTable } from "./live_table.js" */

import { el, icon, shape, toggleButton } from "./dom.js";
import { Goals } from "./live_goals.js";
import { minimised } from "./live_optimizer.js";
import { changeText } from "./live_table.js";
import { clamp, extent, tidy } from "./numbers.js";
import { withUnit } from "./units.js";

/** Number of peaks of a maximum over the frequency that an improvement distinguishes, and the largest level of all in maxima at the start. */
const PEAKS = 3, LEVEL = 2;

/** Peaks of the maximum over the frequency that is minimised: its kinks lie where peaks are equal. @param {LiveResponse} response @param {string} kind of the analysis @returns {LiveResponse[]} */
function peaksOf({ terms: [term, ...others], ...rest }, kind) {
  const single = kind === "frequency" && term?.kind === "maximum" && term.weight > 0 && !others.length;
  return single ? Array.from({ length: PEAKS }, (_, k) => ({ ...rest, terms: [{ ...term, kind: "top", count: PEAKS, number: k + 1 }] })) : [];
}

/** Time for which an iteration is shown [ms]. */
const PAUSE = 60;
/** Size of the chart of the history. */
const CHART = { w: 300, h: 70, edge: 8 };
/** Largest excess over a limit that counts as satisfied, relative to the limit or to the slopes over the ranges of the parameters. */
const EXCESS = 1e-6;

/** @type {Record<Outcome, string>} */
const MESSAGES = {
  converged: "Converged", "no progress": "No further improvement", "failed designs": "Ended beside designs that cannot be computed", infeasible: "The limits cannot be satisfied together",
  stopped: "Stopped", iterations: "Not converged",
};

/** @typedef {{ values: number[], responses: number[], feasible: boolean }} Step */

export class Improvement {
  /** @param {Design} design @param {ResponseTable} table @param {Solver} solver */
  constructor(design, table, solver) {
    this.design = design;
    this.table = table;
    this.solver = solver;
    this.goals = new Goals((response) => table.values[table.responses.indexOf(response)]);
    this.running = false;
    this.halted = false;
    /** @type {Step[]} */
    this.history = [];
    /** Objective of the history. @type {{ k: number, response: LiveResponse } | null} */
    this.objective = null;
    this.column = { title: "Goal", cell: (/** @type {LiveResponse} */ response) => this.goals.cell(response) };
    this.button = el("button", { type: "button", class: "button primary", id: "improve-start", onclick: () => (this.running ? this.stop() : this.start()) });
    this.status = el("p", { class: "live-status", role: "status", "aria-live": "polite", id: "improve-status" });
    this.slider = el("input", { type: "range", min: "0", step: "1", id: "improve-history", "aria-label": "Iteration", oninput: () => this.show(Number(this.slider.value)) });
    this.slider.addEventListener("keydown", (event) => event.stopPropagation());
    this.chart = shape("svg", { viewBox: `0 0 ${CHART.w} ${CHART.h}`, preserveAspectRatio: "none", class: "improve-chart", "aria-hidden": "true" });
    this.chart.addEventListener("click", (event) => {
      const { left, width } = this.chart.getBoundingClientRect(), last = this.history.length - 1, x = ((event.clientX - left) / width) * CHART.w;
      this.show(Math.round(clamp((x - CHART.edge) / (CHART.w - 2 * CHART.edge), 0, 1) * last));
    });
    this.steps = el("div", { class: "improve-steps", hidden: true }, this.chart, el("span", { class: "track" }, this.slider));
    this.node = el("div", { class: "improve", hidden: true }, el("div", { class: "improve-head" }, this.button, this.status), this.steps);
    this.toggle = toggleButton("Improve", false, (on) => this.open(on), { id: "improve", class: "button", title: "Let the page improve the design" });
    this.goals.onChange.on(() => this.update());
    table.onList.on(() => this.update());
    design.onChange.on((origin) => { if (this.running && origin !== "improve") this.stop(); });
    this.update();
  }

  /** @param {boolean} on */
  open(on) {
    this.node.hidden = !on;
    this.table.columns = on ? [this.column] : [];
    this.table.node.classList.toggle("with-goals", on);
    this.table.fill();
    if (!on) this.stop();
  }

  update() {
    const { objective } = this.goals.among(this.table.responses), free = this.design.locked.includes(false);
    this.button.replaceChildren(icon(this.running ? "pause" : "play"), this.running ? "Stop" : "Start");
    this.button.disabled = !this.running && (!objective || !free);
    if (!objective && !this.running) this.say("Select a response to minimise or to maximise; other responses may have limits. Locked parameters are kept.");
    else if (!this.running && !this.history.length) this.say("");
  }

  /** @param {string} text @param {string} [kind] */
  say(text, kind = "") {
    this.status.textContent = text;
    this.status.className = `live-status ${kind}`;
  }

  stop() { this.halted = true; }

  async start() {
    const { design, table, solver } = this, { responses } = table, { objective, limits } = this.goals.among(responses);
    if (!objective || this.running) return;
    const free = design.parameters.flatMap((_, k) => (design.locked[k] || design.range(k)[1] === design.range(k)[0] ? [] : [k])), ranges = free.map((k) => design.range(k)), fixed = [...design.values];
    const sign = objective.kind === "minimise" ? 1 : -1, gradients = [...new Set([objective.k, table.selected, ...limits.map(({ k }) => k)])];
    const peaks = objective.kind === "minimise" ? peaksOf(objective.response, solver.data.kind) : [], level = LEVEL * Math.abs(table.values[objective.k]), levelled = peaks.length > 0 && level > 0;
    if (levelled) gradients.push(...peaks.map((_, j) => responses.length + j));
    /** @param {number[]} x */
    const valuesAt = (x) => {
      const values = [...fixed];
      free.forEach((k, i) => { values[k] = design.bounded(k, ranges[i][0] + x[i] * (ranges[i][1] - ranges[i][0])); });
      return values;
    };
    const scaled = (/** @type {ArrayLike<number>} */ slopes, /** @type {number} */ factor) => free.map((k, i) => factor * slopes[k] * (ranges[i][1] - ranges[i][0]));
    /** @type {Map<Evaluated, { answer: any, values: number[] }>} */
    const answers = new Map();
    /** @param {number[]} x @returns {Promise<Evaluated | null>} */
    const evaluate = async (x) => {
      const values = valuesAt(x), answer = await solver.request({ parameters: values, responses: levelled ? [...responses, ...peaks] : responses, gradients }, true);
      if (!answer) this.stop();
      if (!answer || "failure" in answer || !answer.result.status.success) return null;
      const { result: { values: r }, slopes } = answer, of = (/** @type {number} */ k) => slopes[k] ?? new Float64Array(values.length);
      const signs = limits.map(({ kind }) => (kind === "atMost" ? 1 : -1));
      const at = { f: sign * r[objective.k], df: scaled(of(objective.k), sign), c: limits.map(({ k, limit }, j) => signs[j] * (r[k] - limit)), dc: limits.map(({ k }, j) => scaled(of(k), signs[j])) };
      if (levelled) peaks.forEach((_, j) => {  // all peaks below a level, which is minimised
        const k = responses.length + j, top = x[free.length] * level;
        Object.assign(at, { f: top, df: [...free.map(() => 0), level] });
        at.c.push(r[k] - top);
        at.dc.push([...scaled(of(k), 1), -level]);
      });
      if (levelled) limits.forEach((_, j) => at.dc[j].push(0));
      if (![at.f, ...at.df, ...at.c, ...at.dc.flat()].every(Number.isFinite)) return null;
      answer.result.values = r.slice(0, responses.length);
      answers.set(at, { answer, values });
      return at;
    };
    /** @param {Iterate} iterate */
    const onIterate = async ({ at }) => {
      const { answer: { result, slopes }, values } = /** @type {{ answer: any, values: number[] }} */ (answers.get(at));
      answers.clear();
      answers.set(at, { answer: { result, slopes }, values });
      this.history.push({ values, responses: result.values, feasible: limits.every(({ limit }, j) => at.c[j] <= EXCESS * Math.max(Math.abs(limit), ...at.dc[j].map(Math.abs))) });
      design.replace(values, "improve");
      solver.onResult.emit(result);
      solver.onSlopes.emit({ number: result.number, slopes, jacobian: null });
      this.draw(this.history.length - 1);
      this.say(`Iteration ${this.history.length - 1}: ${objective.response.label} ${withUnit(tidy(result.values[objective.k], 5), objective.response.unit)}`);
      await new Promise((resolve) => setTimeout(resolve, PAUSE));
    };
    design.begin();
    Object.assign(this, { running: true, halted: false, history: [], objective });
    this.update();
    const start = free.map((k, i) => clamp((fixed[k] - ranges[i][0]) / (ranges[i][1] - ranges[i][0]), 0, 1));
    if (levelled) start.push(1 / LEVEL);
    const { outcome, iterations, failures } = await minimised(start, evaluate, onIterate, () => this.halted);
    this.running = false;
    this.update();
    this.report(outcome, iterations, failures);
  }

  /** Message about the end. @param {Outcome} outcome @param {number} iterations @param {number} failures */
  report(outcome, iterations, failures) {
    const { history, objective } = this, first = history[0], last = history.at(-1);
    if (!first || !last || !objective) { this.say(outcome === "stopped" ? "Stopped" : "The present design cannot be computed", outcome === "stopped" ? "" : "error"); return; }
    const [before, after] = [first, last].map(({ responses }) => responses[objective.k]), { label, unit } = objective.response, change = changeText(after, before);
    const numbers = `${label} ${tidy(before, 5)} → ${withUnit(tidy(after, 5), unit)}${change ? ` (${change})` : ""}`;
    const broken = last.feasible ? "" : " Not all limits are satisfied.", lost = failures ? ` ${failures} design${failures > 1 ? "s" : ""} on the way could not be computed.` : "";
    this.say(`${MESSAGES[outcome]} after ${iterations} iteration${iterations === 1 ? "" : "s"}: ${numbers}.${broken}${lost}`, outcome === "converged" && last.feasible ? "good" : outcome === "stopped" || outcome === "no progress" ? "" : "warning");
  }

  /** Show the design of an iteration. @param {number} k */
  show(k) {
    const step = this.history[k];
    if (!step || this.running) return;
    this.design.begin();
    this.design.replace(step.values, "history");
    this.draw(k);
  }

  /** Draw the history with a mark at an iteration. @param {number} at */
  draw(at) {
    const { history, objective } = this, { w, h, edge } = CHART;
    if (!objective) return;
    this.steps.hidden = history.length < 2;
    const values = history.map(({ responses }) => responses[objective.k]), [low, high] = extent([values]) ?? [0, 1], last = Math.max(1, history.length - 1);
    const place = (/** @type {number} */ k) => [edge + (k / last) * (w - 2 * edge), h - edge - ((values[k] - low) / (high - low || 1)) * (h - 2 * edge)];
    const dot = (/** @type {number} */ k, /** @type {string} */ look) => { const [x, y] = place(k); return shape("path", { d: `M${x} ${y}h0.01`, class: look }); };
    this.chart.replaceChildren(
      shape("polyline", { points: values.map((_, k) => place(k).join(",")).join(" ") }),
      ...history.map(({ feasible }, k) => dot(k, feasible ? "dot" : "dot violated")), dot(at, "dot present"));
    this.slider.max = String(history.length - 1);
    this.slider.value = String(at);
    this.slider.style.setProperty("--p", String(at / last));
    this.slider.setAttribute("aria-valuetext", `iteration ${at}: ${withUnit(tidy(values[at], 5), objective.response.unit)}`);
  }
}
