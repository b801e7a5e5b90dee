// The layers of a drawing in the plane: grid, ground, bodies, traces, loads.

class ScenePainter extends SceneCamera {
  placeOf(body, point) {
    const pose = this.poses.get(body);
    return pose && this.screen(toWorld(pose, point));
  }

  // The middle of what a body looks like: its wall is across the way there.
  middleOf(body) {
    const pose = body && this.poses.get(body), marks = body?.shapes.flatMap(outline) || [];
    return pose && marks.length ? this.screen(toWorld(pose, [0, 1].map((k) => marks.reduce((sum, p) => sum + p[k], 0) / marks.length))) : null;
  }

  // The ground is where things fall to.
  get tilt() {
    const g = this.motion.gravity;
    return g ? Math.atan2(-g[0], -g[1]) * -1 : 0;
  }

  drawGrid() {
    const { ctx, w, h } = this;
    const step = niceAbove(70 / this.view.s);
    const [a, b] = [this.world([0, h]), this.world([w, 0])];
    for (const [size, colour] of [[step / 5, mix(Theme.surface, Theme.grid, 0.4)], [step, Theme.grid]]) {
      ctx.beginPath();
      for (let k = Math.ceil(a[0] / size); k * size <= b[0]; k++) {
        const x = Math.round(this.screen([k * size, 0])[0]) + 0.5;
        ctx.moveTo(x, 0); ctx.lineTo(x, h);
      }
      for (let k = Math.ceil(a[1] / size); k * size <= b[1]; k++) {
        const y = Math.round(this.screen([0, k * size])[1]) + 0.5;
        ctx.moveTo(0, y); ctx.lineTo(w, y);
      }
      stroke(ctx, colour, 1);
    }
  }

  drawGround() {
    const { ctx, colours } = this;
    for (const guide of this.guides) {
      let [a, b] = [this.screen(guide.from), this.screen(guide.to)];
      if (a[0] > b[0] || (a[0] === b[0] && a[1] > b[1])) [a, b] = [b, a];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const normal = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
      const rails = guide.half > 0 ? [guide.half * this.view.s + 1.5, -guide.half * this.view.s - 1.5] : [0];
      if (guide.half > 0) {
        trace(ctx, [a, b]);
        stroke(ctx, colours.muted, 0.9, [12, 4, 2, 4]);
      }
      for (const d of rails) {
        const [p, q] = [a, b].map(([x, y]) => [x + normal[0] * d, y + normal[1] * d]);
        trace(ctx, [p, q]);
        stroke(ctx, colours.ink, 1.6);
        const gap = clamp(0.9 * this.half, 4, 8);
        if (d >= 0) hatch(ctx, p, q, colours.ink, gap, 0.75 * gap); else hatch(ctx, q, p, colours.ink, gap, 0.75 * gap);
      }
    }
    for (const shape of this.motion.ground.shapes) {
      if (shape.kind !== "line") this.drawShape(shape, this.motion.still, this.groundLook);
    }
  }

  // The whole way of each traced point, faint, and the last part of it up to now, strong.
  drawTraces() {
    const { ctx, motion } = this;
    const traced = motion.points.filter((p) => p.traced);
    if (!traced.length) return;
    if (ctx.svg) {
      for (const point of traced) this.runAlong(ctx, this.thinned(point), -Infinity, Infinity, this.pointColour(point), 1.6);
      return;
    }
    const ratio = this.canvas.width / this.w;
    const key = [this.canvas.width, this.canvas.height, ...Object.values(this.view), Theme.name, traced.map((p) => p.index)].join();
    if (key !== this.tracesKey) {
      this.tracesKey = key;
      this.traces ??= document.createElement("canvas");
      [this.traces.width, this.traces.height] = [this.canvas.width, this.canvas.height];
      const layer = this.traces.getContext("2d");
      layer.scale(ratio, ratio);
      for (const point of traced) {
        this.runAlong(layer, this.thinned(point), -Infinity, Infinity, mix(Theme.surface, this.pointColour(point), 0.5), 1.6);
      }
    }
    ctx.drawImage(this.traces, 0, 0, this.w, this.h);
    for (const point of traced) {
      this.runAlong(ctx, this.thinned(point), motion.now - 0.15 * motion.span, motion.now, this.pointColour(point), 2.4, this.placeOf(point.body, point.point));
    }
  }

  // Places of a way that are a pixel apart at this zoom: a frame costs what is seen, however many instants there are.
  thinned(point) {
    const { s } = this.view, { way } = point;
    if (point.thin?.s === s && point.thin.way === way) return point.thin.kept;
    let last = null;
    const kept = way.filter(({ p }, k) => {
      if (p && last && k < way.length - 1 && (Math.abs(p[0] - last[0]) + Math.abs(p[1] - last[1])) * s < 0.7) return false;
      last = p;
      return true;
    });
    point.thin = { s, way, kept };
    return kept;
  }

