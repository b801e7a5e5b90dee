// The drawing of a mechanism in space: its solids, where they are, what is under the pointer.

const FAINT = 0.4;

class SpatialScene {
  constructor(motion, canvas, tip) {
    Object.assign(this, { motion, canvas, tip });
    this.show = { labels: motion.bodies.length <= 12, forces: false, grid: true, clear: false };
    this.size = 1;  // of the arrows of reactions
    this.cloud = motion.cloud();
    this.up = upward(motion.gravity);
    Object.assign(this, sphereAbout(this.cloud));
    this.unit = this.symbolSize();
    this.feet = motion.joints.filter((j) => j.grounded && !ON_RAILS.includes(j.symbol)).map((j) => this.foot(j)).filter(({ place }) => place);
    const bases = this.feet.map(({ place, away }) => vector(place).addScaledVector(away, -5.2 * this.unit));
    this.view = new View(canvas, [...this.cloud, ...bases], this.up, () => this.invalidate());
    this.cut = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
    this.materials = new Map();
    this.groups = new Map([motion.ground, ...motion.bodies].map((body) => [body, new THREE.Group()]));
    this.view.world.add(...this.groups.values());
    this.picks = [];
    this.solids = [];
    for (const body of [motion.ground, ...motion.bodies]) for (const shape of body.shapes) this.addShape(body, shape);
    for (const joint of motion.joints) this.addJoint(joint);
    for (const foot of this.feet) this.stand(foot);
    for (const symbol of motion.symbols) this.addSymbol(symbol);
    for (const point of motion.points) this.addPoint(point);
    this.links = motion.links.map((link) => this.addLink(link));
    this.ghosts = motion.ghosts.map((ghost) => this.addGhost(ghost));
    this.addLoads();
    motion.chooseTraces(this.view.radius);
    this.traces = motion.points.map((point) => new Trace(point, this.view.world));
    this.overlay = new Overlay(this);
    this.bindPointer();
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  get hint() { return "Wheel zooms, drag turns, with the right button pans."; }
  get keys() { return { 1: () => this.look("x"), 2: () => this.look("y"), 3: () => this.look("z"), 4: () => this.look(null) }; }

  // Half the width of a bar in metres: small against the picture and against the bars.
  symbolSize() {
    const lengths = this.motion.bodies.flatMap((b) => b.shapes.filter((s) => s.kind === "bar").map((s) => apart(s.from, s.to))).sort((a, b) => a - b);
    const whole = 2 * this.radius, typical = lengths.length ? lengths[Math.floor(0.3 * lengths.length)] : Infinity;
    return clamp(Math.min(0.0115 * whole, 0.12 * typical), 0.003 * whole, whole);
  }

  // What is drawn -------------------------------------------------------------

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

  addShape(body, shape) {
    const [geometry, lines] = (SOLIDS[shape.kind] || SOLIDS.particle)(shape, this.unit), group = this.groups.get(body);
    const role = body.fixed ? "ground" : shape.kind === "ellipsoid" ? this.inertiaOf(body) : body;
    if (geometry) {
      const mesh = this.add(group, geometry, role, body.fixed ? null : { kind: "body", item: body });
      const inside = new THREE.Mesh(geometry, this.flat(role));
      inside.visible = false;
      group.add(inside);
      this.solids.push({ mesh, inside });
    }
    if (lines) group.add(new THREE.LineSegments(lines, this.line(role)));
  }

  // The role of an ellipsoid of inertia: it is no shape, and lets be seen what is in it.
  inertiaOf(body) {
    body.inertia ??= { of: body, shapes: [], index: body.index, name: `inertia of ${body.name}` };
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
    const parts = JOINT_SOLIDS[joint.symbol] || JOINT_SOLIDS.mark, { base } = joint;
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
    const parts = SYMBOL_SOLIDS[symbol.symbol];
    if (!parts) return;
    const group = this.seat(symbol);
    for (const [geometry, role] of parts(this.unit)) this.add(group, geometry, role, { kind: "symbol", item: symbol });
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
  addGhost({ pose, shapes }) {
    const group = new THREE.Group();
    group.position.copy(pose.p);
    group.quaternion.copy(pose.q);
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

  // Looks ------------------------------------------------------------------------

  restyle() {
    const { ink, surface, muted, accent, name } = Theme, dark = name === "dark";
    const roles = {
      steel: mix(surface, ink, dark ? 0.72 : 0.16), dark: mix(surface, ink, dark ? 0.42 : 0.62), pale: mix(surface, ink, dark ? 0.5 : 0.1),
      ground: mix(surface, ink, dark ? 0.3 : 0.3), spring: Theme.colour(2), drive: mix(surface, Theme.colour(4), dark ? 0.75 : 0.6), ghost: muted,
      force: Theme.force, moment: Theme.moment, load: ink, twist: ink,
    };
    const colour = (role) => role.shapes ? mix(surface, Theme.colour(role.index), dark ? 0.82 : 0.72) : role.startsWith?.("point ") ? this.pointColour({ index: +role.slice(6) }) : roles[role];
    this.colours = { ink: mix(ink, surface, 0.12), surface, muted };
    for (const [key, material] of this.materials) {
      const base = colour(material.role ?? key);
      material.color.set(material.isLineBasicMaterial ? mix(base, dark ? surface : ink, 0.45) : material.isMeshBasicMaterial ? mix(base, dark ? surface : ink, 0.3) : base);
    }
    const ghost = this.materials.get("ghost");
    if (ghost) Object.assign(ghost, { transparent: true, opacity: 0.25, depthWrite: false });
    for (const trace of this.traces) trace.restyle(this.pointColour(trace.point), surface);
    this.accent = accent;
    this.view.restyle();
    this.invalidate();
  }

  pointColour(point) { return Theme.colour(point.index + 3); }

  // The materials of the bodies, of their edges and of their insides.
  bodyMaterials() { return [...this.materials].filter(([key, m]) => (m.role ?? key).shapes); }

  setClear(on) {
    this.show.clear = on;
    for (const [key, m] of this.bodyMaterials()) {
      const clear = on || key.of;
      if (m.isMeshStandardMaterial) Object.assign(m, { transparent: clear, opacity: on ? 0.3 : key.of ? FAINT : 1, depthWrite: !clear, needsUpdate: true });
    }
    this.invalidate();
  }

  // A section: what lies on the far side of the plane along an axis is left out; null for none.
  setSection(axis, share, flip) {
    const on = axis !== null;
    if (on) {
      const normal = vector(AXES[axis]).multiplyScalar(flip ? 1 : -1), { centre, radius } = this.view;
      const at = centre.dot(vector(AXES[axis])) + share * radius;
      this.cut.set(normal, (flip ? -1 : 1) * at);
    }
    for (const [, m] of this.bodyMaterials()) Object.assign(m, { clippingPlanes: on ? [this.cut] : null, clipShadows: true, needsUpdate: true });
    for (const { inside } of this.solids) inside.visible = on;
    this.section = on;
    this.invalidate();
  }

  // View ---------------------------------------------------------------------------

  fit() { this.view.fit(); }
  zoom(factor) { this.view.zoom(factor); }
  look(axis) { this.view.look(axis ? vector(AXES[axis]).multiplyScalar(axis === "y" ? -1 : 1) : this.view.oblique()); }
  resize() { if (this.view.fitted !== false) this.view.fit(); else this.invalidate(); }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  // At an instant ----------------------------------------------------------------------

  draw() {
    if (!this.colours || !this.canvas.clientWidth) return;
    this.move();
    this.view.grid.visible = this.show.grid;
    this.view.render(this.ratio);
    this.overlay.draw(this.ratio);
    this.drawTip();
  }

  move() {
    const { motion } = this;
    for (const [body, group] of this.groups) {
      const pose = body.fixed ? motion.still : motion.n ? motion.pose(body) : null;
      group.visible = Boolean(pose);
      if (!pose) continue;
      group.position.copy(pose.p);
      group.quaternion.copy(pose.q);
    }
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
      const value = (this.show.forces || !reaction) && place ? motion.vectorOf(item[key]) : null;
      const unit = (0.5 * this.view.radius * (reaction ? this.size : 1)) / (this.greatest[role] || 1);
      shown.show(place ? vector(place) : this.view.centre, value && value.every(Number.isFinite) ? vector(value).multiplyScalar(unit) : null);
    }
    for (const trace of this.traces) trace.show(motion, this.canvas);
  }

  // Under the pointer --------------------------------------------------------------------

  bindPointer() {
    const { canvas } = this;
    canvas.addEventListener("pointermove", (e) => {
      const box = canvas.getBoundingClientRect();
      this.pointer = canvas.classList.contains("grabbing") ? null : [e.clientX - box.left, e.clientY - box.top];
      this.invalidate();
    });
    canvas.addEventListener("pointerleave", () => { this.pointer = null; this.invalidate(); });
    canvas.addEventListener("dblclick", () => this.fit());
  }

  hit([x, y]) {
    const { clientWidth: w, clientHeight: h } = this.canvas, ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / w - 1, 1 - (2 * y) / h), this.view.camera);
    const found = ray.intersectObjects(this.picks, false).filter(({ point, object }) => seen(object) && !(this.section && this.cut.distanceToPoint(point) < 0 && object.userData.kind === "body"));
    const near = found.find(({ object }) => object.userData.kind !== "body" ) ?? found[0];
    return (near && near.distance < found[0].distance + 4 * this.unit ? near : found[0])?.object.userData ?? null;
  }

