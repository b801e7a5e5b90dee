// What is written on the drawing of a structure: axes, values, supports, loads, names.

class StructureMarks extends StructurePainter {
  // The axes, as they are seen, in a corner.
  drawTriad(ctx, h) {
    const colours = { light: ["#c0392b", "#1e8449", "#1f5fbf"], dark: ["#ff7b6b", "#58d68d", "#6aa9ff"] }[Theme.name], c = [44, h - 40];
    ["x", "y", "z"].slice(0, Math.max(2, this.structure.dimension)).map((name, k) => ({ name, colour: colours[k], way: this.way([0, 1, 2].map((i) => +(i === k))) }))
      .sort((a, b) => a.way[2] - b.way[2]).forEach(({ name, colour, way }) => {
        const [u, v] = [28 * way[0], -28 * way[1]];
        ctx.strokeStyle = ctx.fillStyle = colour;
        ctx.lineWidth = 2;
        this.arrow(ctx, c[0], c[1], c[0] + u, c[1] + v);
        this.write(ctx, name, c[0] + 1.35 * u - 3, c[1] + 1.35 * v + 4, colour);
      });
  }

  write(ctx, text, x, y, colour) {
    ctx.font = `600 11.5px ${Theme.font}`;
    Object.assign(ctx, { textAlign: "left", textBaseline: "alphabetic", lineWidth: 3.5, strokeStyle: Theme.surface, fillStyle: colour });
    ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
  }

  // What the colours stand for, in numbers on the members.
  drawValues(ctx, p) {
    const { structure, structure: { field } } = this;
    if (!field || field.atVertices) return;
    ctx.font = `600 11.5px ${Theme.font}`;
    const most = field.values[structure.state.case].reduce((m, v) => (isNum(v) ? Math.max(m, Math.abs(v)) : m), 0);
    for (const { size, vertices, owners } of structure.lines) owners.forEach((own, row) => {
      const value = structure.valueOf(field, own), [a, b] = [vertices[row * size], vertices[(row + 1) * size - 1]];
      if (!isNum(value)) return;
      const text = Math.abs(value) < 1e-9 * most ? "0" : quantity(value, field.unit, 3), wide = ctx.measureText(text).width;
      this.write(ctx, text, (p[3 * a] + p[3 * b] - wide) / 2, (p[3 * a + 1] + p[3 * b + 1]) / 2 + 4, Theme.ink);
    });
  }

  drawSupports(ctx, p) {
    const count = this.structure.supports.reduce((sum, s) => sum + s.nodes.length, 0);
    const size = count <= 12 ? 13 : 7;
    ctx.strokeStyle = Theme.muted;
    ctx.fillStyle = Theme.surface;
    ctx.lineWidth = 1.3;
    for (const support of this.structure.supports) {
      const [wx, wy] = this.structure.solid ? [0, 1] : [support.axis[0], -support.axis[1]];
      for (const node of support.nodes) {
        const at = (along, across) => [p[3 * node] + size * (along * wx - across * wy), p[3 * node + 1] + size * (along * wy + across * wx)];
        const line = (...points) => { ctx.moveTo(...at(...points[0])); points.slice(1).forEach((q) => ctx.lineTo(...at(...q))); };
        ctx.beginPath();
        if (support.clamp) {  // held fast: a wall, in space the top of a block
          line([0, -0.9], [0, 0.9]);
          for (let h = -0.7; h <= 0.9; h += 0.32) line([0, h], [0.4, h - 0.25]);
          if (this.structure.solid) { line([0, -0.9], [0.75, -0.9], [0.75, 0.9], [0, 0.9]); }
        } else {
          line([0, 0], [1, -0.6], [1, 0.6], [0, 0]);
          ctx.fill();
          line([support.roller ? 1.3 : 1, -0.8], [support.roller ? 1.3 : 1, 0.8]);
        }
        ctx.stroke();
      }
    }
  }

