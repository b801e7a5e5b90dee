// A motion in space: poses of bodies by their origins and Euler parameters, the scalar first.

const xyz = (p) => (Array.isArray(p) && p.length === 3 && p.every(isNum) ? [...p] : [0, 0, 0]);
const vector = (p) => new THREE.Vector3(...p);
const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

class SpatialMotion extends Timeline {
  constructor(payload) {
    super(payload);
    const scene = payload.scene || {};
    this.setBodies(scene.bodies, (body) => ({
      place: ["x", "y", "z"].map((key) => floats(body[key], this.n)),
      turn: ["e0", "e1", "e2", "e3"].map((key) => floats(body[key], this.n)),
      shapes: list(body.shapes),
    }));
    this.ground.shapes = list((scene.ground || {}).shapes);
    this.gravity = scene.gravity && vector(xyz(scene.gravity)).length() > 0 ? xyz(scene.gravity) : null;
    const columns = (item, name) => (item[`${name}_x`] ? Object.keys(AXES).map((axis) => floats(item[`${name}_${axis}`], this.n)) : null);
    const end = (given) => ({ body: this.find(given.body), point: xyz(given.point), axis: given.axis ? xyz(given.axis) : null });
    const known = (given) => given && this.has(given.body);
    this.joints = list(scene.joints).filter(known).map((j) => ({
      ...this.told(j), ...end(j), base: known(j.base) ? end(j.base) : null, grounded: Boolean(j.grounded),
      force: columns(j, "force"), moment: columns(j, "moment"), where: columns(j, "at"),
      wheels: list(j.wheels).filter(known).map((w) => ({ ...end(w), radius: Math.abs(w.radius) || 0 })), crossed: Boolean(j.crossed),
      mesh: list(j.mesh).filter(known).map((w) => ({ ...end(w), radius: Math.abs(w.radius) || 0 })),
    }));
    this.links = list(scene.links).filter((l) => known(l.i) && known(l.j)).map((l) => ({ ...this.told(l), i: end(l.i), j: end(l.j) }));
    this.symbols = list(scene.symbols).filter(known).map((s) => ({
      ...this.told(s), ...end(s), force: columns(s, "force"), moment: columns(s, "moment"), where: columns(s, "at"), normal: columns(s, "normal"),
    }));
    this.points = list(scene.points).filter(known).map((p, index) => ({ name: String(p.name ?? ""), ...end(p), index, traced: false }));
    this.ghosts = list(scene.ghosts).map((ghost) => ({
      place: ["x", "y", "z"].map((key) => steady(ghost[key], this.n)),
      turn: ["e0", "e1", "e2", "e3"].map((key) => steady(ghost[key], this.n)),
      shapes: list(ghost.shapes),
    }));
    this.gaps = list(scene.gaps).map((g) => ({ from: xyz(g.from), to: xyz(g.to), text: String(g.text ?? "") }));
    this.still = { p: new THREE.Vector3(), q: new THREE.Quaternion() };
  }

  // Between two frames the origin goes straight and the body turns about one axis, evenly.
  pose(body, cursor = this.cursor) {
    if (body.fixed) return this.still;
    const place = body.place.map((column) => this.sample(column, cursor));
    const turn = (i) => body.turn.map((column) => column[i]);
    const { i, f } = cursor, near = f < 0.5 || i + 1 >= this.n ? i : i + 1;
    if (![...place, ...turn(near)].every(Number.isFinite)) return null;
    const q = quaternion(turn(i).every(Number.isFinite) ? turn(i) : turn(near));
    if (f > 0 && i + 1 < this.n && turn(i + 1).every(Number.isFinite)) q.slerp(quaternion(turn(i + 1)), f);
    return { p: vector(place), q };
  }

  // Place of a point of a body in inertial axes, or null where the body has no pose.
  at(body, point, cursor = this.cursor) {
    const pose = this.pose(body, cursor);
    return pose && toSpace(pose, point).toArray();
  }

  // Place of a joint or a symbol: a point of its body, or one that wanders.
  placeOf({ body, point, where }) {
    const place = where ? this.vectorOf(where) : this.at(body, point);
    return place && place.every(Number.isFinite) ? place : null;
  }

  // Euler parameters of a body now.
  turned(body) {
    const pose = this.pose(body);
    return pose ? [pose.q.w, pose.q.x, pose.q.y, pose.q.z] : [];
  }

  vectorOf(columns, cursor = this.cursor) { return columns ? columns.map((column) => this.sample(column, cursor)) : null; }

  // Places that the motion fills: what lies on the bodies, at some instants.
  cloud(frames = this.frames(120)) {
    const marks = new Map([this.ground, ...this.bodies].map((b) => [b, b.shapes.flatMap(reach)]));
    const ends = [...this.joints.filter((j) => !j.where), ...this.points, ...this.symbols.filter((s) => !s.where), ...this.links.flatMap(({ i, j }) => [i, j])];
    for (const { body, point } of ends) marks.get(body).push(point);
    for (const body of this.bodies) if (!marks.get(body).length) marks.get(body).push([0, 0, 0]);
    const all = frames.length !== 1, places = all ? marks.get(this.ground).map(vector) : [];  // the ground is no part of what travels
    for (const cursor of frames) {
      for (const body of this.bodies) {
        const pose = this.pose(body, cursor);
        if (pose) for (const p of marks.get(body)) places.push(toSpace(pose, p));
      }
    }
    for (const cursor of all && this.ghosts.length ? this.frames(30) : []) for (const ghost of this.ghosts) {
      const pose = this.pose(ghost, cursor);
      if (pose) for (const p of ghost.shapes.flatMap(reach)) places.push(toSpace(pose, p));
    }
    for (const gap of all ? this.gaps : []) places.push(vector(gap.from), vector(gap.to));
    return places.length ? places : [new THREE.Vector3()];
  }
}

const quaternion = ([e0, e1, e2, e3]) => new THREE.Quaternion(e1, e2, e3, e0).normalize();
const toSpace = (pose, point) => vector(point).applyQuaternion(pose.q).add(pose.p);

// A few points of the body frame which bound a shape.
function reach(shape) {
  const about = (center, r) => Object.values(AXES).flatMap((u) => [1, -1].map((s) => center.map((c, k) => c + s * r * u[k])));
  switch (shape.kind) {
    case "bar": case "line": case "cylinder": case "capsule":
      return [shape.from, shape.to].flatMap((p) => (shape.radius ? about(p, shape.radius) : [xyz(p)]));
    case "sphere": case "disc": return about(xyz(shape.center), shape.radius || 0);
    case "ellipsoid": case "box": {
      const pose = { p: vector(xyz(shape.center)), q: quaternion(shape.turn || [1, 0, 0, 0]) }, half = shape.kind === "box" ? 0.5 : 0.35;
      const signs = [-1, 1].flatMap((a) => [-1, 1].flatMap((b) => [-1, 1].map((c) => [a, b, c])));
      return signs.map((s) => toSpace(pose, s.map((v, k) => v * half * shape.size[k])).toArray());
    }
    case "plate": case "curve": return list(shape.points).map(xyz);
    case "mesh": {
      const box = new THREE.Box3().setFromArray(list(shape.vertices)), stride = Math.max(1, Math.floor(shape.vertices.length / 600));
      const some = Array.from({ length: Math.floor(shape.vertices.length / 3 / stride) }, (_, k) => shape.vertices.slice(3 * k * stride, 3 * k * stride + 3));
      return box.isEmpty() ? [] : some;
    }
    default: return [xyz(shape.center)];
  }
}