  drawTip() {
    const { tip, motion } = this, hover = this.pointer && this.hit(this.pointer);
    if (hover?.item !== this.hover?.item) this.highlight(hover?.item);
    this.hover = hover;
    tip.hidden = !hover;
    if (tip.hidden) return;
    const { kind, item } = hover, rows = [], triple = (v, unit) => v.map((x) => number(x)).join(", ") + unit;
    const place = motion.at(item.body ?? item, item.point ?? [0, 0, 0]);
    if (kind === "link") rows.push(["length", `${number(apart(...[item.i, item.j].map((end) => motion.at(end.body, end.point))))} m`]);
    else if (place) rows.push(["x, y, z", triple(place, " m")]);
    if (kind === "body") rows.push(["Euler parameters", triple(motion.turned(item), "")]);
    if (kind === "point") rows.push(["on", item.body.name]);
    for (const [key, unit] of [["force", " N"], ["moment", " N·m"]]) {
      const v = motion.vectorOf(item[key]);
      if (v?.every(Number.isFinite)) rows.push([key, `${number(Math.hypot(...v))}${unit}`], ["", triple(v, unit)]);
    }
    const what = item.what ?? kind;
    tip.replaceChildren(el("strong", {}, item.name || what), el("span", { class: "what" }, item.name ? what : ""),
      el("dl", {}, rows.map(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])));
    const [px, py] = this.pointer, { clientWidth: w, clientHeight: h } = this.canvas;
    const x = px + 16 + tip.offsetWidth > w ? px - 14 - tip.offsetWidth : px + 16;
    tip.style.transform = `translate(${Math.max(4, x)}px, ${clamp(py + 14, 4, Math.max(4, h - tip.offsetHeight - 4))}px)`;
  }

  highlight(item) {
    for (const [key, material] of this.materials) if (key.shapes) material.emissive.set((key.of ?? key) === item ? mix("#000000", this.accent, 0.45) : "#000000");
    this.invalidate();
  }
}

// Joints whose other half, a rail or a plane, is seen itself.
const ON_RAILS = ["slider", "collar", "nut", "table", "clamp"];

const seen = (item) => !item || (item.visible && seen(item.parent));
