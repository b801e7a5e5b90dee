// Spatial scenes of solids: built once, moved to an instant, coloured, cut, and found under the pointer.

/** @import { Axis, End, Ghost, Hit, Item, Label, Link, Paper, Part, Pixel, Point, Shape } from "./scene_types.d.ts" */
/** @import { MeshSolids } from "./mesh_solids.js" */
/** @import { SpatialMotion, SpatialPose } from "./spatial_motion.js" */
/** @import { SpatialView } from "./spatial_view.js" */
/** @import { Scene } from "./scene.js" */

import "./vendor/three.js";
import { fitCanvas } from "./canvas.js";
import { el } from "./dom.js";
import { FlatPainter } from "./flat_painter.js";
import { clamp } from "./numbers.js";
import { apart, ball, nearestOn, rims, solidOf, tube } from "./solids.js";
import { AXES, vector } from "./spatial_motion.js";
import { JOINTS, LINKS, SYMBOLS, pedestal, wall } from "./spatial_symbols.js";
import { SpatialTrace } from "./spatial_trace.js";
import { Theme, mix } from "./theme.js";

/** Opacity of ellipsoids of inertia, of transparent bodies, and of ghosts. */
const FAINT = 0.4, CLEAR = 0.3, GHOST = 0.25;
/** Joints whose other part, a rail or a plane, is drawn itself. */
const ON_RAILS = ["slider", "collar", "nut", "table", "clamp"];
const START = { i: 0, f: 0 };

/** Role of a material: of a body, of its ellipsoid of inertia, or a name.
 * @typedef {Part | string} Role */

export class SpatialPainter {
  /** @param {Scene} scene */
  constructor(scene) {
    this.scene = scene;
    this.motion = /** @type {SpatialMotion} */ (scene.motion);
    this.view = /** @type {SpatialView} */ (scene.view);
    this.canvas = el("canvas", { class: "overlay", id: "overlay", "aria-hidden": "true" });
    scene.canvas.after(this.canvas);
    /** Half the width of a bar [px]. */
    this.half = 6;
    /** Plane of the section. */
    this.cut = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
    this.section = false;
    this.clear = false;
    this.inertia = true;
    /** @type {THREE.Group | null} */
    this.parts = null;
    this.unit = scene.unit;
    /** Moving parts. @type {{ link: Link, group: THREE.Group, parts: { mesh: THREE.Mesh, follows?: string }[], rest: number }[]} */
    this.links = [];
    /** @type {THREE.Group[]} */
    this.ghosts = [];
    /** @type {{ joint: Item, strands: { side: number, mesh: THREE.Mesh }[] }[]} */
    this.belts = [];
    /** @type {SpatialTrace[]} */
    this.traces = [];
    /** @type {MeshSolids | null} */
    this.mesh = null;
    /** Materials of each role: of surfaces, of their insides, of lines. @type {Record<string, Map<Role, THREE.Material>>} */
    this.materials = {};
  }

  build() {
    const { motion, scene, view } = this;
    if (this.parts) view.world.remove(this.parts);
    this.parts = new THREE.Group();
    view.world.add(this.parts);
    this.materials = { surface: new Map(), inside: new Map(), line: new Map() };
    this.unit = scene.unit;
    /** Bodies → their solids. @type {Map<Part, THREE.Group>} */
    this.groups = new Map([motion.ground, ...motion.bodies].map((body) => [body, new THREE.Group()]));
    this.parts.add(...this.groups.values());
    /** Solids that can be found under the pointer. @type {THREE.Mesh[]} */
    this.picks = [];
    /** @type {{ mesh: THREE.Mesh, inside: THREE.Mesh, body: Part, shape: Shape }[]} */
    this.solids = [];
    /** @type {{ symbol: Item, group: THREE.Group }[]} */
    this.walls = [];
    /** @type {Map<Part, Role>} */
    this.ellipsoids = new Map();
    for (const body of this.groups.keys()) for (const shape of body.shapes) this.addShape(body, shape);
    this.addStalks();
    for (const joint of motion.joints) this.addJoint(joint);
    for (const symbol of motion.symbols) this.addSymbol(symbol);
    for (const point of motion.points) {
      const mesh = this.add(this.groupOf(point.body), ball([0, 0, 0], 0.55 * this.unit), `point ${point.index}`, { kind: "point", item: point });
      mesh.position.set(...point.point);
      mesh.castShadow = false;
    }
    this.links = motion.links.map((link) => this.addLink(link));
    this.ghosts = motion.ghosts.map((ghost) => this.addGhost(ghost));
    this.belts = motion.joints.filter(({ wheels }) => wheels.length === 2).map((joint) => this.addBelt(joint)).filter((belt) => belt !== null);
    this.traces = motion.points.map((point) => new SpatialTrace(point, this.parts));
    this.mesh = scene.structure && motion.mesh ? new scene.structure.Picture(this, motion.mesh, motion.otherMesh) : null;
    this.restyle();
  }

