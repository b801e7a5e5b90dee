// The data of the report in typed columns, and what they say at any time.

class Motion {
  constructor(payload) {
    const scene = payload.scene || {};
    this.title = String(payload.title || "mechanism");
    this.time = Float64Array.from(list(payload.time), (t, i, all) => (isNum(t) ? t : NaN)).filter((t) => !Number.isNaN(t));
    this.n = this.time.length;
    this.start = this.n ? this.time[0] : 0;
    this.end = this.n ? this.time[this.n - 1] : 0;
    this.span = this.end - this.start;
    this.moves = this.n > 1 && this.span > 0;

    this.bodies = list(scene.bodies).map((body, index) => ({
      name: String(body.name ?? `body ${index + 1}`), index,
      x: floats(body.x, this.n), y: floats(body.y, this.n), a: floats(body.angle, this.n),
      shapes: readShapes(body.shapes),
    }));
    for (const body of this.bodies) body.label = body.name.length > 28 ? `${body.name.slice(0, 27)}…` : body.name;
    this.byName = new Map(this.bodies.map((body) => [body.name, body]));
    this.ground = { name: "ground", fixed: true, shapes: readShapes((scene.ground || {}).shapes) };
    this.gravity = scene.gravity && Math.hypot(...xy(scene.gravity)) > 0 ? xy(scene.gravity) : null;

    this.joints = list(scene.joints).filter((j) => this.has(j.body)).map((j) => ({
      ...this.told(j), body: this.find(j.body), point: xy(j.point), grounded: Boolean(j.grounded),
      mesh: this.wheels(j.mesh), internal: Boolean(j.internal),
      fx: j.force_x ? floats(j.force_x, this.n) : null,
      fy: j.force_y ? floats(j.force_y, this.n) : null,
      m: j.moment ? floats(j.moment, this.n) : null,
    }));
    this.links = list(scene.links).filter((l) => l.i && l.j && this.has(l.i.body) && this.has(l.j.body)).map((l) => ({
      ...this.told(l),
      i: { body: this.find(l.i.body), point: xy(l.i.point) },
      j: { body: this.find(l.j.body), point: xy(l.j.point) },
    }));
    this.symbols = list(scene.symbols).filter((s) => s.body === undefined || this.has(s.body)).map((s) => ({
      ...this.told(s), body: s.body === undefined ? null : this.find(s.body), point: xy(s.point),
      i: this.find(s.i), j: this.find(s.j), on: this.find(s.on), axis: xy(s.axis),
      wheels: this.wheels(s.wheels), crossed: Boolean(s.crossed),
      x: floats(s.x, this.n), y: floats(s.y, this.n), nx: floats(s.normal_x, this.n), ny: floats(s.normal_y, this.n),
      fx: s.force_x ? floats(s.force_x, this.n) : null, fy: s.force_y ? floats(s.force_y, this.n) : null,
      m: s.moment ? floats(s.moment, this.n) : null,
    }));
    this.points = list(scene.points).filter((p) => this.has(p.body)).map((p, index) => ({
      name: String(p.name ?? ""), body: this.find(p.body), point: xy(p.point), index, traced: false,
    }));
    // Of a mechanism that does not close: where its parts were given, and what stays open.
    this.ghosts = list(scene.ghosts).map((ghost) => {
      const a = +ghost.angle || 0, [x, y] = xy([ghost.x, ghost.y]);
      return { pose: { x, y, a, c: Math.cos(a), s: Math.sin(a) }, shapes: readShapes(ghost.shapes) };
    });
    this.gaps = list(scene.gaps).map((gap) => ({ from: xy(gap.from), to: xy(gap.to), text: String(gap.text ?? "") }));
    this.asked = Array.isArray(payload.trace) ? payload.trace.map(String) : null;
    this.series = list(payload.series).map((s) => ({
      name: String(s.name ?? ""), unit: unitOf(s), group: String(s.group || "other"), values: floats(s.values, this.n),
    }));
    this.seriesByName = new Map(this.series.map((s) => [s.name, s]));
    this.events = list(payload.events).filter((e) => isNum(e.time)).map((e) => ({ name: String(e.name ?? "event"), time: e.time }));
    this.still = { x: 0, y: 0, c: 1, s: 0, a: 0 };
    this.setTime(this.start);
  }

