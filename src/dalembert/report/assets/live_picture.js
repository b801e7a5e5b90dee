// Drawing and plots of a live page: the result of the present design, with other designs behind it.

/** @import { Dimension } from "./scene_types.d.ts" */
/** @import { LiveData, LiveResult, SeriesData } from "./types.d.ts" */
/** @import { Motion } from "./motion.js" */
/** @import { Board } from "./plot_board.js" */
/** @import { Player } from "./player.js" */
/** @import { Scene } from "./scene.js" */

import { stateCharts } from "./charts.js";
import { byId, el, toggleButton } from "./dom.js";
import { Ghosts, designSnapshot } from "./live_ghosts.js";
import { clamp, list } from "./numbers.js";
import { valuePanel } from "./panels.js";
import { payload } from "./payload.js";

/** Threshold of round-off, relative to the largest value of a unit. */
const ROUND_OFF = 1e-14;

/** Set values of series at round-off level to zero, except errors and violations, as Python does. @param {SeriesData[]} series */
function zeroRounding(series) {
  const physical = series.filter(({ name = "" }) => !/violation$|_error$/.test(name));
  /** @type {Map<string, number>} */
  const largest = new Map();
  const columns = physical.map(({ unit = "", values }) => ({ unit, values: /** @type {Float64Array} */ (values) }));
  for (const { unit, values } of columns) {
    let most = largest.get(unit) ?? 0;
    for (let i = 0; i < values.length; i++) { const size = Math.abs(values[i]); if (size > most && size < Infinity) most = size; }
    largest.set(unit, most);
  }
  for (const { unit, values } of columns) {
    const least = ROUND_OFF * (largest.get(unit) ?? 0);
    for (let i = 0; i < values.length; i++) if (Math.abs(values[i]) < least) values[i] = 0;
  }
}

/** Duration of a run and its picture above which a drag shows the first instant alone [ms]. */
const BUDGET = 10;

export class LivePicture {
  /** @param {LiveData} live @param {{ motion: Motion, scene: Scene, player: Player, board: Board | null }} page @param {Dimension} dimension */
  constructor(live, { motion, scene, player, board }, dimension) {
    this.live = live;
    this.motion = motion;
    this.scene = scene;
    this.player = player;
    this.board = board;
    this.dimension = dimension;
    this.ghosts = new Ghosts();
    /** Result that is drawn. @type {LiveResult | null} */
    this.result = null;
    /** Time that the last whole picture took, its run included [ms]; whether the payload has columns that the first instant may change. */
    this.took = 0;
    this.own = false;
    this.initial = live.parameters.map(({ value }) => value);
    this.toggle = toggleButton("Initial design", true, (on) => { this.ghosts.compares = on; this.renew(); }, { id: "ghosts", hidden: true });
    byId("toolbar").querySelector(".chips")?.prepend(this.toggle);
    /** Frequencies of the drawn states, and whether they are peaks. @type {{ values: number[], peaks: boolean[] }} */
    this.shown = { values: [], peaks: [] };
    /** The same in the payload. */
    this.drawn = this.shown;
    this.dashed = el("span");
    this.caption = el("p", { class: "caption other-run", hidden: true }, el("i", { class: "dashes" }), this.dashed);
    (board?.stack ?? document.querySelector(".beside"))?.before(this.caption);
    this.note = el("p", { class: "caption live-note", hidden: true }, "Diagnosis, statistics and parameters below are those of the initial design.");
    byId("panels").before(this.note);
  }

  /** Whether the design that is drawn differs from the initial one. */
  get changed() { return this.initial.some((value, k) => this.result !== null && value !== this.result.parameters[k]); }

  /** Show a result. @param {LiveResult} result */
  show(result) {
    const begin = performance.now();
    this.put(result);
    this.result = result;
    this.renew();
    this.took = performance.now() - begin + result.duration;
  }

  /** Whether a drag is faster where only the first instant is computed and drawn, which is shown. Drags in the plane read parts that it would change. */
  get slow() {
    const { live: { states = [], blocks = [] }, motion, player, took } = this;
    return took > BUDGET && motion.dimension === 3 && !motion.mesh && !motion.swings && !states.length && !blocks.length && !player.playing && motion.now === motion.start;
  }

  /** Show the first instant of another design, whose motion follows: the same parts at their new places. @param {LiveResult} result */
  showFirst({ table, numbers }) {
    const { live, motion, scene } = this, { columns, numbers: places } = live;
    const owner = (/** @type {(string | number)[]} */ place) => place.slice(0, -1).reduce((part, key) => part[key], /** @type {any} */ (payload));
    for (const [place, row] of columns) {
      const values = owner(place), key = /** @type {string} */ (place.at(-1));
      if (!this.own) values[key] = Float64Array.from(values[key]);  // other designs keep theirs
      values[key][0] = table[row];
    }
    places.forEach((place, k) => { owner(place)[/** @type {string} */ (place.at(-1))] = numbers[k]; });
    this.own = true;
    motion.follow(new this.dimension.Motion(payload, this.dimension));
    scene.refit();
  }