  // Materials --------------------------------------------------------------------------------------

  /** Material of a role, created once. @param {string} kind @param {Role} role @param {() => THREE.Material} create @returns {THREE.Material} */
  material(kind, role, create) {
    if (!this.materials[kind].has(role)) this.materials[kind].set(role, create());
    return this.materials[kind].get(role);
  }

  /** @param {Role} role */
  surface(role) { return this.material("surface", role, () => new THREE.MeshStandardMaterial({ roughness: 0.55, metalness: 0.05, fog: false })); }

  /** Inside of a solid in a section, without shading, so that it seems filled. @param {Role} role */
  inside(role) { return this.material("inside", role, () => new THREE.MeshBasicMaterial({ side: THREE.BackSide, fog: false })); }

  /** @param {Role} role */
  line(role) { return this.material("line", role, () => new THREE.LineBasicMaterial({ fog: false })); }

  /** Materials with their roles. */
  get roles() { return Object.values(this.materials).flatMap((materials) => [...materials]); }

  restyle() {
    const { ink, surface, muted, name } = Theme, dark = name === "dark";
    /** @type {Record<string, string>} */
    const colours = {
      steel: mix(surface, ink, dark ? 0.72 : 0.16), dark: mix(surface, ink, dark ? 0.42 : 0.62), pale: mix(surface, ink, dark ? 0.5 : 0.1),
      ground: mix(surface, ink, 0.3), spring: Theme.colour(2), drive: mix(surface, Theme.colour(4), dark ? 0.75 : 0.6), ghost: muted,
    };
    for (const [role, material] of this.roles) {
      const base = typeof role !== "string" ? mix(surface, Theme.colour(role.index), dark ? 0.82 : 0.72)
        : role.startsWith("point ") ? this.scene.pointColour({ index: +role.slice(6) }) : colours[role];
      material.color.set(material.isLineBasicMaterial ? mix(base, dark ? surface : ink, 0.45) : material.isMeshBasicMaterial ? mix(base, dark ? surface : ink, 0.3) : base);
      if (role === "ghost") Object.assign(material, { transparent: true, opacity: GHOST, depthWrite: false });
      if (typeof role === "string") continue;
      const clear = this.clear || role.ellipsoid;
      if (material.isMeshStandardMaterial) Object.assign(material, { transparent: clear, opacity: this.clear ? CLEAR : role.ellipsoid ? FAINT : 1, depthWrite: !clear });
      Object.assign(material, { visible: this.inertia || !role.ellipsoid, clippingPlanes: this.section ? [this.cut] : null, clipShadows: true, needsUpdate: true });
    }
    for (const { inside } of this.solids ?? []) inside.visible = this.section;
    for (const trace of this.traces ?? []) trace.restyle(this.scene.pointColour(trace.point), surface);
    this.mesh?.restyle();
    this.view.restyle();
  }

  /** Transparent bodies. @param {boolean} clear */
  setClear(clear) { this.update({ clear }); }

  /** Ellipsoids of inertia, which are no shapes of bodies. @param {boolean} inertia */
  showInertia(inertia) { this.update({ inertia }); }

  /** Leave out the far side of a plane across an axis; null for no section.
   * @param {Axis | null} axis @param {number} share of the radius, from the centre @param {boolean} flip */
  setSection(axis, share, flip) {
    if (axis) {
      const { centre, radius } = this.view, sign = flip ? 1 : -1;
      this.cut.set(vector(AXES[axis]).multiplyScalar(sign), -sign * (centre.dot(vector(AXES[axis])) + share * radius));
    }
    this.update({ section: axis !== null });
  }

  /** @param {Partial<SpatialPainter>} change */
  update(change) {
    Object.assign(this, change);
    this.restyle();
    this.scene.invalidate();
  }

  /** @param {object | null} part */
  highlight(part) {
    for (const [role, material] of this.roles) if (material.emissive && typeof role !== "string") material.emissive.set((role.of ?? role) === part ? mix("#000000", Theme.accent, 0.45) : "#000000");
  }

  // Building -------------------------------------------------------------------------------------

  /** @param {Part} body @returns {THREE.Group} */
  groupOf(body) { return this.groups.get(body); }

