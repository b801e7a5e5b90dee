// The solids of a mechanism in space: made once, and moved to an instant.

const FAINT = 0.4;  // how much is seen of an ellipsoid of inertia

// Joints whose other half, a rail or a plane, is seen itself.
const ON_RAILS = ["slider", "collar", "nut", "table", "clamp"];

class Assembly {
  constructor(motion, canvas) {
    this.motion = motion;
    this.cloud = motion.cloud();
    this.up = upward(motion.gravity);
    Object.assign(this, sphereAbout(this.cloud));
    this.unit = this.symbolSize();
    this.feet = motion.joints.filter((j) => j.grounded && !ON_RAILS.includes(j.symbol)).map((j) => this.foot(j)).filter(({ place }) => place);
    const bases = this.feet.map(({ place, away }) => vector(place).addScaledVector(away, -5.2 * this.unit));
    this.view = new View(canvas, [...this.cloud, ...bases], this.up, () => this.invalidate());
    this.materials = new Map();
    this.groups = new Map([motion.ground, ...motion.bodies].map((body) => [body, new THREE.Group()]));
    this.view.world.add(...this.groups.values());
    this.picks = [];
    this.cutTeeth();
    this.solids = [];
    this.walls = [];
    for (const body of [motion.ground, ...motion.bodies]) for (const shape of body.shapes) this.addShape(body, shape);
    this.addStalks();
    for (const joint of motion.joints) this.addJoint(joint);
    for (const foot of this.feet) this.stand(foot);
    for (const symbol of motion.symbols) this.addSymbol(symbol);
    for (const point of motion.points) this.addPoint(point);
    this.links = motion.links.map((link) => this.addLink(link));
    this.ghosts = motion.ghosts.map((ghost) => this.addGhost(ghost));
    this.belts = motion.joints.filter((j) => j.wheels.length === 2).map((joint) => this.addBelt(joint));
    this.addLoads();
  }

  // Half the width of a bar in metres: small against the picture and against the bars.
  symbolSize() {
    const lengths = this.motion.bodies.flatMap((b) => b.shapes.filter((s) => s.kind === "bar").map((s) => apart(s.from, s.to))).sort((a, b) => a - b);
    const whole = 2 * this.radius, typical = lengths.length ? lengths[Math.floor(0.3 * lengths.length)] : Infinity;
    return clamp(Math.min(0.0115 * whole, 0.12 * typical), 0.003 * whole, whole);
  }

  // One material for each role: "steel", "ground" …, or a body.
  material(role) {
    if (!this.materials.has(role)) this.materials.set(role, new THREE.MeshStandardMaterial({ roughness: 0.55, metalness: 0.05, fog: false }));
    return this.materials.get(role);
  }

  add(group, geometry, role, item) {
    const mesh = new THREE.Mesh(geometry, this.material(role));
    mesh.castShadow = mesh.receiveShadow = true;
    group.add(mesh);
    if (item) { mesh.userData = item; this.picks.push(mesh); }
    return mesh;
  }

  // The discs of gears in mesh get teeth, of one pitch each mesh; a ring has a hole.
  cutTeeth() {
    const start = { i: 0, f: 0 };
    for (const { mesh, internal } of this.motion.joints.filter((j) => j.mesh.length === 2)) {
      const places = mesh.map((w) => this.motion.at(w.body, w.point, start));
      const discs = mesh.map((w) => w.body.shapes.find((s) => s.kind === "disc" && apart(s.center, w.point) < 1e-6 * w.radius && Math.abs(s.radius - w.radius) < 1e-6 * w.radius));
      if (!places.every(Boolean) || !discs.every(Boolean)) continue;
      const known = mesh.findIndex((w, k) => discs[k].teeth), least = Math.min(...mesh.map((w) => w.radius));
      const pitch = known < 0 ? (TAU * least) / 20 : (TAU * mesh[known].radius) / discs[known].teeth.count;
      mesh.forEach((w, k) => {
        if (discs[k].teeth) return;
        const pose = w.body.fixed ? this.motion.still : this.motion.pose(w.body, start), sign = internal ? (k ? -1 : 1) * Math.sign(mesh[0].radius - mesh[1].radius) * -1 : 1;
        const toward = vector(places[1 - k]).sub(vector(places[k])).multiplyScalar(sign).applyQuaternion(pose.q.clone().invert());
        discs[k].teeth = { count: Math.max(6, Math.round((TAU * w.radius) / pitch)), toward: toward.toArray(), gap: Boolean(k), ring: internal && w.radius > least };
      });
    }
  }

