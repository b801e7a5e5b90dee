// A motion in the plane: poses of bodies, and what they carry.

class Motion extends Timeline {
  constructor(payload) {
    super(payload);
    const scene = payload.scene || {};
    this.setBodies(scene.bodies, (body) => ({
      x: floats(body.x, this.n), y: floats(body.y, this.n), a: floats(body.angle, this.n), shapes: readShapes(body.shapes),
    }));
    this.ground.shapes = readShapes((scene.ground || {}).shapes);
    this.gravity = scene.gravity && Math.hypot(...xy(scene.gravity)) > 0 ? xy(scene.gravity) : null;

    this.joints = list(scene.joints).filter((j) => this.has(j.body)).map((j) => ({
      ...this.told(j), body: this.find(j.body), point: xy(j.point), grounded: Boolean(j.grounded), on: this.byName.get(String(j.on)) || null,
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
    // Another motion behind this one; of a mechanism that does not close, where its parts were given.
    this.ghosts = list(scene.ghosts).map((ghost) => ({
      x: steady(ghost.x, this.n), y: steady(ghost.y, this.n), a: steady(ghost.angle, this.n), shapes: readShapes(ghost.shapes),
    }));
    this.gaps = list(scene.gaps).map((gap) => ({ from: xy(gap.from), to: xy(gap.to), text: String(gap.text ?? "") }));
    this.still = { x: 0, y: 0, c: 1, s: 0, a: 0 };
  }

  wheels(given) {
    return list(given).filter((w) => this.has(w.body)).map((w) => ({ body: this.find(w.body), point: xy(w.point), radius: Math.abs(w.radius) || 0 }));
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

  // The box which the motion fills at some instants.
  envelope(frames = this.frames(240)) {
    const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
    const grow = ([x, y]) => {
      box.x0 = Math.min(box.x0, x); box.x1 = Math.max(box.x1, x);
      box.y0 = Math.min(box.y0, y); box.y1 = Math.max(box.y1, y);
    };
    const all = frames.length !== 1;  // the ground is no part of what travels
    for (const shape of all ? this.ground.shapes : []) outline(shape).forEach(grow);
    for (const joint of all ? this.joints : []) if (joint.body.fixed) grow(joint.point);
    for (const link of all ? this.links : []) for (const end of [link.i, link.j]) if (end.body.fixed) grow(end.point);
    const marks = new Map(this.bodies.map((b) => [b, [[0, 0], ...b.shapes.flatMap(outline)]]));
    for (const b of this.bodies) if (b.shapes.length) marks.get(b).shift();
    for (const p of [...this.points, ...this.joints]) marks.get(p.body)?.push(p.point);
    for (const { wheels } of this.symbols) for (const { body, point, radius } of wheels) {
      for (const [u, v] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) (body.fixed ? { push: (p) => all && grow(p) } : marks.get(body)).push([point[0] + u * radius, point[1] + v * radius]);
    }
    for (const cursor of frames) {
      for (const [body, points] of marks) {
        const pose = this.pose(body, cursor);
        if (pose) for (const p of points) grow(toWorld(pose, p));
      }
    }
    for (const cursor of all && this.ghosts.length ? this.frames(60) : []) for (const ghost of this.ghosts) {
      const pose = this.pose(ghost, cursor);
      if (pose) for (const p of ghost.shapes.flatMap(outline)) grow(toWorld(pose, p));
    }
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
