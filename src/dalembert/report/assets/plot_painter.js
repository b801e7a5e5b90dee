// Drawing of a plot on two canvases: axes and curves once, cursor and values for every frame.

/** @import { Context, Range, Series } from "./types.d.ts" */
/** @import { Board } from "./plot_board.js" */

import { DASHES, circle, fitCanvas, stroke, trace } from "./canvas.js";
import { el } from "./dom.js";
import { axisTicks, clamp, clock, extent, number } from "./numbers.js";
import { PALETTE, Theme, mix } from "./theme.js";
import { raised, withUnit } from "./units.js";

/** Vertical axis of the series of one unit.
 * @typedef {{ unit: string, lo: number, hi: number, values: number[], texts: string[], width: number, name: string }} Axis */

const TOP = 14, FOOT = 26, MIN_MARGIN = 44;

/** Map of an interval to pixels a to b. @param {Range} interval @param {number} a @param {number} b */
function linear([first, last], a, b) {
  const slope = last > first ? (b - a) / (last - first) : 0;
  return (/** @type {number} */ v) => a + (v - first) * slope;
}

export class PlotPainter {
  /** @param {Board} board @param {Series[]} series */
  constructor(board, series) {
    this.board = board;
    this.series = series;
    /** Series of the x-axis; null for time. @type {Series | null} */
    this.against = null;
    /** Time span that is being selected. @type {Range | null} */
    this.selection = null;
    this.base = el("canvas", { class: "base", role: "img" });
    this.over = el("canvas", { class: "over", tabindex: "0", role: "slider", "aria-label": "Time in this plot" });
    /** Colour samples and present values in the legend. @type {{ swatch: HTMLElement, value: HTMLElement }[]} */
    this.keys = [];
    /** @type {Axis[]} */
    this.axes = [];
    /** Margins that the numbers of the axes require. */
    this.margins = { left: MIN_MARGIN, right: TOP };
    /** Ends of the x-axis. @type {Range} */
    this.ends = [0, 1];
    this.x = linear(this.ends, 0, 0);
    this.left = this.right = this.bottom = 0;
  }

  /** Units of the axes at the left and at the right. */
  get units() { return [...new Set(this.series.map(({ unit }) => unit))].slice(0, 2); }

  /** @param {number} k */
  style(k) { return { colour: Theme.colour(k), dash: DASHES[Math.floor(k / PALETTE.light.length) % DASHES.length] }; }

  /** Ends of an axis of some series in the displayed time span. @param {Series[]} series @returns {Range} */
  rangeOf(series) {
    const { motion, window } = this.board, columns = series.flatMap(({ values, other }) => (other ? [values, other] : [values]));
    const [a, b] = window && !this.against ? window.map((t) => motion.locate(t).i) : [0, motion.n - 1];
    let [lo, hi] = extent(columns.map((column) => column.subarray(a, b + 2))) ?? [0, 1];
    const size = Math.max(Math.abs(lo), Math.abs(hi)), constant = hi - lo <= 1e-9 * size;
    const pad = !constant ? 0.07 * (hi - lo) : 1.14 * (size > 1e-12 ? 0.1 * size : 1);
    if (constant) lo = hi = (lo + hi) / 2;
    return [lo - pad, hi + pad];
  }

  /** Linear map from the values of a unit to pixels; null for a third unit. @param {string} unit */
  heights(unit) {
    const axis = this.axes.find((a) => a.unit === unit);
    return axis ? linear([axis.lo, axis.hi], this.bottom, TOP) : null;
  }

  draw() {
    if (!this.base.clientWidth) return;
    const { ctx, w, h } = fitCanvas(this.base, this.board.ratio);
    this.paint(ctx, w, h);
    if (this.board.ratio && !this.against) this.upright(ctx, this.board.player.time, Theme.accent, [], 1);
    this.drawCursor();
  }

  /** Draw axes, events and curves. @param {Context} ctx @param {number} w @param {number} h */
  paint(ctx, w, h) {
    ctx.font = `11px ${Theme.font}`;
    this.bottom = h - FOOT;
    this.axes = this.units.map((unit) => this.axisOf(ctx, unit));
    const [first, second] = this.axes;
    this.margins = { left: Math.max(MIN_MARGIN, (first?.width ?? 0) + 20), right: second ? Math.max(MIN_MARGIN, second.width + 20) : TOP };
    this.board.align();
    [this.left, this.right] = [this.board.left, w - this.board.right];
    this.ends = this.against ? this.rangeOf([this.against]) : this.board.span;
    this.x = linear(this.ends, this.left, this.right);
    this.drawTimes(ctx, w);
    this.axes.forEach((axis, side) => this.drawAxis(ctx, axis, side, w));
    line(ctx, this.left, this.bottom + 0.5, this.right, this.bottom + 0.5, mix(Theme.surface, Theme.muted, 0.6));
    if (!this.against) this.drawEvents(ctx);
    ctx.save();
    ctx.beginPath();
    ctx.rect(this.left, TOP - 2, this.right - this.left, this.bottom - TOP + 4);
    ctx.clip();
    ctx.lineJoin = "round";
    this.series.forEach((s, k) => this.drawSeries(ctx, s, k));
    ctx.restore();
  }

