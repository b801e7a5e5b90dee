// Plot of series over time or over another series, with legend, cursor, zoom and export.

/** @import { Context, Range, Series } from "./types.d.ts" */
/** @import { Board } from "./plot_board.js" */

import { contextOf, stroke, trace } from "./canvas.js";
import { download, el, fileName, icon, iconButton, menu } from "./dom.js";
import { clamp } from "./numbers.js";
import { PlotPainter } from "./plot_painter.js";
import { pngOf } from "./share.js";
import { SvgContext } from "./svg.js";
import { Theme } from "./theme.js";
import { labelled } from "./units.js";

const LEGEND_HEIGHT = 24, PICTURE_RATIO = 2;

export class Plot extends PlotPainter {
  /** @param {Board} board @param {Series[]} series */
  constructor(board, series) {
    super(board, series);
    this.legend = el("div", { class: "legend" });
    this.node = el("article", { class: "card plot" },
      el("div", { class: "plot-head" }, this.legend,
        el("div", { class: "plot-tools" },
          iconButton("edit", "Choose series", () => board.picker.open(this)),
          iconButton("cross", "Choose the x-axis", () => board.picker.open(this, true)),
          this.saveMenu(),
          iconButton("close", "Remove this plot", () => board.remove(this)))),
      el("div", { class: "plot-area" }, this.base, this.over));
    this.bindPointer();
    this.bindKeys();
    this.fillLegend();
    new ResizeObserver(() => this.draw()).observe(this.base);
  }

  saveMenu() {
    const name = () => fileName(this.series.map((s) => s.name).join("_")), file = () => `${fileName(this.board.motion.title)}-${name()}`;
    const item = (/** @type {string} */ text, /** @type {() => void} */ onclick) => el("button", { type: "button", class: "menu-item", onclick }, text);
    return menu(icon("save"), [
      item("Numbers (CSV)", () => this.board.save(this.against ? [this.against, ...this.series] : this.series, name())),
      item("Picture (PNG)", async () => download(`${file()}.png`, await pngOf(this.picture()), "image/png")),
      item("Drawing (SVG)", () => {
        const { clientWidth: w, clientHeight: h } = this.base, svg = new SvgContext(w, h + LEGEND_HEIGHT);
        this.drawWithLegend(svg);
        download(`${file()}.svg`, String(svg), "image/svg+xml");
      })],
    { class: "icon", title: "Save this plot", "aria-label": "Save this plot" });
  }

  /** Draw the plot below its legend. @param {Context} ctx */
  drawWithLegend(ctx) {
    const { clientWidth: w, clientHeight: h } = this.base;
    ctx.fillStyle = Theme.surface;
    ctx.fillRect(0, 0, w, h + LEGEND_HEIGHT);
    ctx.font = `12px ${Theme.font}`;
    let x = this.left;
    this.series.forEach(({ name, unit }, k) => {
      const { colour, dash } = this.style(k), text = labelled(name, unit);
      trace(ctx, [[x, 13], [x + 20, 13]]);
      stroke(ctx, colour, 2, dash);
      Object.assign(ctx, { fillStyle: Theme.ink, textAlign: "left", textBaseline: "middle" });
      ctx.fillText(text, x + 26, 13);
      x += 48 + ctx.measureText(text).width;
    });
    ctx.save();
    ctx.translate(0, LEGEND_HEIGHT);
    this.paint(ctx, w, h);
    ctx.restore();
    this.draw();
  }

  picture() {
    const { clientWidth: w, clientHeight: h } = this.base;
    const canvas = el("canvas", { width: PICTURE_RATIO * w, height: PICTURE_RATIO * (h + LEGEND_HEIGHT) }), ctx = contextOf(canvas);
    ctx.scale(PICTURE_RATIO, PICTURE_RATIO);
    this.drawWithLegend(ctx);
    return canvas;
  }

  /** @param {Series | null} series */
  setAgainst(series) {
    this.against = series;
    this.fillLegend();
    this.draw();
  }

  /** @param {Series[]} series */
  setSeries(series) {
    this.series = series;
    this.fillLegend();
    this.draw();
  }