  setTime(t) {
    this.now = t;
    this.cursor = this.locate(t);
  }

  told(item) { return { name: String(item.name ?? ""), what: String(item.what ?? item.symbol ?? ""), symbol: String(item.symbol ?? "") }; }
  wheels(given) {
    return list(given).filter((w) => this.has(w.body)).map((w) => ({ body: this.find(w.body), point: xy(w.point), radius: Math.abs(w.radius) || 0 }));
  }
  has(name) { return name === "ground" || this.byName.has(String(name)); }
  find(name) { return this.byName.get(String(name)) || this.ground; }

  // The frame at or before t, and how far it is to the next one.
  locate(t) {
    let lo = 0, hi = this.n - 1;
    if (hi < 1) return { i: 0, f: 0 };
    while (hi - lo > 1) {
      const mid = (lo + hi) >> 1;
      if (this.time[mid] <= t) lo = mid; else hi = mid;
    }
    const step = this.time[hi] - this.time[lo];
    return { i: lo, f: step > 0 ? clamp((t - this.time[lo]) / step, 0, 1) : 0 };
  }

  // Linear between two frames; next to a gap, the nearer frame has the word.
  sample(column, { i, f }) {
    const a = column[i];
    if (f === 0 || i + 1 >= column.length) return a;
    const b = column[i + 1];
    if (a !== a || b !== b) return f < 0.5 ? a : b;
    return a + (b - a) * f;
  }

  pose(body, cursor = this.cursor) {
    if (body.fixed) return this.still;
    const x = this.sample(body.x, cursor), y = this.sample(body.y, cursor), a = this.sample(body.a, cursor);
    if (x !== x || y !== y || a !== a) return null;
    return { x, y, a, c: Math.cos(a), s: Math.sin(a) };
  }

  // World position of a point of a body, or null where the body has no pose.
  at(body, point, cursor = this.cursor) {
    const pose = this.pose(body, cursor);
    return pose && toWorld(pose, point);
  }

  // The way of a point over the whole motion, thinned to some 2000 points.
  path(body, point) {
    const stride = Math.max(1, Math.ceil(this.n / 2000));
    const out = [];
    for (let i = 0; i < this.n; i += stride) out.push({ t: this.time[i], p: this.at(body, point, { i, f: 0 }) });
    if (this.n && (this.n - 1) % stride) out.push({ t: this.end, p: this.at(body, point, { i: this.n - 1, f: 0 }) });
    return out;
  }

  frames(most) {
    const count = Math.min(this.n, most);
    return Array.from({ length: count }, (_, k) => ({ i: count > 1 ? Math.round((k * (this.n - 1)) / (count - 1)) : 0, f: 0 }));
  }

