// The drawing of the mechanism: what is read off the motion, and what is under the pointer.

class Scene extends SceneMarks {
  constructor(motion, canvas, tip) {
    super();
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
      text: mix(colour, ink, 0.35),
      width: 1.6,
    };
  }

  get vector() { return true; }
  get hint() { return "Wheel zooms, drag pans."; }

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
    const position = (p) => { if (p) p.forEach((v, k) => rows.push(["xy"[k], inUnits([v], "m", { scale: this.w / this.view.s })])); };
    let what = kind;
    if (kind === "body") {
      const pose = this.poses.get(item);
      position([pose.x, pose.y]);
      rows.push(["angle", degrees(pose.a)]);
    } else if (kind === "link") {
      what = item.description;
      const [p, q] = [item.i, item.j].map((end) => toWorld(this.poses.get(end.body), end.point));
      rows.push(["length", inUnits([Math.hypot(q[0] - p[0], q[1] - p[1])], "m")]);
    } else {
      position(motion.at(item.body, item.point));
      if (kind === "point") rows.push(["on", item.body.name], ...item.names.slice(1).map((name) => ["also", name]));
      if (kind === "joint" || kind === "symbol") {
        what = item.description;
        const { fx, fy, m } = this.load(item);
        if (item.fx || item.fy) rows.push(["force", inUnits([Math.hypot(fx, fy)], "N")], ["Fx, Fy", inUnits([fx, fy], "N")]);
        if (item.m) rows.push(["moment", inUnits([m], "N m")]);
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