  addShape(body, shape) {
    const [geometry, lines] = (SOLIDS[shape.kind] || SOLIDS.particle)(shape, this.unit), group = this.groups.get(body);
    const role = body.fixed ? "ground" : shape.kind === "ellipsoid" ? this.inertiaOf(body) : body;
    if (geometry) {
      const mesh = this.add(group, geometry, role, body.fixed ? null : { kind: "body", item: body });
      const inside = new THREE.Mesh(geometry, this.flat(role));
      inside.visible = false;
      group.add(inside);
      this.solids.push({ mesh, inside, body, shape });
    }
    if (lines) group.add(new THREE.LineSegments(lines, this.line(role)));
  }

  // Where a joint or a link holds a body beside its solids, a thin rod leads there.
  addStalks() {
    const { joints, links } = this.motion, spots = new Map(this.motion.bodies.map((body) => [body, new Map()]));
    for (const { body, point } of [...joints, ...joints.map((j) => j.base).filter(Boolean), ...links.flatMap(({ i, j }) => [i, j])]) spots.get(body)?.set(point.join(), vector(point));
    for (const [body, places] of spots) {
      const solids = this.solids.filter((s) => s.body === body && s.shape.kind !== "ellipsoid");
      for (const place of solids.length ? places.values() : []) {
        const nearest = solids.map(({ mesh, shape }) => nearestOn(mesh.geometry, shape, place)).sort((a, b) => a.distanceTo(place) - b.distanceTo(place))[0];
        if (nearest.distanceTo(place) > 1.5 * this.unit) this.add(this.groups.get(body), tube(nearest.toArray(), place.toArray(), 0.45 * this.unit, 16), body, { kind: "body", item: body });
      }
    }
  }

  // The role of an ellipsoid of inertia: it is no shape, and lets be seen what is in it.
  inertiaOf(body) {
    body.inertia ??= { of: body, shapes: [], index: body.index, name: `inertia of ${body.name}`, ellipsoid: true };
    Object.assign(this.material(body.inertia), { transparent: true, opacity: FAINT, depthWrite: false });
    return body.inertia;
  }

  // What is seen of the inside of a solid through a section, without shading: it looks filled.
  flat(role) {
    const key = `inside ${role.name || role}`;
    if (!this.materials.has(key)) this.materials.set(key, Object.assign(new THREE.MeshBasicMaterial({ side: THREE.BackSide, fog: false }), { role }));
    return this.materials.get(key);
  }

  line(role) {
    const key = `line ${role.name || role}`;
    if (!this.materials.has(key)) this.materials.set(key, Object.assign(new THREE.LineBasicMaterial({ fog: false }), { role }));
    return this.materials.get(key);
  }

  // A group on a body at a point, its z axis along an axis of the body.
  seat({ body, point, axis }) {
    const group = new THREE.Group();
    group.position.set(...point);
    if (axis) group.quaternion.setFromUnitVectors(vector(Z), vector(axis).normalize());
    this.groups.get(body).add(group);
    return group;
  }

  addJoint(joint) {
    const { base } = joint, own = JOINT_SOLIDS[joint.symbol] || JOINT_SOLIDS.mark;
    const parts = joint.axis || ["socket", "contact"].includes(joint.symbol) ? own : JOINT_SOLIDS.bead;
    const seats = joint.symbol === "cross" && base ? [joint, base] : [joint.symbol === "table" && base ? base : joint];
    for (const seat of seats) {
      const group = this.seat(seat);
      for (const [geometry, role] of parts(this.unit)) this.add(group, geometry, role, { kind: "joint", item: joint });
    }
  }

  // The ground's side of a joint, and on which side of it the mechanism is.
  foot(joint) {
    const place = joint.body.fixed ? joint.point : joint.base?.body.fixed ? joint.base.point : this.motion.at(joint.body, joint.point, { i: 0, f: 0 });
    const hangs = place && this.centre.clone().sub(vector(place)).dot(this.up) < -0.25 * this.radius;
    return { place, away: this.up.clone().multiplyScalar(hangs ? -1 : 1) };
  }

  stand({ place, away }, size = 1) {
    const group = new THREE.Group();
    group.position.set(...place);
    group.quaternion.setFromUnitVectors(vector(Z), away);
    for (const [geometry, role] of pedestal(size * this.unit)) this.add(group, geometry, role, null);
    this.view.world.add(group);
  }

