// The drawing of the mechanism: view, layers, what is under the pointer.

class Scene {
  constructor(motion, canvas, tip) {
    Object.assign(this, { motion, canvas, tip });
    this.box = motion.envelope();
    this.unit = this.symbolSize();
    this.view = { x: 0, y: 0, s: 1 };
    this.fitted = true;
    this.show = { labels: motion.bodies.filter((body) => body.label).length <= 12, forces: false, grid: true, ghosts: true };
    this.pointer = null;
    this.pending = false;
    this.ratio = undefined;
    this.sizes = newSizes();
    this.guides = this.findGuides();
    this.teeth = this.findTeeth();
    this.bundles = this.bundleLinks();
    this.scaleForces();
    motion.chooseTraces(this.box.x1 - this.box.x0);
    const size = ({ x0, x1, y0, y1 }) => Math.hypot(x1 - x0, y1 - y0);
    this.followed = motion.moves ? motion.traveller(size(this.box), size(motion.envelope([{ i: 0, f: 0 }]))) : null;
    this.bindPointer();
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  // The motion has become that of another design: all that was read off it is read again.
  renew(traced) {
    const { motion, box } = this, next = motion.envelope();
    this.box = { x0: Math.min(box.x0, next.x0), x1: Math.max(box.x1, next.x1), y0: Math.min(box.y0, next.y0), y1: Math.max(box.y1, next.y1) };
    this.guides = this.findGuides();
    this.teeth = this.findTeeth();
    this.bundles = this.bundleLinks();
    this.scaleForces();
    motion.chooseTraces(this.box.x1 - this.box.x0);
    for (const point of motion.points) point.traced = traced.has(point.name);
    this.tracesKey = null;
    if (this.fitted) this.fit(); else this.invalidate();
  }

  // Half the width of a bar in metres: small against the picture and against the bars.
  symbolSize() {
    const { x0, x1, y0, y1 } = this.box;
    const whole = Math.hypot(x1 - x0, y1 - y0);
    const lengths = [];
    for (const body of this.motion.bodies) {
      for (const shape of body.shapes) {
        if (shape.kind === "bar") lengths.push(Math.hypot(shape.to[0] - shape.from[0], shape.to[1] - shape.from[1]));
      }
    }
    lengths.sort((a, b) => a - b);
    const typical = lengths.length ? lengths[Math.floor(0.3 * lengths.length)] : Infinity;
    return clamp(Math.min(0.0115 * whole, 0.16 * typical), 0.003 * whole, whole);
  }

  // Straight guides: ground lines. A guide through the middle of a block is drawn as two rails.
  findGuides() {
    const { motion } = this;
    const frames = motion.frames(24);
    const guides = motion.ground.shapes.filter((s) => s.kind === "line").map((s) => ({ from: s.from, to: s.to, half: 0 }));
    for (const guide of guides) {
      const angle = Math.atan2(guide.to[1] - guide.from[1], guide.to[0] - guide.from[0]);
      for (const body of motion.bodies) {
        for (const block of body.shapes.filter((s) => s.kind === "block")) {
          const along = frames.every((cursor) => {
            const pose = motion.pose(body, cursor);
            return pose && Math.abs(Math.sin(pose.a + block.angle - angle)) < 0.05
              && distanceToLine(toWorld(pose, block.center), guide.from, guide.to) < 0.15 * block.height;
          });
          if (along && frames.length) guide.half = Math.max(guide.half, block.height / 2);
        }
      }
    }
    return guides;
  }

  // The discs of gears in mesh get teeth, of one pitch each mesh.
  findTeeth() {
    const { motion } = this;
    const teeth = new Map(), start = { i: 0, f: 0 };
    for (const { mesh, internal } of motion.joints) {
      const [p, q] = mesh.map(({ body, point }) => (motion.n ? motion.at(body, point, start) : null));
      if (!p || !q) continue;
      const line = Math.atan2(q[1] - p[1], q[0] - p[0]);
      const wheels = mesh.map(({ body, point, radius }, k) => ({
        disc: body.shapes.find((s) => s.kind === "disc" && Math.hypot(s.center[0] - point[0], s.center[1] - point[1]) < 1e-6 * radius && Math.abs(s.radius - radius) < 1e-6 * radius),
        radius, angle: line + (k && !internal ? Math.PI : 0) - (body.fixed ? 0 : motion.pose(body, start).a),
      }));
      if (wheels.some(({ disc }) => !disc)) continue;
      const known = wheels.find(({ disc }) => teeth.has(disc));
      const pitch = known ? (TAU * known.radius) / teeth.get(known.disc).count : (TAU * Math.min(...wheels.map((w) => w.radius))) / 20;
      wheels.forEach(({ disc, radius, angle }, k) => {
        if (teeth.has(disc)) return;
        const count = Math.max(6, Math.round((TAU * radius) / pitch));
        teeth.set(disc, { count, phase: angle + (k % 2 ? TAU / count / 2 : 0) });
      });
    }
    return teeth;
  }

  // Links between the same two places lie beside each other.
  bundleLinks() {
    const groups = new Map();
    const place = (end) => `${end.body.name}@${end.point.map((v) => v.toPrecision(6))}`;
    const bundles = this.motion.links.map((link) => {
      const key = [place(link.i), place(link.j)].sort().join("|");
      const lengths = this.motion.frames(60).map((cursor) => {
        const [p, q] = [this.motion.at(link.i.body, link.i.point, cursor), this.motion.at(link.j.body, link.j.point, cursor)];
        return p && q ? Math.hypot(q[0] - p[0], q[1] - p[1]) : NaN;
      }).filter((v) => !Number.isNaN(v));
      const rest = lengths.reduce((sum, v) => sum + v, 0) / (lengths.length || 1);
      groups.set(key, [...(groups.get(key) || []), link]);
      return { link, key, rest };
    });
    for (const bundle of bundles) {
      const mates = groups.get(bundle.key);
      bundle.offset = (mates.indexOf(bundle.link) - (mates.length - 1) / 2) * 3.4;
    }
    return bundles;
  }

  // The greatest reactions give the scale of the arrows and arcs.
  scaleForces() {
    let force = 0, moment = 0;
    this.loaded = this.motion.joints.filter((j) => j.fx || j.fy || j.m);
    for (const { fx, fy, m } of this.loaded) {
      for (let i = 0; i < this.motion.n; i++) {
        const size = Math.hypot((fx && fx[i]) || 0, (fy && fy[i]) || 0);
        if (size > force) force = size;
        if (m && Math.abs(m[i]) > moment) moment = Math.abs(m[i]);
      }
    }
    this.greatest = { force, moment, load: 0, twist: 0 };
    for (const { fx, fy, m } of this.motion.symbols) {
      for (let i = 0; i < this.motion.n; i++) {
        if (fx) this.greatest.load = Math.max(this.greatest.load, Math.hypot(fx[i], fy[i]) || 0);
        if (m) this.greatest.twist = Math.max(this.greatest.twist, Math.abs(m[i]) || 0);
      }
    }
  }

  restyle() {
    const { ink, surface, muted } = Theme;
    this.colours = {
      ink: mix(ink, surface, 0.12), surface, ground: mix(surface, ink, 0.1),
      spring: Theme.colour(2), actuator: mix(surface, Theme.colour(4), 0.45), muted,
      drive: mix(Theme.colour(4), ink, 0.2), load: ink,
    };
    this.looks = this.motion.bodies.map((_, i) => this.look(Theme.colour(i)));
    this.groundLook = { fill: mix(surface, ink, 0.13), edge: mix(surface, ink, 0.62), width: 1.5, text: muted };
    this.invalidate();
  }

  look(colour) {
    const { ink, surface, name } = Theme;
    return {
      fill: mix(surface, colour, name === "dark" ? 0.42 : 0.34),
      edge: name === "dark" ? colour : mix(colour, ink, 0.25),
      text: name === "dark" ? mix(colour, ink, 0.35) : mix(colour, ink, 0.35),
      width: 1.6,
    };
  }

  get vector() { return true; }
  get hint() { return "Wheel zooms, drag pans."; }

  // View ------------------------------------------------------------------

  resize() {
    if (this.fitted) this.fit(); else this.invalidate();
  }

  fit() {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const { x0, x1, y0, y1 } = this.followed ? this.motion.envelope([this.motion.cursor]) : this.box;
    this.anchor = null;
    const side = Math.min(60, 0.09 * w), top = 44, bottom = 58;
    this.view.s = Math.max(1e-9, Math.min((w - 2 * side) / (x1 - x0), (h - top - bottom) / (y1 - y0)));
    this.view.x = (x0 + x1) / 2;
    this.view.y = (y0 + y1) / 2 - (bottom - top) / 2 / this.view.s;
    this.fitted = true;
    this.home = this.view.s;
    this.invalidate();
  }

  // The view goes with a body; null lets it stand.
  follow(body) {
    this.followed = body;
    this.fit();
  }

  keepUp() {
    const pose = this.followed && this.poses.get(this.followed);
    if (!pose) return;
    this.anchor ??= [this.view.x - pose.x, this.view.y - pose.y];
    [this.view.x, this.view.y] = [pose.x + this.anchor[0], pose.y + this.anchor[1]];
  }

  shift(dx, dy) {
    this.view.x += dx;
    this.view.y += dy;
    if (this.anchor) { this.anchor[0] += dx; this.anchor[1] += dy; }
  }

  zoom(factor, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
    const before = this.world([px, py]);
    this.view.s = clamp(this.view.s * factor, this.home / 20, this.home * 200);
    const after = this.world([px, py]);
    this.shift(before[0] - after[0], before[1] - after[1]);
    this.fitted = false;
    this.invalidate();
  }

  pan(dx, dy) {
    this.shift(-dx / this.view.s, dy / this.view.s);
    this.fitted = false;
    this.invalidate();
  }

  screen([x, y]) {
    return [this.canvas.clientWidth / 2 + (x - this.view.x) * this.view.s, this.canvas.clientHeight / 2 - (y - this.view.y) * this.view.s];
  }

  world([px, py]) {
    return [this.view.x + (px - this.canvas.clientWidth / 2) / this.view.s, this.view.y - (py - this.canvas.clientHeight / 2) / this.view.s];
  }

  bindPointer() {
    const { canvas } = this;
    const down = new Map();
    const place = (e) => { const r = canvas.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoom(Math.exp(-clamp(e.deltaY * (e.deltaMode ? 30 : 1), -300, 300) * 0.0016), ...place(e));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (e) => {
      down.set(e.pointerId, place(e));
      canvas.setPointerCapture(e.pointerId);
      this.pointer = place(e);
      this.invalidate();
    });
    canvas.addEventListener("pointermove", (e) => {
      const now = place(e), was = down.get(e.pointerId);
      if (was) {
        const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
        if (other) {
          const ratio = Math.hypot(now[0] - other[0], now[1] - other[1]) / Math.max(1, Math.hypot(was[0] - other[0], was[1] - other[1]));
          this.zoom(ratio, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
        } else this.pan(now[0] - was[0], now[1] - was[1]);
        down.set(e.pointerId, now);
        canvas.classList.add("grabbing");
      }
      this.pointer = now;
      this.invalidate();
    });
    const up = (e) => { down.delete(e.pointerId); if (!down.size) canvas.classList.remove("grabbing"); };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("pointerleave", (e) => { if (e.pointerType === "mouse") { this.pointer = null; this.invalidate(); } });
    canvas.addEventListener("dblclick", () => this.fit());
    document.addEventListener("pointerdown", (e) => { if (e.target !== canvas) { this.pointer = null; this.invalidate(); } });
  }

  // Drawing ---------------------------------------------------------------

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  // On the canvas, or on paper of the same size that takes the same calls.
  draw(paper = null) {
    if (!this.colours || !this.canvas.clientWidth) return;
    const { motion, colours } = this;
    const { ctx, w, h } = paper ? { ctx: paper, w: paper.w, h: paper.h } : fitCanvas(this.canvas, this.ratio);
    Object.assign(this, { ctx, w, h });
    this.poses = new Map([[motion.ground, motion.still], ...motion.bodies.map((b) => [b, motion.n ? motion.pose(b) : null])]);
    this.keepUp();
    this.half = clamp(this.unit * this.view.s, 2.2, 13);
    this.hover = this.pointer && this.hit(this.pointer);

    if (this.show.grid) this.drawGrid();
    this.drawGround();
    for (const joint of motion.joints) {
      const p = joint.grounded && this.placeOf(joint.body, joint.point);
      if (p && joint.symbol === "pin") groundPivot(ctx, p, this.half, colours, this.tilt);
      if (p && joint.symbol === "clamp") this.drawAnchor(p, this.middleOf(joint.on) || [p[0], p[1] - 1]);
    }
    this.drawGhosts();
    this.drawBodies();
    this.drawTraces();
    for (const bundle of this.bundles) this.drawLink(bundle);
    for (const item of motion.symbols) if (!item.fx && !item.m) LOOKS[item.symbol]?.(this, item);
    for (const joint of motion.joints) {
      const p = this.placeOf(joint.body, joint.point);
      if (!p) continue;
      if (this.hover?.item === joint) { circle(ctx, p, this.half + 5); stroke(ctx, Theme.accent, 2); }
      jointMark(ctx, joint, p, this.half, colours);
    }
    for (const item of motion.symbols) if (item.fx || item.m) LOOKS[item.symbol]?.(this, item);
    this.drawPoints();
    this.drawGaps();
    if (this.show.forces) this.drawForces();
    if (this.show.labels) this.drawLabels();
    this.drawScale();
    if (motion.gravity) this.drawGravity();
    this.drawTip();
  }

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
      for (const point of traced) this.runAlong(ctx, point.way, 0, point.way.length, this.pointColour(point), 1.6);
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
        this.runAlong(layer, point.way, 0, point.way.length, mix(Theme.surface, this.pointColour(point), 0.5), 1.6);
      }
    }
    ctx.drawImage(this.traces, 0, 0, this.w, this.h);
    for (const point of traced) {
      let last = 0, high = point.way.length;
      while (last < high) {
        const middle = (last + high) >> 1;
        if (point.way[middle].t <= motion.now) last = middle + 1; else high = middle;
      }
      const first = Math.max(0, last - Math.ceil(0.15 * point.way.length));
      this.runAlong(ctx, point.way, first, last, this.pointColour(point), 2.4, this.placeOf(point.body, point.point));
    }
  }

  // In pieces, for long paths which cross themselves are slow to stroke.
  runAlong(ctx, way, first, last, colour, width, end = null) {
    ctx.lineJoin = ctx.lineCap = "round";
    ctx.beginPath();
    let on = false, count = 0, x = NaN, y = NaN;
    for (let k = first; k < last; k++) {
      const { p } = way[k];
      if (!p) { on = false; continue; }
      const q = this.screen(p);
      if (on && Math.abs(q[0] - x) + Math.abs(q[1] - y) < 0.7) continue;
      [x, y] = q;
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
    if (!this.show.labels || count > READABLE || !(value > 1e-9 * this.greatest[kind])) return;
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

  drawLabels() {
    const { ctx, half } = this;
    const middle = ({ i, j }) => {
      const p = this.placeOf(i.body, i.point), q = this.placeOf(j.body, j.point);
      return p && q && [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
    };
    const pins = [...this.motion.joints.map((j) => this.placeOf(j.body, j.point)), ...this.motion.links.map(middle)].filter(Boolean);
    const taken = this.drawJointNames();
    ctx.font = `600 12px ${Theme.font}`;
    for (const body of this.motion.bodies) {
      const pose = this.poses.get(body);
      if (!pose || !body.label) continue;
      const wide = ctx.measureText(body.label).width / 2;
      const places = this.labelPlaces(body, pose, wide);
      const cost = ([x, y], more = 0) => {
        const covers = ([px, py], dx, dy) => Math.abs(px - x) < wide + dx + more && Math.abs(py - y) < 8 + dy + more;
        return pins.filter((p) => covers(p, half, half)).length + 2 * taken.filter((t) => covers(t.at, t.wide, 8)).length
          + (Math.abs(x - this.w / 2) > this.w / 2 - wide || Math.abs(y - this.h / 2) > this.h / 2 - 8 ? 3 : 0);
      };
      // A label keeps its place until another one is better, or the best one is clear again.
      const costs = places.map((place) => cost(place)), least = Math.min(...costs);
      if (!(costs[body.side] <= least)) body.side = costs.indexOf(least);
      if (body.side && !cost(places[0], 10)) body.side = 0;
      const at = places[body.side];
      taken.push({ at, wide });
      label(ctx, body.label, at, this.looks[body.index].text, Theme.surface);
    }
  }

  // Short joint names, at the corner of the joint which lies on the fewest bodies.
  drawJointNames() {
    const joints = this.motion.joints.filter((j) => j.name && j.name.length <= 3);
    if (joints.length > 24) return [];
    const bodies = [...this.poses].filter(([, pose]) => pose);
    const cost = (place, reach) => bodies.filter(([body, pose]) => {
      const p = toBody(pose, this.world(place));
      return body.shapes.some((shape) => inShape(shape, p, reach / this.view.s));
    }).length;
    this.ctx.font = `italic 12px ${Theme.font}`;
    return joints.map((joint) => {
      const p = this.placeOf(joint.body, joint.point);
      if (!p) return null;
      const [dx, dy] = [1.1 * this.half + 7, 0.9 * this.half + 5];
      const places = [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([u, v]) => [p[0] + u * dx, p[1] + v * dy]);
      const costs = places.map((place) => cost(place, this.half + 4)), least = Math.min(...costs);
      if (!(costs[joint.side] <= least)) joint.side = costs.indexOf(least);
      const at = places[joint.side];
      label(this.ctx, joint.name, at, Theme.muted, Theme.surface);
      return { at, wide: 7 };
    }).filter(Boolean);
  }

  // Where the name of a body may stand, best first: beside a bar, in a plate, about the rest.
  labelPlaces(body, pose, wide) {
    const bar = body.shapes.length === 1 && body.shapes[0].kind === "bar" && body.shapes[0];
    if (bar) {
      const [a, b] = [bar.from, bar.to].map((p) => this.screen(toWorld(pose, p)));
      const L = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const [nx, ny] = [(b[1] - a[1]) / L, -(b[0] - a[0]) / L];
      const gap = this.half + 11 + (wide - 6) * Math.abs(nx);
      return [1, -1].flatMap((sign) => [0.5, 0.33, 0.67].map((k) => [a[0] + k * (b[0] - a[0]) + sign * nx * gap, a[1] + k * (b[1] - a[1]) + sign * ny * gap]));
    }
    const points = body.shapes.length ? body.shapes.flatMap(outline) : [[0, 0]];
    const seen = points.map((p) => this.screen(toWorld(pose, p)));
    const [x0, x1] = extent([seen.map((p) => p[0])]), [y0, y1] = extent([seen.map((p) => p[1])]);
    const [x, y, pad] = [(x0 + x1) / 2, (y0 + y1) / 2, 12 + (body.shapes.some((s) => s.kind === "polygon" || s.kind === "bar" || s.kind === "particle") || !body.shapes.length ? this.half : 0)];
    const around = [[x, y0 - pad], [x, y1 + pad], [x1 + pad + wide - 4, y], [x0 - pad - wide + 4, y]];
    if (!body.shapes.some((s) => s.kind === "polygon") || Math.min(x1 - x0, y1 - y0) < 2 * wide) return around;
    return [[seen.reduce((sum, p) => sum + p[0], 0) / seen.length, seen.reduce((sum, p) => sum + p[1], 0) / seen.length], ...around];
  }

  drawScale() {
    const { ctx, h, w } = this;
    const size = niceAbove(70 / this.view.s), length = size * this.view.s;
    const [x, y] = [18, h - 20];
    const ink = mix(Theme.ink, Theme.surface, 0.2);
    trace(ctx, [[x, y - 5], [x, y], [x + length, y], [x + length, y - 5]]);
    ctx.lineJoin = "miter";
    stroke(ctx, Theme.surface, 4);
    stroke(ctx, ink, 1.5);
    ctx.font = `12px ${Theme.font}`;
    label(ctx, metres(size), [x + length / 2, y - 11], ink, Theme.surface);
    if (this.ratio && this.motion.moves) label(ctx, `t = ${clock(this.motion.now, this.motion.span)} s`, [w - 16, 24], ink, Theme.surface, "right");
    let right = w - 18;
    const legend = (text, draw, width) => {
      const room = Math.max(width, ctx.measureText(text).width);
      draw([right - room / 2 - width / 2, y]);
      label(ctx, text, [right - room / 2, y - 17], ink, Theme.surface);
      right -= room + 26;
    };
    if (this.greatest.load > 0) {
      const n = niceAbove(this.greatest.load * 0.2), length = n * this.loadScale();
      legend(`${number(n, 2)} N applied`, (p) => arrow(ctx, p, [length, 0], this.colours.load, Theme.surface, 2.8), length);
    }
    if (!this.show.forces) return;
    if (this.greatest.force > 0) {
      const n = niceAbove(this.greatest.force * 0.2);
      legend(`${number(n, 2)} N`, (p) => arrow(ctx, p, [n * this.forceScale(), 0], Theme.force, Theme.surface), n * this.forceScale());
    }
    if (this.greatest.moment > 0) {
      const n = niceAbove(this.greatest.moment * 0.2), r = 8;
      legend(`${number(n, 2)} N·m`, (p) => momentArc(ctx, [p[0] + r, p[1] + 1], r, this.sweep("moment", n), Theme.moment, Theme.surface), 2 * r);
    }
  }

  drawGravity() {
    const { ctx } = this;
    const [gx, gy] = this.motion.gravity, size = Math.hypot(gx, gy);
    const [ux, uy] = [gx / size, -gy / size], c = [32, 34];
    arrow(ctx, [c[0] - 15 * ux, c[1] - 15 * uy], [30 * ux, 30 * uy], Theme.muted, Theme.surface, 1.6);
    ctx.font = `italic 13px ${Theme.font}`;
    label(ctx, "g", [c[0] + 13 * Math.abs(uy) , c[1] + 14 * Math.abs(ux)], Theme.muted, Theme.surface);
  }

  // What is under the pointer ----------------------------------------------

  hit([px, py]) {
    const near = (p, r) => p && Math.hypot(p[0] - px, p[1] - py) <= r;
    for (const joint of this.motion.joints) {
      if (near(this.placeOf(joint.body, joint.point), Math.max(8, this.half))) return { kind: "joint", item: joint };
    }
    for (const point of this.motion.spots) {
      if (near(this.placeOf(point.body, point.point), 8)) return { kind: "point", item: point };
    }
    for (const { link, offset } of this.bundles) {
      const p = this.placeOf(link.i.body, link.i.point), q = this.placeOf(link.j.body, link.j.point);
      if (p && q && distanceToSegment([px, py], p, q) < this.half * (1.3 + Math.abs(offset)) + 3) return { kind: "link", item: link };
    }
    for (const item of this.motion.symbols) {
      if (item.body && near(this.placeOf(item.body, item.point), 3 * this.half)) return { kind: "symbol", item };
    }
    const order = ["bar", "line", "particle", "block", "polygon", "curve", "disc"];
    let best = null, rank = Infinity;
    for (const body of this.motion.bodies) {
      const pose = this.poses.get(body);
      if (!pose) continue;
      const p = toBody(pose, this.world([px, py]));
      const reach = (this.half + 2) / this.view.s;
      if (!body.shapes.length && Math.hypot(...p) < reach) best = { kind: "body", item: body };
      for (const shape of body.shapes) {
        const k = order.indexOf(shape.kind) + (shape.radius ? 1 - 1 / (1 + shape.radius) : 0);
        if (k < rank && inShape(shape, p, reach)) [best, rank] = [{ kind: "body", item: body }, k];
      }
    }
    return best;
  }

  drawTip() {
    const { tip, hover, motion } = this;
    tip.hidden = !hover || this.canvas.classList.contains("grabbing");
    if (tip.hidden) return;
    const { kind, item } = hover;
    const rows = [];
    const position = (p) => { if (p) rows.push(["x", `${number(p[0])} m`], ["y", `${number(p[1])} m`]); };
    let what = kind;
    if (kind === "body") {
      const pose = this.poses.get(item);
      position([pose.x, pose.y]);
      rows.push(["angle", degrees(pose.a)]);
    } else if (kind === "link") {
      what = item.what;
      const [p, q] = [item.i, item.j].map((end) => toWorld(this.poses.get(end.body), end.point));
      rows.push(["length", `${number(Math.hypot(q[0] - p[0], q[1] - p[1]))} m`]);
    } else {
      position(motion.at(item.body, item.point));
      if (kind === "point") rows.push(["on", item.body.name], ...item.names.slice(1).map((name) => ["also", name]));
      if (kind === "joint" || kind === "symbol") {
        what = item.what;
        const { fx, fy, m } = this.load(item);
        if (item.fx || item.fy) rows.push(["force", `${number(Math.hypot(fx, fy))} N`], ["Fx, Fy", `${number(fx)}, ${number(fy)} N`]);
        if (item.m) rows.push(["moment", `${number(m)} N·m`]);
      }
    }
    tip.replaceChildren(el("strong", {}, item.name || what), el("span", { class: "what" }, item.name ? what : ""),
      el("dl", {}, rows.map(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])));
    const [px, py] = this.pointer;
    const x = px + 16 + tip.offsetWidth > this.w ? px - 14 - tip.offsetWidth : px + 16;
    tip.style.transform = `translate(${Math.max(4, x)}px, ${clamp(py + 14, 4, Math.max(4, this.h - tip.offsetHeight - 4))}px)`;
  }
}

function distanceToLine(p, a, b) {
  const L = Math.hypot(b[0] - a[0], b[1] - a[1]);
  return L > 0 ? Math.abs(cross(a, b, p)) / L : Math.hypot(p[0] - a[0], p[1] - a[1]);
}

function distanceToSegment(p, a, b) {
  const dx = b[0] - a[0], dy = b[1] - a[1], LL = dx * dx + dy * dy;
  const t = LL > 0 ? clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / LL, 0, 1) : 0;
  return Math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

function inside(p, points) {
  let odd = false;
  for (let i = 0, j = points.length - 1; i < points.length; j = i++) {
    const [a, b] = [points[i], points[j]];
    if (a[1] > p[1] !== b[1] > p[1] && p[0] < ((b[0] - a[0]) * (p[1] - a[1])) / (b[1] - a[1]) + a[0]) odd = !odd;
  }
  return odd;
}

function inShape(shape, p, reach) {
  const from = (c) => Math.hypot(p[0] - c[0], p[1] - c[1]);
  const alongEdge = (points, closed) => points.some((q, i) => (i || closed) && distanceToSegment(p, points.at(i - 1), q) < reach);
  switch (shape.kind) {
    case "bar": case "line": return distanceToSegment(p, shape.from, shape.to) < reach;
    case "disc": return from(shape.center) < shape.radius + reach / 3;
    case "particle": return from(shape.center) < reach;
    case "block": return inside(p, corners(shape));
    case "curve": return alongEdge(shape.points, shape.closed) || (shape.closed && inside(p, shape.points));
    default: return alongEdge(shape.points, true) || inside(p, shape.points);
  }
}