  drawLoads(ctx, p) {
    const loads = list(this.structure.loads[this.structure.state.case]);
    const most = Math.max(...loads.map((l) => Math.hypot(...l.force)), 1e-300);
    const longest = loads.length <= 6 ? 52 : 26, texts = [];
    ctx.strokeStyle = ctx.fillStyle = Theme.force;
    ctx.lineWidth = 2;
    for (const { node, force, presses, moment } of loads) {
      if (moment) this.arc(ctx, p[3 * node], p[3 * node + 1], Math.sign(moment));
      const way = this.way(force);
      const [dx, dy] = [(way[0] / most) * longest, (-way[1] / most) * longest];
      const [x, y] = [p[3 * node], p[3 * node + 1]];
      const [x0, y0] = presses ? [x - dx, y - dy] : [x, y];
      this.arrow(ctx, x0, y0, x0 + dx, y0 + dy);
      if (loads.length > READABLE) continue;
      const size = Math.hypot(...force), up = presses ? -1 : 1;
      if (size > 0) texts.push([quantity(size, "N", 3), (presses ? x0 : x0 + dx) + 6, (presses ? y0 : y0 + dy) + (up * dy > 0 ? 10 : -2)]);
      if (moment) texts.push([quantity(Math.abs(moment), "N m", 3), x + 18, y - 14]);
    }
    for (const run of runsOf(texts)) {
      const [text, x, y] = run[run.length >> 1];
      const told = run.length > 1 ? `${run.length} × ${text}` : text;
      ctx.font = `600 11.5px ${Theme.font}`;
      this.write(ctx, told, Math.min(x, (ctx.w ?? this.canvas.clientWidth) - ctx.measureText(told).width - 6), y, Theme.force);
    }
  }

  // Of a moment: three quarters of a circle round the node.
  arc(ctx, x, y, sign) {
    const [radius, from, to] = sign > 0 ? [15, 0.75 * Math.PI, -0.7 * Math.PI] : [15, 0.25 * Math.PI, 1.7 * Math.PI];
    ctx.beginPath();
    ctx.arc(x, y, radius, from, to, sign > 0);
    ctx.stroke();
    const [ex, ey] = [x + radius * Math.cos(to), y + radius * Math.sin(to)];
    const [ux, uy] = [sign * Math.sin(to), -sign * Math.cos(to)];
    ctx.beginPath();
    ctx.moveTo(ex + 7 * ux, ey + 7 * uy);
    ctx.lineTo(ex - 4 * uy, ey + 4 * ux);
    ctx.lineTo(ex + 4 * uy, ey - 4 * ux);
    ctx.fill();
  }

  arrow(ctx, x0, y0, x1, y1) {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 3) return;
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
    const head = Math.min(9, 0.6 * length);
    ctx.beginPath();
    ctx.moveTo(x0, y0);
    ctx.lineTo(x1 - 0.8 * head * ux, y1 - 0.8 * head * uy);
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(x1, y1);
    ctx.lineTo(x1 - head * ux - 0.4 * head * uy, y1 - head * uy + 0.4 * head * ux);
    ctx.lineTo(x1 - head * ux + 0.4 * head * uy, y1 - head * uy - 0.4 * head * ux);
    ctx.fill();
  }

  drawLabels(ctx, p) {
    ctx.font = `11.5px ${Theme.font}`;
    ctx.lineWidth = 3;
    ctx.strokeStyle = Theme.surface;
    ctx.fillStyle = Theme.ink;
    this.structure.nodes.forEach((name, k) => {
      ctx.strokeText(name, p[3 * k] + 6, p[3 * k + 1] - 6);
      ctx.fillText(name, p[3 * k] + 6, p[3 * k + 1] - 6);
    });
  }
}

// Equal texts so near to each other that they would stand on one another, together.
function runsOf(texts) {
  const runs = [];
  for (const one of texts.toSorted((a, b) => a[2] - b[2] || a[1] - b[1])) {
    const near = runs.find((run) => run[0][0] === one[0] && run.some((other) => Math.hypot(other[1] - one[1], other[2] - one[2]) < 30));
    if (near) near.push(one); else runs.push([one]);
  }
  return runs;
}