  /** @param {THREE.Group} group @param {THREE.BufferGeometry} geometry @param {Role} role @param {Hit | null} hit @returns {THREE.Mesh} */
  add(group, geometry, role, hit) {
    const mesh = new THREE.Mesh(geometry, this.surface(role));
    mesh.castShadow = mesh.receiveShadow = true;
    group.add(mesh);
    if (hit) { mesh.userData = hit; this.picks.push(mesh); }
    return mesh;
  }

  /** @param {Part} body @param {Shape} shape */
  addShape(body, shape) {
    const [geometry, lines] = solidOf(shape, this.unit), group = this.groupOf(body);
    const role = body.fixed ? "ground" : shape.kind === "ellipsoid" ? this.ellipsoidOf(body) : body;
    if (geometry) {
      const mesh = this.add(group, geometry, role, body.fixed ? null : { kind: "body", item: body }), inside = new THREE.Mesh(geometry, this.inside(role));
      group.add(inside);
      this.solids.push({ mesh, inside, body, shape });
    }
    if (lines) group.add(new THREE.LineSegments(lines, this.line(role)));
  }

  /** Role of the ellipsoid of inertia of a body. @param {Part} body @returns {Part} */
  ellipsoidOf(body) { return body.inertia ??= { ...body, of: body, shapes: [], name: `inertia of ${body.name}`, ellipsoid: true }; }

  /** Thin rods from the solids of bodies to joints and links beside them. */
  addStalks() {
    const { joints, links } = this.motion;
    /** @type {Map<Part, Map<string, Point>>} */
    const spots = new Map(this.motion.bodies.map((body) => [body, new Map()]));
    for (const { body, point } of [...joints, ...joints.flatMap(({ base }) => base ?? []), ...links.flatMap(({ i, j }) => [i, j])]) spots.get(body)?.set(point.join(), point);
    for (const [body, points] of spots) {
      const solids = this.solids.filter((solid) => solid.body === body && solid.shape.kind !== "ellipsoid");
      for (const point of solids.length ? points.values() : []) {
        const nearest = solids.map(({ mesh, shape }) => nearestOn(mesh.geometry, shape, vector(point)).toArray()).sort((a, b) => apart(a, point) - apart(b, point))[0];
        if (apart(nearest, point) > 1.5 * this.unit) this.add(this.groupOf(body), tube(nearest, point, 0.45 * this.unit, 16), body, { kind: "body", item: body });
      }
    }
  }

  /** Group at a point of a body, with z along its axis. @param {End} end @returns {THREE.Group} */
  seat({ body, point, axis }) {
    const group = new THREE.Group();
    group.position.set(...point);
    if (axis) group.quaternion.setFromUnitVectors(vector(AXES.z), vector(axis).normalize());
    this.groupOf(body).add(group);
    return group;
  }

  /** @param {Item} joint */
  addJoint(joint) {
    const { base, symbol } = joint, own = JOINTS[symbol] ?? JOINTS.mark, parts = joint.axis || ["socket", "contact"].includes(symbol) ? own : JOINTS.bead;
    for (const seat of symbol === "cross" && base ? [joint, base] : [symbol === "table" && base ? base : joint]) {
      const group = this.seat(seat);
      for (const [geometry, role] of parts(this.unit)) this.add(group, geometry, role, { kind: "joint", item: joint });
    }
    if (!joint.grounded || ON_RAILS.includes(symbol)) return;
    const place = joint.body.fixed ? joint.point : base?.body.fixed ? base.point : this.motion.at(joint.body, joint.point, START), { centre, up, radius } = this.view;
    if (!place) return;
    const hangs = centre.clone().sub(vector(place)).dot(up) < -0.25 * radius;
    this.stand(place, up.clone().multiplyScalar(hangs ? -1 : 1));
  }

  /** Pedestal on the ground. @param {Point} place @param {THREE.Vector3} away from the ground */
  stand(place, away, size = 1) {
    const group = new THREE.Group();
    group.position.set(...place);
    group.quaternion.setFromUnitVectors(vector(AXES.z), away);
    for (const [geometry, role] of pedestal(size * this.unit)) this.add(group, geometry, role, null);
    this.parts.add(group);
  }

  /** @param {Item} symbol */
  addSymbol(symbol) {
    const parts = symbol.normal ? wall : SYMBOLS[symbol.symbol];
    if (!parts) return;
    const group = this.seat(symbol);
    if (symbol.normal) this.walls.push({ symbol, group });
    for (const [geometry, role] of parts(this.unit)) this.add(group, geometry, role, { kind: "symbol", item: symbol });
  }