  addSymbol(symbol) {
    const parts = (symbol.normal ? { limit: wall } : SYMBOL_SOLIDS)[symbol.symbol];
    if (!parts) return;
    const group = this.seat(symbol);
    if (symbol.normal) this.walls.push({ symbol, group });
    for (const [geometry, role] of parts(this.unit)) this.add(group, geometry, role, { kind: "symbol", item: symbol });
  }

  // Two wheels and the strands between them, or a box where both turn about one place.
  addBelt(joint) {
    const item = { kind: "joint", item: joint }, [p, q] = joint.wheels.map((w) => this.motion.at(w.body, w.point, { i: 0, f: 0 }));
    if (!p || !q || apart(p, q) < 2 * this.unit) {
      this.add(this.seat(joint), new THREE.BoxGeometry(5 * this.unit, 5 * this.unit, 3 * this.unit), "drive", item);
      return null;
    }
    for (const wheel of joint.wheels) {
      const seat = this.seat(wheel), ends = [[0, 0, -0.6 * this.unit], [0, 0, 0.6 * this.unit]];
      this.add(seat, tube(...ends, wheel.radius, 56), "pale", item);
      seat.add(new THREE.LineSegments(rims(ends, wheel.radius), this.line("dark")));
    }
    const strands = [1, -1].map((side) => ({ side, mesh: this.add(this.view.world, tube([0, 0, 0], [0, 0, 1], 0.35 * this.unit, 12), "dark", item) }));
    return { joint, strands };
  }

  // The strands touch both wheels, in the plane across the first one's axis.
  moveBelts() {
    for (const { joint: { wheels: [one, two], crossed }, strands } of this.belts.filter(Boolean)) {
      const [p, q] = [one, two].map((w) => this.motion.at(w.body, w.point)), pose = one.body.fixed ? this.motion.still : this.motion.pose(one.body);
      for (const { mesh } of strands) mesh.visible = Boolean(p && q && pose);
      if (!p || !q || !pose) continue;
      const axis = vector(one.axis || Z).applyQuaternion(pose.q).normalize(), way = vector(q).sub(vector(p)), length = way.length();
      const along = way.clone().normalize(), across = new THREE.Vector3().crossVectors(axis, along).normalize(), r = crossed ? -two.radius : two.radius;
      const open = Math.acos(clamp((one.radius - r) / length, -1, 1));
      for (const { side, mesh } of strands) {
        const out = along.clone().multiplyScalar(Math.cos(open)).addScaledVector(across, side * Math.sin(open));
        const from = vector(p).addScaledVector(out, one.radius), to = vector(q).addScaledVector(out, r), strand = to.sub(from);
        mesh.position.copy(from);
        mesh.quaternion.setFromUnitVectors(vector(Z), strand.clone().normalize());
        mesh.scale.z = strand.length();
      }
    }
  }

  // Walls at which straight ways end.
  moveWalls() {
    for (const { symbol, group } of this.walls) {
      const [at, normal] = [symbol.where, symbol.normal].map((columns) => this.motion.vectorOf(columns));
      group.visible = [...at, ...normal].every(Number.isFinite) && Math.hypot(...normal) > 0;
      if (!group.visible) continue;
      group.position.set(...at);
      group.quaternion.setFromUnitVectors(vector(Z), vector(normal).normalize());
    }
  }

  addPoint(point) {
    const mesh = this.add(this.groups.get(point.body), ball([0, 0, 0], 0.55 * this.unit), `point ${point.index}`, { kind: "point", item: point });
    mesh.position.set(...point.point);
    mesh.castShadow = false;
  }

  addLink(link) {
    const lengths = this.motion.frames(60).map((cursor) => {
      const [p, q] = [link.i, link.j].map((end) => this.motion.at(end.body, end.point, cursor));
      return p && q ? apart(p, q) : NaN;
    }).filter(Number.isFinite);
    const rest = lengths.reduce((sum, v) => sum + v, 0) / (lengths.length || 1) || this.unit, group = new THREE.Group();
    const parts = (LINK_SOLIDS[link.symbol] || LINK_SOLIDS.rod)(this.unit, rest).map(([geometry, role, follows]) => (
      { mesh: this.add(group, geometry, role, { kind: "link", item: link }), follows }));
    this.view.world.add(group);
    const start = [link.i, link.j].map((end) => this.motion.at(end.body, end.point, { i: 0, f: 0 }));
    [link.i, link.j].forEach((end, k) => {
      if (!end.body.fixed || !start[0] || !start[1] || this.motion.joints.some((j) => j.grounded && this.motion.n && apart(this.motion.at(j.body, j.point, { i: 0, f: 0 }) || [Infinity, 0, 0], end.point) < this.unit)) return;
      const away = vector(start[1 - k]).sub(vector(start[k]));
      if (away.length() > 0) this.stand({ place: end.point, away: away.normalize() }, 0.6);
    });
    return { link, group, parts, rest };
  }