  /** @param {Context} ctx @param {string} unit @returns {Axis} */
  axisOf(ctx, unit) {
    const [lo, hi] = this.rangeOf(this.series.filter((s) => s.unit === unit));
    const { values, texts, power } = axisTicks(lo, hi, Math.max(2, (this.bottom - TOP) / 38));
    const width = Math.max(...texts.map((text) => ctx.measureText(text).width), 0) + 10;
    return { unit, lo, hi, values, texts, width, name: [power, unit === "1" ? "" : raised(unit)].filter(Boolean).join(" ") };
  }

  /** Grid, numbers and name of the x-axis. @param {Context} ctx @param {number} w */
  drawTimes(ctx, w) {
    const { against } = this, [first, last] = this.ends;
    const { values, texts, power } = axisTicks(first, last, Math.max(2, (this.right - this.left) / 70));
    const unit = against ? (against.unit === "1" ? "" : raised(against.unit)) : "s";
    Object.assign(ctx, { fillStyle: Theme.muted, textAlign: "center", textBaseline: "top" });
    values.forEach((t, k) => {
      const x = Math.round(this.x(t)) + 0.5, text = k === values.length - 1 ? `${texts[k]}${power && `·${power}`} ${unit}` : texts[k];
      line(ctx, x, TOP, x, this.bottom, Theme.grid);
      ctx.fillText(text, Math.min(x, w - ctx.measureText(text).width / 2 - 2), this.bottom + 8);
    });
    if (!against) return;
    Object.assign(ctx, { textAlign: "right", textBaseline: "bottom" });
    ctx.fillText(against.name, this.right, this.bottom - 4);
  }

