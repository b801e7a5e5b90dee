// The plots of a page, which share a cursor and a time span.

/** @import { Range, Series } from "./types.d.ts" */
/** @import { Picker } from "./picker.js" */
/** @import { Player } from "./player.js" */
/** @import { Timeline } from "./timeline.js" */

import { download, el, fileName, icon, iconButton, toggleButton } from "./dom.js";
import { clamp, list } from "./numbers.js";
import { Plot } from "./plots.js";

export class Board {
  /** @param {HTMLElement} root @param {Timeline} motion @param {Player} player @param {Picker} picker */
  constructor(root, motion, player, picker) {
    this.root = root;
    this.motion = motion;
    this.player = player;
    this.picker = picker;
    /** @type {Plot[]} */
    this.plots = [];
    /** Time under the pointer. @type {number | null} */
    this.hoverTime = null;
    /** Displayed time span; null for the whole one. @type {Range | null} */
    this.window = null;
    /** Resolution while printing. @type {number | undefined} */
    this.ratio = undefined;
    /** Margins of all plots. */
    this.left = this.right = 0;
    this.pending = false;
    this.stack = el("div", { class: "plots" });
    this.whole = iconButton("fit", "Show the whole time span (0)", () => this.show(null), { id: "zoom-none", disabled: true });
    this.addButton = el("button", { type: "button", class: "button", id: "add-plot", onclick: () => this.add([], true) }, icon("plus"), "Add plot");
    root.append(
      el("div", { class: "board-head" }, el("h2", {}, "Plots"), el("span", { class: "count" }, `${motion.series.length} series`), this.viewButtons(), this.addButton,
        el("button", { type: "button", class: "button", title: "All series as one CSV file", onclick: () => this.save(motion.series, "series") }, icon("save"), "All data")),
      motion.other ? el("p", { class: "caption other-run" }, el("i", { class: "dashes" }), `Dashed: ${motion.other}`) : "",
      this.stack);
    player.onTime.on(() => this.refresh());
  }

  /** Unit of angles, and time span. */
  viewButtons() {
    const angles = this.motion.series.some(({ unit }) => /^rad\b/.test(unit));
    const inDegrees = (/** @type {boolean} */ on) => {
      this.motion.setDegrees(on);
      this.picker.rows = null;
      for (const plot of this.plots) plot.setSeries(plot.series);
    };
    return el("div", { class: "buttons", role: "group", "aria-label": "Time span" },
      angles && toggleButton("°", false, inDegrees, { id: "degrees", title: "Angles in degrees", "aria-label": "Angles in degrees" }),
      iconButton("plus", "Zoom in time (+)", () => this.zoom(2), { id: "zoom-time" }),
      iconButton("minus", "Zoom out time (−)", () => this.zoom(0.5)), this.whole);
  }

  /** @returns {Range} */
  get span() { return this.window ?? [this.motion.start, this.motion.end]; }

  /** Show a time span, or the whole one. @param {Range | null} window */
  show(window) {
    const { start, end, span, n } = this.motion;
    if (window) {
      const size = clamp(window[1] - window[0], 4 * Math.max(span / n, 1e-9 * span), span), from = clamp(window[0], start, end - size);
      window = size > 0.999 * span ? null : [from, from + size];
    }
    this.window = window;
    this.whole.disabled = !window;
    this.redraw();
  }

  /** Zoom about a time, by default the present one. @param {number} factor */
  zoom(factor, about = this.player.time) {
    const [from, to] = this.span, at = clamp(about, from, to);
    this.show([at - (at - from) / factor, at + (to - at) / factor]);
  }

  /** Add a plot of some series. @param {string[]} names */
  add(names, choose = false) {
    const plot = new Plot(this, this.motion.named(names));
    this.plots.push(plot);
    this.stack.append(plot.node);
    this.stack.classList.remove("empty");
    if (!choose) return;
    plot.node.scrollIntoView({ block: "nearest" });
    this.picker.open(plot);
  }

  /** Add the plots of the payload; by default one of the first series of one unit. @param {string[][] | undefined} groups */
  addDefault(groups) {
    const { series } = this.motion;
    const existing = list(groups).map((names) => this.motion.named(list(names)).map(({ name }) => name)).filter((names) => names.length);
    const first = series.filter(({ group, unit }) => group === series[0].group && unit === series[0].unit).slice(0, 3);
    for (const names of existing.length ? existing : [first.map(({ name }) => name)]) this.add(names);
  }

  /** @param {Plot} plot */
  remove(plot) {
    this.plots = this.plots.filter((other) => other !== plot);
    plot.node.remove();
    this.stack.classList.toggle("empty", !this.plots.length);
    if (this.plots.length) this.align();
    this.addButton.focus();
  }

  /** Give all plots the same margins, so that their cursors are aligned. */
  align() {
    const left = Math.max(...this.plots.map(({ margins }) => margins.left)), right = Math.max(...this.plots.map(({ margins }) => margins.right));
    if (left === this.left && right === this.right) return;
    Object.assign(this, { left, right });
    requestAnimationFrame(() => this.redraw());
  }

  /** @param {number | null} t */
  hover(t) {
    this.hoverTime = t;
    this.refresh();
  }

  /** Draw the cursors in the next frame. */
  refresh() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; for (const plot of this.plots) plot.drawCursor(); });
  }

  redraw() { for (const plot of this.plots) plot.draw(); }

  /** Save series as CSV. @param {Series[]} series @param {string} name of the file */
  save(series, name) {
    const { motion } = this, quoted = (/** @type {string} */ text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const headings = ["time [s]", ...series.map((s) => `${s.name} [${s.unit}]`)].map(quoted);
    const rows = Array.from(motion.time, (t, i) => [t, ...series.map(({ values }) => (Number.isNaN(values[i]) ? "" : values[i]))]);
    download(`${fileName(motion.title)}-${fileName(name)}.csv`, [headings, ...rows].map((row) => `${row.join(",")}\r\n`).join(""), "text/csv");
  }
}