  // Where a body of a mechanism that does not close was given.
  addGhost({ shapes }) {
    const group = new THREE.Group();
    for (const shape of shapes) {
      const [geometry, lines] = (SOLIDS[shape.kind] || SOLIDS.particle)(shape, this.unit);
      if (geometry) { const mesh = this.add(group, geometry, "ghost", null); mesh.castShadow = false; }
      if (lines) group.add(new THREE.LineSegments(lines, this.line("ghost")));
    }
    this.view.world.add(group);
    return group;
  }

  // Arrows of reactions and of applied loads; the greatest of each kind gives its scale.
  addLoads() {
    const greatest = (items, key) => Math.max(0, ...items.map((item) => {
      let most = 0;
      if (item[key]) for (let i = 0; i < this.motion.n; i++) most = Math.max(most, Math.hypot(...item[key].map((column) => column[i])) || 0);
      return most;
    }));
    this.loaded = this.motion.joints.filter((j) => j.force || j.moment);
    this.applied = this.motion.symbols.filter((s) => s.force || s.moment);
    this.greatest = { force: greatest(this.loaded, "force"), moment: greatest(this.loaded, "moment"), load: greatest(this.applied, "force"), twist: greatest(this.applied, "moment") };
    const arrows = (items, [force, moment]) => items.flatMap((item) => [["force", force, 1], ["moment", moment, 2]].filter(([key]) => item[key]).map(([key, role, heads]) => {
      const shown = new Arrow(this.unit, heads, this.arrowMaterial(role));
      this.view.world.add(shown.group);
      return { item, key, role, shown };
    }));
    this.arrows = [...arrows(this.loaded, ["force", "moment"]), ...arrows(this.applied, ["load", "twist"])];
  }

  arrowMaterial(role) {
    if (!this.materials.has(role)) this.materials.set(role, new THREE.MeshStandardMaterial({ roughness: 0.8, fog: false, depthTest: false, transparent: true }));
    return this.materials.get(role);
  }

  // To the instant at which the motion stands: bodies, links, and the arrows of reactions if asked for, so long.
  move(reactions, sizes) {
    const { motion } = this;
    for (const [body, group] of this.groups) {
      const pose = body.fixed ? motion.still : motion.n ? motion.pose(body) : null;
      group.visible = Boolean(pose);
      if (!pose) continue;
      group.position.copy(pose.p);
      group.quaternion.copy(pose.q);
    }
    this.ghosts.forEach((group, k) => {
      const pose = this.show.ghosts && motion.n ? motion.pose(motion.ghosts[k]) : null;
      group.visible = Boolean(pose);
      if (pose) { group.position.copy(pose.p); group.quaternion.copy(pose.q); }
    });
    for (const { link, group, parts, rest } of this.links) {
      const [p, q] = [link.i, link.j].map((end) => motion.at(end.body, end.point));
      group.visible = Boolean(p && q);
      if (!group.visible) continue;
      const way = vector(q).sub(vector(p)), length = way.length();
      group.position.set(...p);
      if (length > 0) group.quaternion.setFromUnitVectors(vector(Z), way.divideScalar(length));
      for (const { mesh, follows } of parts) {
        if (follows === "stretch") mesh.scale.z = Math.max(1e-9, length / rest);
        if (follows === "tail") mesh.position.z = length;
      }
    }
    for (const { item, key, role, shown } of this.arrows) {
      const reaction = role === "force" || role === "moment", place = motion.placeOf(item);
      const value = (reactions || !reaction) && place ? motion.vectorOf(item[key]) : null;
      const unit = (0.5 * this.view.radius * sizes[role]) / (this.greatest[role] || 1);
      const way = value && value.every(Number.isFinite) ? vector(value).multiplyScalar(unit) : null;
      shown.show(place ? vector(place) : this.view.centre, way);
      shown.read = shown.group.visible ? { at: vector(place).add(way).toArray(), value: Math.hypot(...value) } : null;
    }
    this.moveBelts();
    this.moveWalls();
  }
}
