// What a plot draws: axes, grid and curves once, cursor and values with every instant.

class PlotPainter {
  // Lower and upper end of the axis of one unit.
  range(unit) {
    return this.rangeOf(this.series.filter((s) => s.unit === unit));
  }

  rangeOf(series) {
    const { motion, window } = this.board, columns = series.flatMap((s) => (s.other ? [s.values, s.other] : [s.values]));
    const [a, b] = window && !this.against ? window.map((t) => motion.locate(t).i) : [0, motion.n - 1];
    let [lo, hi] = extent(columns.map((column) => column.subarray(a, b + 2))) || [0, 1];
    const size = Math.max(Math.abs(lo), Math.abs(hi));
    if (hi - lo <= 1e-9 * size || hi === lo) {
      const pad = size > 1e-12 ? 0.1 * size : 1;
      [lo, hi] = [(lo + hi) / 2 - pad, (lo + hi) / 2 + pad];
    }
    const pad = 0.07 * (hi - lo);
    return [lo - pad, hi + pad];
  }

  draw() {
    if (!this.base.clientWidth) return;
    const { ctx, w, h } = fitCanvas(this.base, this.board.ratio);
    this.paint(ctx, w, h);
    if (this.board.ratio && !this.against) { trace(ctx, [[this.x(this.board.player.time), this.top], [this.x(this.board.player.time), this.bottom]]); stroke(ctx, Theme.accent, 1); }
    this.drawCursor();
  }