  /** Two wheels and the strands between them, or a box where both rotate about one place. @param {Item} joint */
  addBelt(joint) {
    const hit = /** @type {Hit} */ ({ kind: "joint", item: joint }), [p, q] = joint.wheels.map(({ body, point }) => this.motion.at(body, point, START)), { unit } = this;
    if (!p || !q || apart(p, q) < 2 * unit) {
      this.add(this.seat(joint), new THREE.BoxGeometry(5 * unit, 5 * unit, 3 * unit), "drive", hit);
      return null;
    }
    for (const wheel of joint.wheels) {
      const seat = this.seat(wheel), ends = [[0, 0, -0.6 * unit], [0, 0, 0.6 * unit]];
      this.add(seat, tube(ends[0], ends[1], wheel.radius, 56), "pale", hit);
      seat.add(new THREE.LineSegments(rims(ends, wheel.radius), this.line("dark")));
    }
    return { joint, strands: [1, -1].map((side) => ({ side, mesh: this.add(this.parts, tube([0, 0, 0], [0, 0, 1], 0.35 * unit, 12), "dark", hit) })) };
  }

  /** @param {Link} link */
  addLink(link) {
    const group = new THREE.Group(), rest = link.rest || this.unit;
    const parts = (LINKS[link.symbol] ?? LINKS.rod)(this.unit, rest).map(([geometry, role, follows]) => ({ mesh: this.add(group, geometry, role, { kind: "link", item: link }), follows }));
    this.parts.add(group);
    const ends = [link.i, link.j], [p, q] = ends.map(({ body, point }) => this.motion.at(body, point, START));
    const occupied = (/** @type {Point} */ point) => this.motion.joints.some((joint) => joint.grounded && apart(this.motion.at(joint.body, joint.point, START) ?? [Infinity, 0, 0], point) < this.unit);
    if (p && q && apart(p, q) > 0) {
      const way = vector(q).sub(vector(p)).normalize();
      ends.forEach(({ body, point }, k) => { if (body.fixed && !occupied(point)) this.stand(point, way.clone().multiplyScalar(k ? -1 : 1), 0.6); });
    }
    return { link, group, parts, rest };
  }

  /** @param {Ghost} ghost */
  addGhost({ shapes }) {
    const group = new THREE.Group();
    for (const shape of shapes) {
      const [geometry, lines] = solidOf(shape, this.unit);
      if (geometry) this.add(group, geometry, "ghost", null).castShadow = false;
      if (lines) group.add(new THREE.LineSegments(lines, this.line("ghost")));
    }
    this.parts.add(group);
    return group;
  }

  // Moving ---------------------------------------------------------------------------------------

  /** @param {THREE.Group} group @param {SpatialPose | null} pose */
  move(group, pose) {
    group.visible = Boolean(pose);
    if (!pose) return;
    group.position.copy(pose.p);
    group.quaternion.copy(pose.q);
  }

  /** Place an object whose z axis leads along a vector. @param {THREE.Object3D} object @param {Point} place @param {THREE.Vector3} way */
  point(object, place, way) {
    object.position.set(...place);
    if (way.length() > 0) object.quaternion.setFromUnitVectors(vector(AXES.z), way.clone().normalize());
  }

  /** Move all parts to the present instant. */
  moveAll() {
    const { motion, scene } = this;
    for (const [body, group] of this.groups) this.move(group, motion.pose(body));
    this.ghosts.forEach((group, k) => this.move(group, scene.show.ghosts ? motion.pose(motion.ghosts[k]) : null));
    for (const { link: { i, j }, group, parts, rest } of this.links) {
      const p = motion.at(i.body, i.point), q = motion.at(j.body, j.point);
      group.visible = Boolean(p && q);
      if (!p || !q) continue;
      this.point(group, p, vector(q).sub(vector(p)));
      for (const { mesh, follows } of parts) {
        if (follows === "stretch") mesh.scale.z = Math.max(1e-9, apart(p, q) / rest);
        if (follows === "tail") mesh.position.z = apart(p, q);
      }
    }
    for (const { joint, strands } of this.belts) this.moveStrands(joint, strands);
    for (const { symbol, group } of this.walls) {
      const place = motion.placeOf(symbol), normal = vector(motion.vectorOf(symbol.normal) ?? []);
      group.visible = Boolean(place) && normal.length() > 0;
      if (place && group.visible) this.point(group, place, normal);
    }
    for (const trace of this.traces) trace.show(motion, scene.canvas);
    this.mesh?.move();
    this.view.grid.visible = scene.show.grid;
  }