  // In pieces, for long paths which cross themselves are slow to stroke.
  runAlong(ctx, way, from, to, colour, width, end = null) {
    ctx.lineJoin = ctx.lineCap = "round";
    ctx.beginPath();
    let on = false, count = 0;
    for (let k = placeAfter(way, from); k < way.length && way[k].t <= to; k++) {
      const { p } = way[k];
      if (!p) { on = false; continue; }
      const [x, y] = this.screen(p);
      if (on) ctx.lineTo(x, y); else ctx.moveTo(x, y);
      on = true;
      if (++count % 100) continue;
      stroke(ctx, colour, width);
      ctx.beginPath();
      ctx.moveTo(x, y);
    }
    if (on && end) ctx.lineTo(end[0], end[1]);
    stroke(ctx, colour, width);
    ctx.lineCap = "butt";
  }

  pointColour(point) { return Theme.colour(point.index + 3); }

  drawBodies() {
    const layers = [["disc", "curve"], ["block", "polygon"], ["bar", "line", "particle"]];
    const radius = (shape) => shape.radius || 0;
    layers.forEach((kinds, layer) => {
      const todo = [];
      for (const body of this.motion.bodies) {
        for (const shape of body.shapes) if (kinds.includes(shape.kind)) todo.push({ body, shape });
      }
      if (layer === 0) todo.sort((p, q) => radius(q.shape) - radius(p.shape));
      for (const { body, shape } of todo) {
        const pose = this.poses.get(body);
        if (!pose) continue;
        const look = this.looks[body.index];
        this.drawShape(shape, pose, this.hover?.item === body ? { ...look, edge: Theme.accent, width: 2.6 } : look);
      }
    });
    for (const body of this.motion.bodies) {
      const pose = this.poses.get(body);
      if (pose && !body.node && !body.shapes.length && !body.of) centreMark(this.ctx, this.screen([pose.x, pose.y]), this.half, this.looks[body.index].edge, Theme.surface);
    }
  }

  // Bodies of another design, or where they were given, behind those where they came to.
  drawGhosts() {
    this.ctx.globalAlpha = this.motion.n > 1 ? 0.5 : 0.25;
    const look = { edge: Theme.muted, fill: Theme.surface, width: 1.5 };
    for (const ghost of this.show.ghosts ? this.motion.ghosts : []) {
      const pose = this.motion.pose(ghost);
      if (pose) for (const shape of ghost.shapes) this.drawShape(shape, pose, look);
    }
    this.ctx.globalAlpha = 1;
  }

  // Two points that should meet, and how far they are apart.
  drawGaps() {
    const { ctx } = this;
    for (const gap of this.motion.gaps) {
      const [p, q] = [this.screen(gap.from), this.screen(gap.to)];
      trace(ctx, [p, q]);
      stroke(ctx, Theme.error, 2.4, [6, 4]);
      for (const end of [p, q]) { circle(ctx, end, this.half + 4); stroke(ctx, Theme.error, 2); }
      ctx.font = `600 13px ${Theme.font}`;
      const wide = ctx.measureText(gap.text).width / 2 + 8;
      const x = clamp((p[0] + q[0]) / 2, wide, this.w - wide);
      label(ctx, gap.text, [x, Math.max(p[1], q[1]) + this.half + 20], Theme.error, Theme.surface);
    }
  }

  drawShape(shape, pose, look) {
    const { ctx, half } = this;
    const put = (p) => this.screen(toWorld(pose, p));
    switch (shape.kind) {
      case "bar": return plate(ctx, [put(shape.from), put(shape.to)], half, look);
      case "polygon": return plate(ctx, shape.points.map(put), half, look);
      case "disc": return wheel(ctx, put(shape.center), shape.radius * this.view.s, pose.a ?? 0, look, this.teeth.get(shape));
      case "block":
        trace(ctx, corners(shape).map(put), true);
        return solid(ctx, look);
      case "curve":
        trace(ctx, shape.points.map(put), shape.closed);
        if (shape.closed) return solid(ctx, look);
        ctx.lineJoin = "round";
        return stroke(ctx, look.edge, 2);
      case "line":
        trace(ctx, [put(shape.from), put(shape.to)]);
        return stroke(ctx, look.edge, 2);
      case "particle":
        circle(ctx, put(shape.center), 1.15 * half);
        return solid(ctx, { ...look, fill: look.edge });
    }
  }

  drawLink({ link, rest, offset }) {
    const p = this.placeOf(link.i.body, link.i.point), q = this.placeOf(link.j.body, link.j.point);
    if (!p || !q) return;
    const strand = link.symbol === "strand", colours = strand ? { ...this.colours, ink: this.strandLook(link).edge } : this.colours;
    linkSymbol(this.ctx, link.symbol, p, q, this.half, rest * this.view.s, offset * this.half, colours);
    if (strand) return;
    for (const [end, at] of [[link.i, p], [link.j, q]]) {
      circle(this.ctx, at, clamp(0.32 * this.half, 1.8, 4));
      this.ctx.fillStyle = this.colours.ink;
      this.ctx.fill();
      if (end.body.fixed && !this.motion.joints.some((j) => j.body.fixed && Math.hypot(j.point[0] - end.point[0], j.point[1] - end.point[1]) < this.unit)) {
        this.drawAnchor(at, end === link.i ? q : p);
      }
    }
  }