  /** Show the same series with other values. @param {Series[]} series */
  renew(series) {
    this.series = series;
    if (this.against) this.against = this.board.motion.seriesByName.get(this.against.name) ?? null;
    this.draw();
  }

  /** Whether there is an axis for a series; a plot has two. @param {Series} series */
  accepts(series) { return this.units.length < 2 || this.units.includes(series.unit); }

  fillLegend() {
    this.keys = this.series.map(() => ({ swatch: el("i", { class: "swatch" }), value: el("span", { class: "value" }) }));
    this.legend.replaceChildren(...this.series.map((s, k) => el("span", { class: "key" }, this.keys[k].swatch,
      el("span", { class: "name", title: s.name }, s.name), this.keys[k].value,
      this.series.length > 1 && iconButton("close", `Remove ${s.name}`, () => this.setSeries(this.series.filter((other) => other !== s)), { class: "icon tiny" }))));
    if (!this.series.length) this.legend.append(el("button", { type: "button", class: "button", onclick: () => this.board.picker.open(this) }, icon("edit"), "Choose series"));
    const names = this.series.map((s) => s.name).join(", ");
    this.base.setAttribute("aria-label", names ? `Plot of ${names} over ${this.against?.name ?? "time"}` : "Empty plot");
  }

  /** Time under the pointer. @param {MouseEvent} e */
  timeAt(e) {
    const box = this.over.getBoundingClientRect(), [x, y] = [e.clientX - box.left, e.clientY - box.top];
    if (this.against) return this.nearest(this.against, x, y);
    const [from, to] = this.board.span;
    return from + clamp((x - this.left) / (this.right - this.left), 0, 1) * (to - from);
  }

  /** Time at which the curves are nearest to a position. @param {Series} against @param {number} px @param {number} py */
  nearest(against, px, py) {
    const { motion } = this.board;
    let nearest = motion.start, distance = Infinity;
    for (const { values, unit } of this.series) {
      const y = this.heights(unit);
      for (let i = 0; y && i < motion.n; i++) {
        const d = Math.hypot(this.x(against.values[i]) - px, y(values[i]) - py);
        if (d < distance) [distance, nearest] = [d, motion.time[i]];
      }
    }
    return nearest;
  }

  /** A drag seeks, with shift it selects a time span; ctrl and the wheel zoom, a double click shows the whole time span. */
  bindPointer() {
    const { over, board } = this;
    let seeking = false;
    over.addEventListener("pointerdown", (e) => {
      if (e.button) return;
      over.setPointerCapture(e.pointerId);
      if (e.shiftKey && !this.against) { this.selection = /** @type {Range} */ ([this.timeAt(e), this.timeAt(e)]); return; }
      seeking = true;
      board.player.pause();
      board.player.seek(this.timeAt(e));
    });
    over.addEventListener("pointermove", (e) => {
      const time = this.timeAt(e);
      if (this.selection) { this.selection[1] = time; this.drawCursor(); return; }
      if (seeking) board.player.seek(time);
      board.hover(seeking || e.pointerType === "touch" ? null : time);
    });
    const end = () => {
      seeking = false;
      const [a, b] = this.selection ?? [0, 0];
      this.selection = null;
      if (a !== b) board.show([Math.min(a, b), Math.max(a, b)]);
    };
    over.addEventListener("pointerup", end);
    over.addEventListener("pointercancel", end);
    over.addEventListener("pointerleave", () => board.hover(null));
    over.addEventListener("dblclick", () => board.show(null));
    over.addEventListener("wheel", (e) => {
      if (!e.ctrlKey || this.against) return;
      e.preventDefault();
      board.zoom(Math.exp(-clamp(e.deltaY, -100, 100) * 0.006), this.timeAt(e));
    }, { passive: false });
  }

  bindKeys() {
    const { board } = this;
    /** @type {Record<string, () => void>} */
    const actions = { "+": () => board.zoom(2), "-": () => board.zoom(0.5), 0: () => board.show(null) };
    this.over.addEventListener("keydown", (e) => {
      if (!actions[e.key]) return;
      e.preventDefault();
      e.stopPropagation();
      actions[e.key]();
    });
  }
}