  /** Strands touch both wheels, in the plane across the axis of the first one. @param {Item} joint @param {{ side: number, mesh: THREE.Mesh }[]} strands */
  moveStrands({ wheels: [one, two], crossed }, strands) {
    const { motion } = this, p = motion.at(one.body, one.point), q = motion.at(two.body, two.point), pose = motion.pose(one.body);
    for (const { mesh } of strands) mesh.visible = Boolean(p && q && pose);
    if (!p || !q || !pose) return;
    const axis = vector(one.axis ?? AXES.z).applyQuaternion(pose.q).normalize(), way = vector(q).sub(vector(p)), along = way.clone().normalize();
    const across = new THREE.Vector3().crossVectors(axis, along).normalize(), r = crossed ? -two.radius : two.radius, open = Math.acos(clamp((one.radius - r) / way.length(), -1, 1));
    for (const { side, mesh } of strands) {
      const out = along.clone().multiplyScalar(Math.cos(open)).addScaledVector(across, side * Math.sin(open));
      const from = vector(p).addScaledVector(out, one.radius), strand = vector(q).addScaledVector(out, r).sub(from);
      this.point(mesh, from.toArray(), strand);
      mesh.scale.z = strand.length();
    }
  }

  // Painting -------------------------------------------------------------------------------------

  /** @param {Paper | null} paper @returns {Paper} */
  paint(paper) {
    const { canvas, scene, view } = this;
    this.moveAll();
    this.half = clamp(this.unit * view.scaleAt(view.centre.toArray()), 2.2, 13);
    if (paper) {
      view.aim(paper.w, paper.h);
      new FlatPainter().paint(view.world, view.camera, paper);
      return paper;
    }
    view.render(scene.ratio);
    const sheet = fitCanvas(canvas, scene.ratio);
    if (view.renderer instanceof FlatPainter) scene.marks.note(sheet, "Drawn without WebGL (unavailable or disabled in this browser): no shadows.");
    return sheet;
  }

  /** @param {Pixel} pixel @returns {Hit | null} */
  hit([x, y]) {
    const { clientWidth: w, clientHeight: h } = this.scene.canvas, ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / w - 1, 1 - (2 * y) / h), this.view.camera);
    /** @type {{ distance: number, point: THREE.Vector3, object: THREE.Mesh }[]} */
    const hits = ray.intersectObjects(this.picks, false).filter((/** @type {any} */ { point, object }) => visible(object) && !(this.section && this.cut.distanceToPoint(point) < 0 && object.userData.kind === "body"));
    const symbol = hits.find(({ object }) => object.userData.kind !== "body");
    return (symbol && symbol.distance < hits[0].distance + 4 * this.unit ? symbol : hits[0])?.object.userData ?? null;
  }

  /** Names at the middles of bodies and beside joints, the nearest first. @returns {Label[]} */
  labels() {
    const { motion, unit, view } = this, short = motion.joints.filter(({ name }) => name && name.length <= 3);
    const items = [
      ...motion.bodies.filter(({ label }) => label).map((body) => ({ text: body.label, font: "600 12px", place: motion.at(body, middleOf(motion, body)), colour: mix(Theme.colour(body.index), Theme.ink, 0.35), owner: body })),
      ...(short.length > 24 ? [] : short).map((joint) => ({ text: joint.name, font: "italic 12px", place: motion.placeOf(joint), colour: Theme.muted, owner: joint })),
    ];
    return items.map(({ place, ...label }) => {
      const p = place && view.screen(place);
      if (!p) return null;
      const r = clamp(2.4 * unit * view.scaleAt(place), 6, 40), wide = 4 * label.text.length;
      const offsets = label.font[0] === "i" ? [[-r - wide, -r], [r + wide, -r], [-r - wide, r], [r + wide, r]] : [[0, -r - 8], [0, r + 8], [r + wide, 0], [-r - wide, 0]];
      return { ...label, places: offsets.map(([dx, dy]) => /** @type {Pixel} */ ([p[0] + dx, p[1] + dy])), required: false, depth: -view.seen(place).z };
    }).filter((label) => label !== null).sort((a, b) => b.font.length - a.font.length || a.depth - b.depth);
  }
}

/** Mean of the outline of a body. @param {SpatialMotion} motion @param {Part} body @returns {Point} */
function middleOf(motion, { shapes }) {
  const points = shapes.flatMap((shape) => motion.outline(shape));
  return motion.point([0, 1, 2].map((k) => points.reduce((sum, p) => sum + (p[k] ?? 0), 0) / (points.length || 1)));
}

/** Whether an object and all its parents are visible. @param {THREE.Object3D | null} object @returns {boolean} */
const visible = (object) => !object || (object.visible && visible(object.parent));