  // The box which the whole motion fills.
  envelope() {
    const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
    const grow = ([x, y]) => {
      box.x0 = Math.min(box.x0, x); box.x1 = Math.max(box.x1, x);
      box.y0 = Math.min(box.y0, y); box.y1 = Math.max(box.y1, y);
    };
    for (const shape of this.ground.shapes) outline(shape).forEach(grow);
    for (const joint of this.joints) if (joint.body.fixed) grow(joint.point);
    for (const link of this.links) for (const end of [link.i, link.j]) if (end.body.fixed) grow(end.point);
    const marks = new Map(this.bodies.map((b) => [b, [[0, 0], ...b.shapes.flatMap(outline)]]));
    for (const b of this.bodies) if (b.shapes.length) marks.get(b).shift();
    for (const p of [...this.points, ...this.joints]) marks.get(p.body)?.push(p.point);
    for (const { wheels } of this.symbols) for (const { body, point, radius } of wheels) {
      for (const [u, v] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) (body.fixed ? { push: grow } : marks.get(body)).push([point[0] + u * radius, point[1] + v * radius]);
    }
    for (const cursor of this.frames(240)) {
      for (const [body, points] of marks) {
        const pose = this.pose(body, cursor);
        if (pose) for (const p of points) grow(toWorld(pose, p));
      }
    }
    for (const { pose, shapes } of this.ghosts) for (const p of shapes.flatMap(outline)) grow(toWorld(pose, p));
    for (const gap of this.gaps) { grow(gap.from); grow(gap.to); }
    if (!(box.x0 <= box.x1)) return { x0: -0.5, x1: 0.5, y0: -0.5, y1: 0.5 };
    const size = Math.max(box.x1 - box.x0, box.y1 - box.y0) || 1;
    const least = 0.1 * size;
    for (const [lo, hi] of [["x0", "x1"], ["y0", "y1"]]) {
      const lack = least - (box[hi] - box[lo]);
      if (lack > 0) { box[lo] -= lack / 2; box[hi] += lack / 2; }
    }
    return box;
  }
}

const toWorld = (pose, [x, y]) => [pose.x + pose.c * x - pose.s * y, pose.y + pose.s * x + pose.c * y];
const toBody = (pose, [x, y]) => {
  const dx = x - pose.x, dy = y - pose.y;
  return [pose.c * dx + pose.s * dy, -pose.s * dx + pose.c * dy];
};

function readShapes(shapes) {
  return list(shapes).map((shape) => {
    const kind = String(shape.kind);
    const points = list(shape.points).map(xy);
    if (kind === "polygon" && points.length) return { kind, points: untangle(points) };
    if (kind === "curve" && points.length) return { kind, points, closed: Boolean(shape.closed) };
    if (kind === "bar" || kind === "line") return { kind, from: xy(shape.from), to: xy(shape.to) };
    if (kind === "disc") return { kind, center: xy(shape.center), radius: Math.abs(shape.radius) || 0 };
    if (kind === "particle") return { kind, center: xy(shape.center) };
    if (kind === "block") {
      return { kind, center: xy(shape.center), width: Math.abs(shape.width) || 0, height: Math.abs(shape.height) || 0, angle: +shape.angle || 0 };
    }
    return null;
  }).filter(Boolean);
}

function corners({ center, width, height, angle }) {
  const pose = { x: center[0], y: center[1], c: Math.cos(angle), s: Math.sin(angle) };
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => toWorld(pose, [(u * width) / 2, (v * height) / 2]));
}

// A few points which bound a shape.
function outline(shape) {
  switch (shape.kind) {
    case "bar": case "line": return [shape.from, shape.to];
    case "disc": return Array.from({ length: 12 }, (_, k) => [
      shape.center[0] + shape.radius * Math.cos((k * TAU) / 12), shape.center[1] + shape.radius * Math.sin((k * TAU) / 12)]);
    case "block": return corners(shape);
    case "particle": return [shape.center];
    default: {
      const stride = Math.max(1, Math.floor(shape.points.length / 40));
      return shape.points.filter((_, i) => i % stride === 0);
    }
  }
}

const cross = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);

// A plate whose edges cross each other is drawn as the hull of its points.
function untangle(points) {
  const n = points.length;
  if (n < 4 || n > 60) return points;
  for (let i = 0; i < n; i++) {
    for (let j = i + 2; j < n; j++) {
      if (i === 0 && j === n - 1) continue;
      const [a, b, c, d] = [points[i], points[i + 1], points[j], points[(j + 1) % n]];
      if (cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0) return hull(points);
    }
  }
  return points;
}

function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (order) => {
    const chain = [];
    for (const p of order) {
      while (chain.length > 1 && cross(chain.at(-2), chain.at(-1), p) <= 0) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