  // All pieces of a beam have the colour of the first one.
  strandLook(link) {
    return this.looks[this.motion.links.find((other) => other.name === link.name).j.body.index];
  }

  // A short hatched wall behind the fixed end of a link.
  drawAnchor(at, toward) {
    const [dx, dy] = [toward[0] - at[0], toward[1] - at[1]], L = Math.hypot(dx, dy) || 1, r = 2.4 * this.half;
    const [nx, ny] = [(-dy / L) * r, (dx / L) * r];
    const [a, b] = [[at[0] - nx, at[1] - ny], [at[0] + nx, at[1] + ny]];
    trace(this.ctx, [a, b]);
    stroke(this.ctx, this.colours.ink, 1.8);
    hatch(this.ctx, a, b, this.colours.ink, Math.max(3.5, 0.7 * this.half), 0.8 * this.half);
  }

  drawPoints() {
    const { ctx } = this;
    for (const point of this.motion.spots) {
      const p = this.placeOf(point.body, point.point);
      if (!p) continue;
      const colour = this.pointColour(point);
      const r = point.traced ? clamp(0.5 * this.half, 3, 5) : 2.2;
      circle(ctx, p, r);
      ctx.fillStyle = point.traced || this.hover?.item === point ? colour : Theme.surface;
      ctx.fill();
      stroke(ctx, point.traced ? Theme.surface : colour, 1.4);
    }
  }

  // Loads that are there are seen: an arrow has a least length; its value stands beside it.
  arrowWay(kind, fx, fy, scale) {
    const size = Math.hypot(fx, fy), least = size > 1e-3 * this.greatest[kind] ? 18 / size : 0, k = Math.max(scale, least);
    return [fx * k, -fy * k];
  }

  loadScale() { return (0.16 * this.sizes.load * Math.min(this.w, this.h)) / (this.greatest.load || 1); }
  forceScale() { return (0.26 * this.sizes.force * Math.min(this.w, this.h)) / (this.greatest.force || 1); }

  // How far round the arc of a moment goes.
  sweep(kind, m) { return clamp((m / (this.greatest[kind] || 1)) * this.sizes[kind] * 0.78, -0.94, 0.94) * TAU; }

  // The value of a load beside the head of its arrow, where there is room for all of them.
  readLoad(kind, value, [x, y], [u, v]) {
    const length = Math.hypot(u, v) || 1, count = LOADS[kind].reaction ? this.loaded.length : this.motion.symbols.length;
    if (!this.show.labels || count > READABLE || !(value > 1e-5 * this.greatest[kind])) return;
    this.ctx.font = `600 11px ${Theme.font}`;
    const wide = this.ctx.measureText(loadText(kind, value)).width / 2 + 6;
    const at = [x + u + (u / length) * (wide + 4), y + v + (v / length) * 12];
    label(this.ctx, loadText(kind, value), at, LOADS[kind].reaction ? Theme[kind] : this.colours.load, Theme.surface);
  }

  drawForces() {
    const { ctx, motion } = this;
    const scale = this.forceScale(), radius = 2.2 * this.half + 8;
    for (const joint of this.loaded) {
      const p = this.placeOf(joint.body, joint.point);
      if (!p) continue;
      const { fx, fy, m } = this.load(joint);
      if (fx === fx && fy === fy) {
        const way = this.arrowWay("force", fx, fy, scale);
        arrow(ctx, p, way, Theme.force, Theme.surface);
        this.readLoad("force", Math.hypot(fx, fy), p, way);
      }
      if (this.greatest.moment > 0 && m === m) momentArc(ctx, p, radius, this.sweep("moment", m), Theme.moment, Theme.surface);
      if (this.greatest.moment > 0 && m === m) this.readLoad("moment", Math.abs(m), p, [0, radius + 4]);
    }
  }

  load(item) {
    const at = (column) => (column ? this.motion.sample(column, this.motion.cursor) : 0);
    return { fx: at(item.fx), fy: at(item.fy), m: at(item.m) };
  }

  angleOf(body) { return this.poses.get(body)?.a ?? null; }

  // How far the second body has turned against the first since the start.
  turn({ i, j }) {
    const [a, b] = [this.angleOf(i), this.angleOf(j)], start = { i: 0, f: 0 };
    if (a === null || b === null) return null;
    const [from, to] = [i, j].map((body) => this.motion.pose(body, start)?.a ?? 0);
    return b - a - (to - from);
  }
}

// The first of the instants of a way that is not before a time.
function placeAfter(way, time) {
  let low = 0, high = way.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (way[middle].t < time) low = middle + 1; else high = middle;
  }
  return low;
}