  paint(ctx, w, h) {
    const { board: { motion } } = this, { against } = this;
    const units = this.units;
    this.top = 14;
    this.bottom = h - 26;
    ctx.font = `11px ${Theme.font}`;

    const axes = units.map((unit) => {
      const [lo, hi] = this.range(unit);
      const size = Math.max(Math.abs(lo), Math.abs(hi));
      const power = size >= 1e5 || size < 1e-2 ? 3 * Math.floor(Math.log10(size) / 3) : 0;
      const marks = ticks(lo, hi, Math.max(2, (this.bottom - this.top) / 38));
      const decimals = decimalsOf(marks.step / 10 ** power);
      const texts = marks.values.map((v) => fixed(v / 10 ** power, decimals));
      const room = Math.max(...texts.map((t) => ctx.measureText(t).width), 0) + 10;
      const name = (power ? `10${superscript(power)} ` : "") + (unit === "1" ? "" : raised(unit));
      return { unit, lo, hi, marks: marks.values, texts, room, name };
    });
    this.wants = { left: Math.max(44, (axes[0]?.room || 0) + 20), right: axes[1] ? Math.max(44, axes[1].room + 20) : 14 };
    this.axes = axes;
    this.board.align();
    const { left, right } = this.board;
    Object.assign(this, { left, right });
    const [first, last] = against ? this.rangeOf([against]) : this.board.span;
    this.x = (t) => this.left + (last > first ? (t - first) / (last - first) : 0) * (w - this.left - this.right);
    this.y = (v, unit) => {
      const { lo, hi } = axes.find((a) => a.unit === unit);
      return this.bottom - ((v - lo) / (hi - lo)) * (this.bottom - this.top);
    };

    // Grid and labels.
    const across = ticks(first, last, Math.max(2, (w - this.left - this.right) / 70));
    const line = (x0, y0, x1, y1, colour) => { trace(ctx, [[x0, y0], [x1, y1]]); stroke(ctx, colour, 1); };
    ctx.fillStyle = Theme.muted;
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    const decimals = decimalsOf(across.step);
    for (const t of across.values) {
      const x = Math.round(this.x(t)) + 0.5;
      line(x, this.top, x, this.bottom, Theme.grid);
      const text = fixed(t, decimals) + (t === across.values.at(-1) ? ` ${against ? (against.unit === "1" ? "" : against.unit) : "s"}` : "");
      ctx.fillText(text, Math.min(x, w - ctx.measureText(text).width / 2 - 2), this.bottom + 8);
    }
    ctx.textBaseline = "middle";
    axes.forEach((axis, side) => {
      axis.marks.forEach((v, k) => {
        const y = Math.round(this.y(v, axis.unit)) + 0.5;
        if (!side) line(this.left, y, w - this.right, y, Theme.grid);
        ctx.textAlign = side ? "left" : "right";
        ctx.fillText(axis.texts[k], side ? w - this.right + 7 : this.left - 7, y);
      });
      if (axis.lo < 0 && axis.hi > 0 && !side) {
        const y = Math.round(this.y(0, axis.unit)) + 0.5;
        line(this.left, y, w - this.right, y, mix(Theme.surface, Theme.muted, 0.6));
      }
      ctx.save();
      ctx.textAlign = "center";
      ctx.translate(side ? w - 9 : 9, (this.top + this.bottom) / 2);
      ctx.rotate(-Math.PI / 2);
      ctx.fillText(axis.name, 0, 0);
      ctx.restore();
    });
    line(this.left, this.bottom + 0.5, w - this.right, this.bottom + 0.5, mix(Theme.surface, Theme.muted, 0.6));

    if (against) {
      Object.assign(ctx, { fillStyle: Theme.muted, textAlign: "right", textBaseline: "bottom" });
      ctx.fillText(against.name, w - this.right, this.bottom - 4);
    }
    for (const event of against ? [] : motion.events) {
      if (event.time < first || event.time > last) continue;
      const x = Math.round(this.x(event.time)) + 0.5;
      trace(ctx, [[x, this.top], [x, this.bottom]]);
      stroke(ctx, Theme.muted, 1, [3, 3]);
      trace(ctx, [[x - 4, this.top - 6], [x + 4, this.top - 6], [x, this.top]], true);
      ctx.fillStyle = Theme.muted;
      ctx.fill();
    }

    ctx.save();
    ctx.beginPath();
    ctx.rect(this.left, this.top - 2, w - this.left - this.right, this.bottom - this.top + 4);
    ctx.clip();
    ctx.lineJoin = "round";
    this.series.forEach((s, k) => {
      const { colour, dash } = this.style(k);
      this.swatches[k].style.setProperty("--c", colour);
      if (!units.includes(s.unit)) return;
      this.curve(ctx, s, w);
      stroke(ctx, colour, 1.9, s.unit === units[1] && !dash.length ? DASHES[1] : dash);
      if (!s.other) return;
      this.curve(ctx, { ...s, values: s.other }, w, against?.other ?? against?.values);
      stroke(ctx, mix(Theme.surface, colour, 0.75), 1.4, [4, 4]);
    });
    ctx.restore();
  }

  // The path of one series; with many frames, the least and greatest of each pixel.
  curve(ctx, s, w, xs = this.against?.values) {
    const { time, n } = this.board.motion, across = xs ?? time;
    const [from, to] = xs || !this.board.window ? [0, n] : this.board.window.map((t, k) => Math.min(n, this.board.motion.locate(t).i + 2 * k));
    const dense = !xs && to - from > 4 * w;
    let px = NaN, py = NaN;
    let on = false, column = NaN, lo = 0, hi = 0, last = 0;
    const flush = () => {
      if (column !== column) return;
      if (on) ctx.lineTo(column, this.y(lo, s.unit)); else ctx.moveTo(column, this.y(lo, s.unit));
      if (hi !== lo) ctx.lineTo(column, this.y(hi, s.unit));
      ctx.lineTo(column, this.y(last, s.unit));
      on = true;
    };
    ctx.beginPath();
    for (let i = from; i < to; i++) {
      const v = s.values[i];
      if (v !== v || across[i] !== across[i]) {
        if (dense) flush();
        column = NaN;
        on = false;
        continue;
      }
      const x = this.x(across[i]);
      if (!dense) {
        const y = this.y(v, s.unit);
        if (xs && on && Math.abs(x - px) + Math.abs(y - py) < 0.5) continue;
        [px, py] = [x, y];
        if (on) ctx.lineTo(x, this.y(v, s.unit)); else ctx.moveTo(x, this.y(v, s.unit));
        on = true;
      } else if (Math.round(x) === column) {
        lo = Math.min(lo, v); hi = Math.max(hi, v); last = v;
      } else {
        flush();
        column = Math.round(x);
        lo = hi = last = v;
      }
    }
    if (dense) flush();
  }