  /** Numbers and name of an axis; grid of the left one. @param {Context} ctx @param {Axis} axis @param {number} side @param {number} w */
  drawAxis(ctx, { unit, lo, hi, values, texts, name }, side, w) {
    const y = /** @type {(v: number) => number} */ (this.heights(unit));
    Object.assign(ctx, { fillStyle: Theme.muted, textAlign: side ? "left" : "right", textBaseline: "middle" });
    values.forEach((v, k) => {
      const at = Math.round(y(v)) + 0.5;
      if (!side) line(ctx, this.left, at, this.right, at, Theme.grid);
      ctx.fillText(texts[k], side ? this.right + 7 : this.left - 7, at);
    });
    if (lo < 0 && hi > 0 && !side) {
      const zero = Math.round(y(0)) + 0.5;
      line(ctx, this.left, zero, this.right, zero, mix(Theme.surface, Theme.muted, 0.6));
    }
    ctx.save();
    ctx.textAlign = "center";
    ctx.translate(side ? w - 9 : 9, (TOP + this.bottom) / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.fillText(name, 0, 0);
    ctx.restore();
  }

  /** @param {Context} ctx */
  drawEvents(ctx) {
    const [first, last] = this.ends;
    for (const { time } of this.board.motion.events) {
      if (time < first || time > last) continue;
      const x = Math.round(this.x(time)) + 0.5;
      this.upright(ctx, time, Theme.muted, [3, 3], 1);
      trace(ctx, [[x - 4, TOP - 6], [x + 4, TOP - 6], [x, TOP]], true);
      ctx.fillStyle = Theme.muted;
      ctx.fill();
    }
  }

  /** Curve of a series, and that of the second run dashed. @param {Context} ctx @param {Series} s @param {number} k */
  drawSeries(ctx, s, k) {
    const { colour, dash } = this.style(k), y = this.heights(s.unit);
    this.keys[k].swatch.style.setProperty("--c", colour);
    if (!y) return;
    this.curve(ctx, s.values, y, this.against?.values);
    stroke(ctx, colour, 1.9, this.axes.length > 1 && s.unit === this.axes[1].unit && !dash.length ? DASHES[1] : dash);
    if (!s.other) return;
    this.curve(ctx, s.other, y, this.against?.other ?? this.against?.values);
    stroke(ctx, mix(Theme.surface, colour, 0.75), 1.4, [4, 4]);
  }

  /** Path of a column over time or other numbers; of many instants, the extremes of each pixel.
   * @param {Context} ctx @param {Float64Array} values @param {(v: number) => number} y @param {Float64Array} [xs] */
  curve(ctx, values, y, xs) {
    const { motion, window } = this.board, across = xs ?? motion.time;
    const [from, to] = xs || !window ? [0, motion.n] : window.map((t, k) => Math.min(motion.n, motion.locate(t).i + 2 * k));
    const dense = !xs && to - from > 2 * (this.right - this.left);
    let started = false, px = NaN, py = NaN, pixel = NaN, lo = 0, hi = 0, last = 0;
    const point = (/** @type {number} */ u, /** @type {number} */ v) => { if (started) ctx.lineTo(u, v); else ctx.moveTo(u, v); started = true; };
    const finishPixel = () => {
      if (pixel !== pixel) return;
      point(pixel, y(lo));
      if (hi !== lo) ctx.lineTo(pixel, y(hi));
      ctx.lineTo(pixel, y(last));
    };
    ctx.beginPath();
    for (let i = from; i < to; i++) {
      const v = values[i], x = this.x(across[i]);
      if (v !== v || x !== x) {
        finishPixel();
        pixel = NaN;
        started = false;
      } else if (!dense) {
        const u = x, w = y(v);
        if (xs && started && Math.abs(u - px) + Math.abs(w - py) < 0.5) continue;
        [px, py] = [u, w];
        point(u, w);
      } else if (Math.round(x) === pixel) {
        if (v < lo) lo = v; else if (v > hi) hi = v;
        last = v;
      } else {
        finishPixel();
        pixel = Math.round(x);
        lo = hi = last = v;
      }
    }
    finishPixel();
  }

  /** Vertical line at a time. @param {Context} ctx @param {number} t @param {string} colour @param {number[]} dash */
  upright(ctx, t, colour, dash, width = 1.4) {
    const x = this.x(t);
    if (x >= this.left - 1 && x <= this.right + 1) line(ctx, x, TOP, x, this.bottom, colour, width, dash);
  }

  /** Draw cursors and values at the time under the pointer, else at that of the player. */
  drawCursor() {
    if (!this.right || !this.over.clientWidth) return;
    const { motion, player, hoverTime } = this.board, { ctx } = fitCanvas(this.over, this.board.ratio);
    const shown = hoverTime ?? player.time, cursor = motion.locate(shown), x = this.x(player.time);
    const state = { valuetext: `${clock(shown, motion.span)} s`, valuenow: shown, valuemin: motion.start, valuemax: motion.end };
    for (const [name, value] of Object.entries(state)) this.over.setAttribute(`aria-${name}`, String(value));
    if (!this.against && x >= this.left - 1 && x <= this.right + 1) {
      this.upright(ctx, player.time, Theme.accent, []);
      trace(ctx, [[x - 5, this.bottom + 7], [x + 5, this.bottom + 7], [x, this.bottom]], true);
      ctx.fillStyle = Theme.accent;
      ctx.fill();
    }
    if (this.selection) {
      const [a, b] = this.selection.map((t) => this.x(t));
      Object.assign(ctx, { fillStyle: Theme.accent, globalAlpha: 0.15 });
      ctx.fillRect(Math.min(a, b), TOP, Math.abs(b - a), this.bottom - TOP);
      ctx.globalAlpha = 1;
    }
    if (hoverTime !== null && !this.against) this.drawHover(ctx, hoverTime);
    this.series.forEach((s, k) => {
      const v = motion.sample(s.values, cursor), at = this.x(this.against ? motion.sample(this.against.values, cursor) : shown), y = this.heights(s.unit);
      this.keys[k].value.textContent = withUnit(number(v), s.unit);
      if (!y || v !== v || at < this.left - 4 || at > this.right + 4) return;
      circle(ctx, [at, y(v)], 3.6);
      ctx.fillStyle = this.style(k).colour;
      ctx.fill();
      stroke(ctx, Theme.surface, 1.5);
    });
  }

  /** Line at the time under the pointer, with its value. @param {Context} ctx @param {number} time */
  drawHover(ctx, time) {
    const { motion } = this.board, near = motion.events.find((event) => Math.abs(this.x(event.time) - this.x(time)) < 4);
    const text = `${clock(time, motion.span)} s${near ? ` · ${near.name}` : ""}`;
    this.upright(ctx, time, Theme.muted, [4, 3]);
    ctx.font = `600 11px ${Theme.font}`;
    const half = ctx.measureText(text).width / 2 + 6, x = clamp(this.x(time), half + 2, this.over.clientWidth - half - 2);
    ctx.beginPath();
    ctx.roundRect(x - half, this.bottom + 4, 2 * half, 18, 4);
    ctx.fillStyle = Theme.ink;
    ctx.fill();
    Object.assign(ctx, { fillStyle: Theme.surface, textAlign: "center", textBaseline: "middle" });
    ctx.fillText(text, x, this.bottom + 13.5);
  }
}

/** @param {Context} ctx @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {string} colour @param {number[]} [dash] */
function line(ctx, x0, y0, x1, y1, colour, width = 1, dash) {
  trace(ctx, [[x0, y0], [x1, y1]]);
  stroke(ctx, colour, width, dash);
}
