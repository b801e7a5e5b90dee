// The drawing of a mechanism in space: how it looks, how it is looked at, what is under the pointer.

class SpatialScene extends Assembly {
  constructor(motion, canvas, tip) {
    super(motion, canvas);
    Object.assign(this, { canvas, tip });
    this.show = { labels: motion.bodies.filter((body) => body.label).length <= 12, forces: false, grid: true, ghosts: true };
    this.sizes = newSizes();
    this.cut = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
    motion.chooseTraces(this.view.radius);
    this.traces = motion.points.map((point) => new Trace(point, this.view.world));
    [this.whole, this.middle] = [this.view.cloud, this.view.centre.clone()];
    this.overlay = new Overlay(this);
    const once = motion.moves ? sphereAbout(motion.cloud([{ i: 0, f: 0 }])).radius : 0;
    this.follow(motion.traveller(this.radius, once));
    this.bindPointer();
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  get hint() { return "Wheel zooms, drag rotates, right-button drag pans."; }
  get keys() { return { 1: () => this.look("x"), 2: () => this.look("y"), 3: () => this.look("z"), 4: () => this.look(null) }; }

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
    for (const [key, m] of this.bodyMaterials()) {
      const clear = on || key.of;
      if (m.isMeshStandardMaterial) Object.assign(m, { transparent: clear, opacity: on ? 0.3 : key.of ? FAINT : 1, depthWrite: !clear, needsUpdate: true });
    }
    this.invalidate();
  }

  // Ellipsoids of inertia are no shapes of bodies, and may be hidden.
  showInertia(on) {
    for (const [key, m] of this.bodyMaterials()) if ((m.role ?? key).ellipsoid) m.visible = on;
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

  fit() {
    this.view.cloud = this.followed ? this.motion.cloud([this.motion.cursor]) : this.whole;
    this.view.centre = this.followed ? sphereAbout(this.view.cloud).centre : this.middle.clone();
    this.view.fit();
  }

  // The view goes with a body; null lets it stand.
  follow(body) {
    this.followed = body;
    this.at = null;
    this.fit();
  }

  keepUp() {
    const pose = this.followed && this.motion.pose(this.followed);
    if (!pose) return;
    const { camera, controls, centre } = this.view;
    if (this.at) for (const place of [camera.position, controls.target, centre]) place.add(pose.p).sub(this.at);
    this.at = pose.p.clone();
  }


  zoom(factor) { this.view.zoom(factor); }
  look(axis) { this.view.look(axis ? vector(AXES[axis]).multiplyScalar(axis === "y" ? -1 : 1) : this.view.oblique()); }
  resize() { if (this.view.fitted !== false) this.fit(); else this.invalidate(); }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  draw() {
    if (!this.colours || !this.canvas.clientWidth) return;
    this.move(this.show.forces, this.sizes);
    this.keepUp();
    for (const trace of this.traces) trace.show(this.motion, this.canvas);
    this.view.grid.visible = this.show.grid;
    this.view.render(this.ratio);
    this.overlay.draw(this.ratio);
    this.drawTip();
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
    const { kind, item } = hover, rows = [];
    const place = motion.at(item.body ?? item, item.point ?? [0, 0, 0]);
    if (kind === "link") rows.push(["length", inUnits([apart(...[item.i, item.j].map((end) => motion.at(end.body, end.point)))], "m")]);
    else if (place) rows.push(["x, y, z", inUnits(place, "m", { scale: this.radius })]);
    if (kind === "body") rows.push(["Euler parameters", inUnits(motion.turned(item), "")]);
    if (kind === "point") rows.push(["on", item.body.name]);
    for (const [key, unit] of [["force", "N"], ["moment", "N m"]]) {
      const v = motion.vectorOf(item[key]);
      if (v?.every(Number.isFinite)) rows.push([key, inUnits([Math.hypot(...v)], unit)], ["", inUnits(v, unit)]);
    }
    const what = item.description ?? kind;
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

const seen = (item) => !item || (item.visible && seen(item.parent));
