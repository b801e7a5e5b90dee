// The plots of a page, which share one cursor, one cross-hair and one stretch of time.

class Board {
  constructor(root, motion, player, picker) {
    Object.assign(this, { root, motion, player, picker });
    this.plots = [];
    this.hoverTime = null;
    this.window = null;  // the stretch of time that is shown; null for all of it
    this.stack = el("div", { class: "plots" });
    this.count = el("span", { class: "count" });
    root.append(
      el("div", { class: "board-head" }, el("h2", {}, "Plots"), this.count, this.views(),
        el("button", { type: "button", class: "button", id: "add-plot", onclick: () => this.add([], true) }, icon("plus"), "Add plot"),
        el("button", { type: "button", class: "button", title: "All series as one CSV file", onclick: () => this.save(motion.series, "series") }, icon("save"), "All data")),
      motion.other ? el("p", { class: "caption other-run" }, el("i", { class: "dashes" }), `Dashed: ${motion.other}`) : "",
      this.stack);
    this.count.textContent = `${motion.series.length} series`;
    player.onTime.on(() => this.refresh());
  }

  // Degrees, and the stretch of time.
  views() {
    const { motion } = this, angles = motion.series.some((s) => /^rad\b/.test(s.unit));
    const turn = angles && toggleButton("°", false, (on) => { motion.setDegrees(on); this.picker.rows = null; for (const plot of this.plots) plot.setSeries(plot.series); }, { id: "degrees", title: "Angles in degrees", "aria-label": "Angles in degrees" });
    this.whole = iconButton("fit", "Show the whole time span (0)", () => this.show(null), { id: "zoom-none", disabled: true });
    return el("div", { class: "buttons", role: "group", "aria-label": "Time span" }, turn,
      iconButton("plus", "Zoom in time (+)", () => this.zoom(2), { id: "zoom-time" }),
      iconButton("minus", "Zoom out time (−)", () => this.zoom(0.5)), this.whole);
  }

  get span() { return this.window ?? [this.motion.start, this.motion.end]; }

  show(window) {
    const { start, end, span } = this.motion;
    if (window) {
      const size = clamp(window[1] - window[0], 4 * Math.max(span / this.motion.n, 1e-9 * span), span);
      const from = clamp(window[0], start, end - size);
      window = size > 0.999 * span ? null : [from, from + size];
    }
    this.window = window;
    this.whole.disabled = !window;
    this.restyle();
  }

  // About a time, by default the one that is shown.
  zoom(factor, about = this.player.time) {
    const [from, to] = this.span;
    const at = clamp(about, from, to);
    this.show([at - (at - from) / factor, at + (to - at) / factor]);
  }

  add(names, choose = false) {
    const plot = new Plot(this, names.map((n) => this.motion.seriesByName.get(n)).filter(Boolean));
    this.plots.push(plot);
    this.stack.append(plot.node);
    this.mark();
    if (choose) {
      plot.node.scrollIntoView({ block: "nearest" });
      this.picker.open(plot);
    }
    return plot;
  }

  remove(plot) {
    this.plots = this.plots.filter((p) => p !== plot);
    plot.node.remove();
    this.mark();
    if (this.plots.length) this.align();
    this.root.querySelector("#add-plot").focus();
  }

  // All plots have the same margins, so that their cursors stand in one line.
  align() {
    const most = (side) => Math.max(...this.plots.map((plot) => plot.wants?.[side] ?? 0));
    const [left, right] = [most("left"), most("right")];
    if (left === this.left && right === this.right) return;
    Object.assign(this, { left, right });
    requestAnimationFrame(() => this.restyle());
  }

  mark() { this.stack.classList.toggle("empty", !this.plots.length); }

  hover(t) {
    this.hoverTime = t;
    this.refresh();
  }

  refresh() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; for (const plot of this.plots) plot.drawCursor(); });
  }

  restyle() { for (const plot of this.plots) plot.draw(); }

  save(series, name) {
    const quote = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const rows = [["time [s]", ...series.map((s) => `${s.name} [${s.unit}]`)].map(quote).join(",")];
    for (let i = 0; i < this.motion.n; i++) {
      rows.push([this.motion.time[i], ...series.map((s) => (Number.isNaN(s.values[i]) ? "" : s.values[i]))].join(","));
    }
    download(`${fileName(this.motion.title)}-${fileName(name)}.csv`, rows.join("\r\n") + "\r\n", "text/csv");
  }
}

// What to plot when the report does not say: the first few series of one unit.
function fallbackPlots(motion) {
  const first = motion.series[0];
  if (!first) return [];
  return [motion.series.filter((s) => s.group === first.group && s.unit === first.unit).slice(0, 3).map((s) => s.name)];
}
