// One plot: curves over time or over each other, with cursor, zoom and export.

class Plot extends PlotPainter {
  constructor(board, series) {
    super();
    this.board = board;
    this.series = series;
    this.legend = el("div", { class: "legend" });
    this.base = el("canvas", { class: "base", role: "img" });
    this.over = el("canvas", { class: "over", tabindex: "0", role: "slider", "aria-label": "Time in this plot" });
    this.against = null;  // the series that runs to the right, where it is not time
    this.node = el("article", { class: "card plot" },
      el("div", { class: "plot-head" }, this.legend,
        el("div", { class: "plot-tools" },
          iconButton("edit", "Choose series", () => board.picker.open(this)),
          iconButton("cross", "Choose the x-axis", () => board.picker.open(this, true)),
          this.saveMenu(),
          iconButton("close", "Remove this plot", () => board.remove(this)))),
      el("div", { class: "plot-area" }, this.base, this.over));
    this.bind();
    this.fillLegend();
    new ResizeObserver(() => this.draw()).observe(this.base);
  }

  get name() { return fileName(this.series.map((s) => s.name).join("_")); }

  saveMenu() {
    const item = (text, onclick) => el("button", { type: "button", class: "menu-item", onclick }, text), file = () => `${fileName(this.board.motion.title)}-${this.name}`;
    return menu(icon("save"), [
      item("Numbers (CSV)", () => this.board.save(this.against ? [this.against, ...this.series] : this.series, this.name)),
      item("Picture (PNG)", async () => download(`${file()}.png`, await pngOf(this.picture()), "image/png")),
      item("Drawing (SVG)", () => download(`${file()}.svg`, String(this.paper((w, h) => new SvgContext(w, h))), "image/svg+xml"))],
    { class: "icon", title: "Save this plot", "aria-label": "Save this plot" });
  }

  // The plot with its legend, on paper.
  paper(make) {
    const { clientWidth: w, clientHeight: h } = this.base, top = 24, ctx = make(w, h + top);
    ctx.fillStyle = Theme.surface;
    ctx.fillRect(0, 0, w, h + top);
    ctx.font = `12px ${Theme.font}`;
    let x = this.left;
    this.series.forEach((s, k) => {
      const { colour, dash } = this.style(k);
      trace(ctx, [[x, 13], [x + 20, 13]]);
      stroke(ctx, colour, 2, dash);
      Object.assign(ctx, { fillStyle: Theme.ink, textAlign: "left", textBaseline: "middle" });
      ctx.fillText(withUnit(s.name, s.unit === "1" ? "" : `[${s.unit}]`), x + 26, 13);
      x += 48 + ctx.measureText(withUnit(s.name, `[${s.unit}]`)).width;
    });
    ctx.save();
    ctx.translate(0, top);
    this.paint(ctx, w, h);
    ctx.restore();
    this.draw();
    return ctx;
  }

  picture() {
    const canvas = document.createElement("canvas"), ratio = 2;
    this.paper((w, h) => {
      [canvas.width, canvas.height] = [ratio * w, ratio * h];
      const ctx = canvas.getContext("2d");
      ctx.scale(ratio, ratio);
      return ctx;
    });
    return canvas;
  }

  setAgainst(series) {
    this.against = series;
    this.fillLegend();
    this.draw();
  }

  setSeries(series) {
    this.series = series;
    this.fillLegend();
    this.draw();
  }

  // At most two units, one for each side.
  get units() { return [...new Set(this.series.map((s) => s.unit))].slice(0, 2); }

  takes(series) {
    const units = new Set(this.series.map((s) => s.unit));
    return units.size < 2 || units.has(series.unit);
  }

  style(k) { return { colour: Theme.colour(k), dash: DASHES[Math.floor(k / PALETTE.light.length) % DASHES.length] }; }

  fillLegend() {
    this.values = [];
    this.swatches = [];
    this.legend.replaceChildren(...this.series.map((s, k) => {
      const value = el("span", { class: "value" });
      const swatch = el("i", { class: "swatch" });
      this.values.push(value);
      this.swatches.push(swatch);
      return el("span", { class: "key" }, swatch, el("span", { class: "name", title: s.name }, s.name), value,
        this.series.length > 1 && iconButton("close", `Remove ${s.name}`, () => this.setSeries(this.series.filter((x) => x !== s)), { class: "icon tiny" }));
    }));
    if (!this.series.length) {
      this.legend.append(el("button", { type: "button", class: "button", onclick: () => this.board.picker.open(this) }, icon("edit"), "Choose series"));
    }
    this.base.setAttribute("aria-label", this.series.length ? `Plot of ${this.series.map((s) => s.name).join(", ")} over ${this.against?.name ?? "time"}` : "Empty plot");
  }

  bind() {
    const { over, board } = this;
    const { motion, player } = board;
    const timeAt = (e) => {
      const r = over.getBoundingClientRect(), [px, py] = [e.clientX - r.left, e.clientY - r.top];
      if (this.against) return this.nearest(px, py);
      const [from, to] = board.span;
      return from + clamp((px - this.left) / (r.width - this.left - this.right), 0, 1) * (to - from);
    };
    over.addEventListener("pointerdown", (e) => {
      if (e.button) return;
      over.setPointerCapture(e.pointerId);
      if (e.shiftKey && !this.against) { this.marked = [timeAt(e), timeAt(e)]; return; }
      this.dragging = true;
      player.pause();
      player.seek(timeAt(e));
    });
    over.addEventListener("pointermove", (e) => {
      if (this.marked) { this.marked[1] = timeAt(e); this.drawCursor(); return; }
      if (this.dragging) player.seek(timeAt(e));
      board.hover(this.dragging || e.pointerType === "touch" ? null : timeAt(e));
    });
    const end = () => {
      this.dragging = false;
      if (!this.marked) return;
      const [a, b] = this.marked.sort((p, q) => p - q);
      this.marked = null;
      if (b > a) board.show([a, b]);
    };
    over.addEventListener("pointerup", end);
    over.addEventListener("pointercancel", end);
    over.addEventListener("pointerleave", () => board.hover(null));
    over.addEventListener("dblclick", () => board.show(null));
    over.addEventListener("wheel", (e) => {
      if (!e.ctrlKey || this.against) return;
      e.preventDefault();
      board.zoom(Math.exp(-clamp(e.deltaY, -100, 100) * 0.006), timeAt(e));
    }, { passive: false });
    over.addEventListener("keydown", (e) => {
      const action = { "+": () => board.zoom(2), "-": () => board.zoom(0.5), 0: () => board.show(null) }[e.key];
      if (!action) return;
      e.preventDefault();
      e.stopPropagation();
      action();
    });
  }
}