  /** Compare with a result, that of the initial design. @param {LiveResult} result */
  compareWith(result) {
    this.put(result);
    this.ghosts.initial = designSnapshot("initial design");
  }

  /** Put a result into the payload. @param {LiveResult} result */
  put(result) {
    const { table, times, numbers, drawn } = result;
    this.own = false;
    const n = times.length, count = drawn?.length ?? n, column = (/** @type {number} */ k) => drawn?.[k] ?? k, { columns, numbers: places, states = [], blocks = [] } = this.live;
    const at = (/** @type {(string | number)[]} */ place) => place.reduce((owner, key) => owner[key], /** @type {any} */ (payload));
    const put = (/** @type {(string | number)[]} */ place, /** @type {unknown} */ value) => { at(place.slice(0, -1))[/** @type {string} */ (place.at(-1))] = value; };
    for (const [place, row] of columns) put(place, table.subarray(n * row, n * (row + 1)));
    for (const [place, rows] of states) { const all = at(place); put(place, Array.from({ length: drawn ? count : all.length }, (_, k) => { const before = all[k] ?? all[0]; return Float64Array.from(rows, (row, i) => (row < 0 ? before[i] ?? NaN : table[n * row + column(k)])); })); }
    for (const [place, rows] of blocks) { const before = at(place); put(place, Float64Array.from({ length: count * rows.length }, (_, k) => { const row = rows[Math.floor(k / count)]; return row < 0 ? before[k % before.length] ?? NaN : table[n * row + column(k % count)]; })); }
    if (drawn) this.putFrequencies(times, drawn, result.peaks ?? []);
    places.forEach((place, k) => put(place, numbers[k]));
    zeroRounding(list(payload.series));
    payload.time = times;
    if (payload.states?.numbers && !drawn) payload.states.numbers = times;
  }

  /** Put frequencies and the numbers of the drawn ones into the payload. @param {Float64Array} times @param {Int32Array} drawn @param {boolean[]} peaks */
  putFrequencies(times, drawn, peaks) {
    const values = Array.from(drawn, (k) => times[k]);
    this.drawn = { values, peaks };
    Object.assign(/** @type {object} */ (payload.states), { numbers: values.map((_, k) => k + 1), names: values.map((f) => `${+f.toPrecision(5)} Hz`) }, payload.states?.values && { values });
    for (const view of list(payload.views)) if (view.kind === "bode" || view.kind === "nyquist") Object.assign(view, { x: Array.from(times, (f) => (view.log ? Math.log10(f) : f)), states: Array.from(drawn) });
  }

  /** Number of the state at the frequency that was drawn before, or of the peak next to it. @param {number} before */
  sameFrequency(before) {
    const { values, peaks } = this.drawn, f = this.shown.values[before], distance = (/** @type {number} */ k) => Math.abs(Math.log(values[k] / f)) || Math.abs(values[k] - f);
    const places = [...values.keys()].filter((k) => !this.shown.peaks[before] || peaks[k]);
    return places.reduce((best, k) => (distance(k) < distance(best) ? k : best), places[0] ?? 0);
  }

  /** Draw the payload. */
  renew() {
    const { motion, scene, player, board } = this, [dashed] = this.ghosts.put(this.changed), { now } = motion;
    const next = new this.dimension.Motion(payload, this.dimension), traced = new Set(motion.points.filter((point) => point.traced).map(({ name }) => name));
    for (const point of next.points) point.swatch = motion.points.find(({ name }) => name === point.name)?.swatch;
    const { chosen } = motion, follows = payload.states?.kind === "frequency" && this.shown.values.length;
    motion.replace(next);
    for (const chart of stateCharts) chart.renew();
    if (follows) motion.choose(this.sameFrequency(chosen));
    this.shown = this.drawn;
    if (document.querySelector("#degrees[aria-pressed='true']")) motion.setDegrees(true);
    scene.renew(traced);
    if (board) board.picker.rows = null;
    for (const plot of board?.plots ?? []) plot.renew(motion.named(plot.series.map(({ name }) => name)));
    this.toggle.hidden = !this.changed;
    this.caption.hidden = !dashed;
    this.dashed.textContent = dashed ? `Dashed: ${dashed.name}` : "";
    byId("values")?.replaceWith(valuePanel(motion) ?? "");
    this.note.hidden = !this.changed;
    player.seek(clamp(now, motion.start, motion.end));
  }
}
