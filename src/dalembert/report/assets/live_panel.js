// Parameters of a live page: a slider for each, with the slope of the selected response.

/** @import { LiveResponse } from "./types.d.ts" */
/** @import { Design } from "./live_design.js" */

import { el, icon, iconButton } from "./dom.js";
import { numberIn } from "./live_goals.js";
import { clamp, tidy } from "./numbers.js";
import { raised, withUnit } from "./units.js";

/** Steps of a slider, and the number of parameters from which they can be searched. */
const STEPS = 1000, SEARCHED = 12;
/** Keys that move a slider. */
const MOVES = new Set(["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "PageUp", "PageDown", "Home", "End"]);

/** Row of a parameter. */
class ParameterRow {
  /** @param {Design} design @param {number} k @param {(text: string, kind?: string) => void} say */
  constructor(design, k, say) {
    this.design = design;
    this.k = k;
    this.say = say;
    const { name, unit, description, lower, upper } = design.parameters[k], [low, high] = design.range(k);
    this.low = low;
    this.high = high;
    const id = `parameter-${k}`;
    this.slider = el("input", { type: "range", min: "0", max: String(STEPS), step: "1", id, "aria-label": labelOf(name, unit) });
    this.entry = el("input", { type: "text", inputmode: "decimal", class: "entry", "aria-label": `Value of ${labelOf(name, unit)}` });
    this.lock = el("button", { type: "button", class: "icon tiny lock", "aria-pressed": "false", title: `Keep ${name} fixed when the page improves the design`, "aria-label": `Lock ${name}`, onclick: () => this.toggleLock() }, icon("lock"));
    this.back = iconButton("back", `Initial value of ${name}`, () => this.change(design.initial[k]), { class: "icon tiny" });
    this.bar = el("i", { class: "slope-bar" });
    this.slope = el("span", { class: "slope" }, this.bar);
    const bounds = [lower, upper].map((bound, end) => (bound === null || bound === undefined ? "no bound" : `${end ? "at most" : "at least"} ${withUnit(tidy(bound / this.factor), unit)}`));
    const end = (/** @type {number} */ value, /** @type {unknown} */ bound) => el("small", { class: "bound" }, bound === null || bound === undefined ? "" : tidy(value / this.factor, 4));
    this.node = el("div", { class: "parameter", title: [description, bounds.join(", ")].filter(Boolean).join(": ") },
      el("label", { for: id }, name), end(low, lower), el("span", { class: "track" }, this.slider), end(high, upper),
      el("span", { class: "value" }, this.entry, el("small", {}, raised(unit && unit !== "1" ? unit : ""))), el("span", { class: "row-tools" }, this.lock, this.back), this.slope);
    this.slider.addEventListener("pointerdown", () => design.begin());
    this.slider.addEventListener("keydown", (event) => { if (!event.repeat && MOVES.has(event.key)) design.begin(); if (event.key !== "Tab") event.stopPropagation(); });
    this.slider.addEventListener("input", () => {
      const step = Number(this.slider.value);
      design.set(k, step === STEPS ? high : step === 0 ? low : low + (step / STEPS) * (high - low));
    });
    this.entry.addEventListener("change", () => this.enter());
    this.entry.addEventListener("keydown", (event) => event.stopPropagation());
    this.update();
  }

  get factor() { return this.design.parameters[this.k].factor; }

  /** Take the typed value, which may end with the unit. */
  enter() {
    const { name, unit } = this.design.parameters[this.k], typed = this.entry.value.trim();
    const units = unit && unit !== "1" ? [unit, raised(unit)] : [], suffix = units.find((text) => typed.endsWith(text)), value = numberIn(suffix ? typed.slice(0, -suffix.length) : typed);
    if (Number.isFinite(value)) {
      this.change(value * this.factor);
      const taken = this.design.values[this.k] / this.factor;
      if (Math.abs(taken - value) > 1e-9 * Math.abs(value)) this.say(`${name} is ${taken < value ? "at most" : "at least"} ${withUnit(tidy(taken), unit)}`, "warning");
    } else if (typed) this.say(`“${typed.slice(0, 40)}” is not a number${units.length ? ` in ${raised(unit)}` : ""}; ${name} stays ${withUnit(tidy(this.design.values[this.k] / this.factor), unit)}`, "warning");
    this.entry.value = tidy(this.design.values[this.k] / this.factor, 6);
  }

  /** @param {number} value */
  change(value) {
    this.design.begin();
    this.design.set(this.k, value);
    this.update();
  }

  toggleLock() {
    const on = !this.design.locked[this.k];
    this.design.locked[this.k] = on;
    this.lock.setAttribute("aria-pressed", String(on));
  }

  update() {
    const value = this.design.values[this.k], share = clamp((value - this.low) / (this.high - this.low || 1), 0, 1), text = tidy(value / this.factor, 6);
    this.slider.value = String(Math.round(STEPS * share));
    this.slider.style.setProperty("--p", String(share));
    this.slider.setAttribute("aria-valuetext", withUnit(text, this.design.parameters[this.k].unit));
    if (document.activeElement !== this.entry) this.entry.value = text;
    this.node.classList.toggle("changed", value !== this.design.initial[this.k]);
  }

  /** Change of a response for one hundredth of the range. @param {number} slope @param {number} most @param {LiveResponse} response */
  showSlope(slope, most, response) {
    const { unit, name } = this.design.parameters[this.k], part = (slope * (this.high - this.low)) / 100, share = most > 0 ? clamp(part / most, -1, 1) : 0;
    this.bar.style.setProperty("--s", String(Math.abs(share)));
    this.bar.classList.toggle("negative", share < 0);
    const per = `${response.unit && response.unit !== "1" ? raised(response.unit) : ""}${unit && unit !== "1" ? ` / ${raised(unit)}` : ""}`;
    this.slope.title = `∂(${response.label}) / ∂${name} = ${tidy(slope * this.factor, 5)} ${per}; one hundredth of the range changes it by ${withUnit(tidy(part, 4), response.unit)}`;
    this.slope.setAttribute("aria-label", this.slope.title);
  }
}

/** @param {string} name @param {string} unit */
const labelOf = (name, unit) => (unit && unit !== "1" ? `${name} in ${unit}` : name);

export class ParameterPanel {
  /** @param {Design} design */
  constructor(design) {
    this.design = design;
    this.rows = design.parameters.map((_, k) => new ParameterRow(design, k, (text, kind) => this.say(text, kind)));
    /** Rows of the parameters that have sliders. */
    this.shown = this.rows.filter(({ k }) => !design.parameters[k].drawn);
    this.search = el("input", { type: "search", id: "search-parameters", placeholder: "Search parameters", "aria-label": "Search parameters", autocomplete: "off", spellcheck: "false", hidden: this.shown.length < SEARCHED, oninput: () => this.filter() });
    this.search.addEventListener("keydown", (event) => event.stopPropagation());
    this.undo = iconButton("undo", "Undo", () => design.undo(), { id: "undo" });
    this.redo = iconButton("redo", "Redo", () => design.redo(), { id: "redo" });
    this.reset = el("button", { type: "button", class: "button", id: "reset-design", onclick: () => design.reset() }, icon("back"), "Reset");
    this.status = el("p", { class: "live-status", role: "status", "aria-live": "polite" });
    this.elapsed = el("span");
    this.progress = el("p", { class: "caption live-progress", hidden: true }, el("i"), this.elapsed);
    this.tools = el("div", { class: "live-tools" }, this.undo, this.redo, this.reset);
    this.node = el("div", {}, el("div", { class: "plot-head" }, el("h2", {}, "Parameters"), this.tools), this.search, el("div", { class: "parameters" }, this.shown.map(({ node }) => node)), this.progress, this.status);
    design.onChange.on(() => { this.update(); if (!this.failed) this.say(""); });
    this.update();
  }

  update() {
    for (const row of this.rows) row.update();
    this.undo.toggleAttribute("disabled", !this.design.past.length);
    this.redo.toggleAttribute("disabled", !this.design.future.length);
    this.reset.toggleAttribute("disabled", !this.design.changed);
  }

  /** Show the parameters whose name or description contains all words. */
  filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    this.rows.forEach((row, k) => {
      const { name, description = "" } = this.design.parameters[k], text = `${name} ${description}`.toLowerCase();
      row.node.hidden = !words.every((word) => text.includes(word));
    });
  }

  /** @param {ArrayLike<number> | null} slopes @param {LiveResponse | null} response */
  showSlopes(slopes, response) {
    this.node.classList.toggle("with-slopes", Boolean(slopes && response));
    if (!slopes || !response) return;
    const most = Math.max(...this.shown.map(({ k, low, high }) => Math.abs(slopes[k] * (high - low)) / 100));
    this.rows.forEach((row, k) => row.showSlope(slopes[k], most, response));
  }

  /** Show that a run takes long. @param {number | null} time since its start [ms] @param {number} usual duration of the last run [ms] */
  busy(time, usual) {
    this.node.classList.toggle("busy", time !== null);
    this.progress.hidden = time === null;
    if (time !== null) this.elapsed.textContent = `computing, ${(time / 1000).toFixed(1)} s${usual > time ? ` of about ${(usual / 1000).toFixed(1)} s` : ""}`;
  }

  /** Whether the message is that of a design that failed. */
  get failed() { return this.status.classList.contains("error"); }

  /** @param {string} text @param {string} [kind] */
  say(text, kind = "") {
    this.status.textContent = text;
    this.status.className = `live-status ${kind}`;
  }
}