  drawCursor() {
    if (!this.x || !this.over.clientWidth) return;
    const { board: { motion, player, hoverTime } } = this;
    const { ctx, w } = fitCanvas(this.over, this.board.ratio);
    const shown = hoverTime ?? player.time;
    const cursor = motion.locate(shown);
    this.over.setAttribute("aria-valuetext", `${clock(shown, motion.span)} s`);
    this.over.setAttribute("aria-valuenow", String(shown));
    this.over.setAttribute("aria-valuemin", String(motion.start));
    this.over.setAttribute("aria-valuemax", String(motion.end));
    const upright = (t, colour, dash) => {
      const x = this.x(t);
      if (this.against || x < this.left - 1 || x > w - this.right + 1) return;
      trace(ctx, [[x, this.top], [x, this.bottom]]);
      stroke(ctx, colour, 1.4, dash);
    };
    upright(player.time, Theme.accent, []);
    const x = this.x(player.time);
    if (!this.against && x >= this.left - 1 && x <= w - this.right + 1) {
      trace(ctx, [[x - 5, this.bottom + 7], [x + 5, this.bottom + 7], [x, this.bottom]], true);
      ctx.fillStyle = Theme.accent;
      ctx.fill();
    }
    if (this.marked) {
      const [a, b] = this.marked.map((t) => this.x(t));
      ctx.fillStyle = Theme.accent;
      ctx.globalAlpha = 0.15;
      ctx.fillRect(Math.min(a, b), this.top, Math.abs(b - a), this.bottom - this.top);
      ctx.globalAlpha = 1;
    }
    if (hoverTime !== null && !this.against) {
      upright(hoverTime, Theme.muted, [4, 3]);
      ctx.font = `600 11px ${Theme.font}`;
      ctx.textBaseline = "middle";
      const near = motion.events.find((e) => Math.abs(this.x(e.time) - this.x(hoverTime)) < 4);
      const text = `${clock(hoverTime, motion.span)} s${near ? ` · ${near.name}` : ""}`;
      const wide = ctx.measureText(text).width / 2 + 6, at = clamp(this.x(hoverTime), wide + 2, w - wide - 2);
      ctx.beginPath();
      ctx.roundRect(at - wide, this.bottom + 4, 2 * wide, 18, 4);
      ctx.fillStyle = Theme.ink;
      ctx.fill();
      ctx.fillStyle = Theme.surface;
      ctx.textAlign = "center";
      ctx.fillText(text, at, this.bottom + 13.5);
    }
    this.series.forEach((s, k) => {
      const v = motion.sample(s.values, cursor);
      this.values[k].textContent = withUnit(number(v), s.unit);
      const at = this.x(this.against ? motion.sample(this.against.values, cursor) : shown);
      if (v !== v || at < this.left - 4 || at > w - this.right + 4 || !this.axes.some((a) => a.unit === s.unit)) return;
      circle(ctx, [at, this.y(v, s.unit)], 3.6);
      ctx.fillStyle = this.style(k).colour;
      ctx.fill();
      stroke(ctx, Theme.surface, 1.5);
    });
  }

  // The time at which the curves come nearest to a place on the plot.
  nearest(px, py) {
    const { motion } = this.board;
    let best = motion.start, least = Infinity;
    for (const s of this.series) for (let i = 0; i < motion.n; i++) {
      const away = Math.hypot(this.x(this.against.values[i]) - px, this.y(s.values[i], s.unit) - py);
      if (away < least) [least, best] = [away, motion.time[i]];
    }
    return best;
  }
}
