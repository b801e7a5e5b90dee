// Spatial scenes of solids: built once, moved to an instant, coloured, cut, and found under the pointer.

/** @import { Axis, End, Ghost, Hit, Item, Link, Paper, Part, Pixel, Point, Shape } from "./scene_types.d.ts" */
/** @import { MeshSolids } from "./mesh_solids.js" */
/** @import { Role } from "./spatial_materials.js" */
/** @import { SpatialMotion } from "./spatial_motion.js" */
/** @import { SpatialView } from "./spatial_view.js" */
/** @import { Scene } from "./scene.js" */

import "./vendor/three.js";
import { fitCanvas } from "./canvas.js";
import { el } from "./dom.js";
import { FlatPainter } from "./flat_painter.js";
import { clamp } from "./numbers.js";
import { apart, ball, discard, nearestOn, rims, solidOf, tube } from "./solids.js";
import { spatialLabels } from "./spatial_labels.js";
import { Materials } from "./spatial_materials.js";
import { AXES, vector } from "./spatial_motion.js";
import { moveParts } from "./spatial_moves.js";
import { JOINTS, LINKS, SYMBOLS, pedestal, wall } from "./spatial_symbols.js";
import { SpatialTrace } from "./spatial_trace.js";
import { Theme } from "./theme.js";

/** Joints whose other part, a rail or a plane, is drawn itself. */
const ON_RAILS = ["slider", "collar", "nut", "table", "clamp"];
const START = { i: 0, f: 0 };
/** Limit of the lengths of lists that are compared. */
const LONG = 500;

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
    this.materials = new Materials();
    /** Bodies → their solids. @type {Map<Part, THREE.Group>} */
    this.groups = new Map();
    /** Solids that can be found under the pointer. @type {THREE.Mesh[]} */
    this.picks = [];
    /** @type {{ mesh: THREE.Mesh, inside: THREE.Mesh, body: Part, shape: Shape }[]} */
    this.solids = [];
    /** @type {{ symbol: Item, group: THREE.Group }[]} */
    this.walls = [];
    /** Changes of the parts that follow other dimensions. @type {(() => void)[]} */
    this.fits = [];
  }

  /** Take the dimensions of the same parts in another design: geometry that differs is built again, the rest is moved. */
  refit() { for (const fit of this.fits) fit(); }

  build() {
    const { motion, scene, view } = this;
    if (this.parts) {
      discard(this.parts);
      view.world.remove(this.parts);
    }
    this.parts = new THREE.Group();
    view.world.add(this.parts);
    this.materials.clearRoles();
    this.unit = scene.unit;
    this.groups = new Map([motion.ground, ...motion.bodies].map((body) => [body, new THREE.Group()]));
    this.parts.add(...this.groups.values());
    this.picks = [];
    this.solids = [];
    this.walls = [];
    this.fits = [];
    for (const body of this.groups.keys()) body.shapes.forEach((shape, k) => this.addShape(body, shape, k));
    this.addStalks();
    for (const joint of motion.joints) this.addJoint(joint);
    for (const symbol of motion.symbols) this.addSymbol(symbol);
    for (const point of motion.points) {
      const mesh = this.add(this.groupOf(point.body), ball([0, 0, 0], 0.55 * this.unit), `point ${point.index}`, { kind: "point", item: point });
      this.fitted(() => mesh.position.set(...point.point));
      mesh.castShadow = false;
    }
    this.links = motion.links.map((link) => this.addLink(link));
    this.ghosts = [...motion.ghosts, ...motion.resting].map((ghost) => ({ ghost, group: this.addGhost(ghost) }));
    this.belts = motion.joints.filter(({ wheels }) => wheels.length === 2).map((joint) => this.addBelt(joint)).filter((belt) => belt !== null);
    this.traces = motion.points.map((point) => new SpatialTrace(point, this.parts));
    this.mesh = scene.structure && motion.mesh ? new scene.structure.Picture(this, motion.mesh, motion.otherMesh) : null;
    this.restyle();
  }

  restyle() {
    this.materials.restyle((point) => this.scene.pointColour(point));
    for (const { inside } of this.solids) inside.visible = this.materials.section;
    for (const trace of this.traces) trace.restyle(this.scene.pointColour(trace.point), Theme.surface);
    this.mesh?.restyle();
    this.view.restyle();
  }

  /** Change how bodies look: transparent, in a section, with their ellipsoids of inertia.
   * @param {Partial<Pick<Materials, "clear" | "section" | "inertia">>} change */
  change(change) {
    Object.assign(this.materials, change);
    this.restyle();
    this.scene.invalidate();
  }

  /** Leave out the far side of a plane across an axis; null for no section.
   * @param {Axis | null} axis @param {number} share of the radius, from the centre @param {boolean} flip */
  setSection(axis, share, flip) {
    if (axis) {
      const { centre, radius } = this.view, sign = flip ? 1 : -1;
      this.materials.cut.set(vector(AXES[axis]).multiplyScalar(sign), -sign * (centre.dot(vector(AXES[axis])) + share * radius));
    }
    this.change({ section: axis !== null });
  }

  /** @param {object | null} part */
  highlight(part) { this.materials.highlight(part); }

  // Building -------------------------------------------------------------------------------------

  /** @param {Part} body @returns {THREE.Group} */
  groupOf(body) { return this.groups.get(body); }

  /** @param {THREE.Group} group @param {THREE.BufferGeometry} geometry @param {Role} role @param {Hit | null} hit @returns {THREE.Mesh} */
  add(group, geometry, role, hit) {
    const mesh = new THREE.Mesh(geometry, this.materials.surface(role));
    mesh.castShadow = mesh.receiveShadow = true;
    group.add(mesh);
    if (hit) { mesh.userData = hit; this.picks.push(mesh); }
    return mesh;
  }

  /** Carry out a change now, and whenever dimensions change. @param {() => void} change */
  fitted(change) {
    change();
    this.fits.push(change);
  }

  /** @param {Part} body @param {Shape} shape @param {number} k its place among the shapes of the body */
  addShape(body, shape, k) {
    const [geometry, lines] = solidOf(shape, this.unit), group = this.groupOf(body);
    const role = body.fixed ? "ground" : shape.kind === "ellipsoid" ? this.ellipsoidOf(body) : body;
    /** @type {THREE.Mesh[]} */
    const solid = [];
    /** @type {any[]} */
    const edges = [];
    if (geometry) {
      const mesh = this.add(group, geometry, role, body.fixed ? null : { kind: "body", item: body }), inside = new THREE.Mesh(geometry, this.materials.inside(role));
      group.add(inside);
      if (!body.fixed) { inside.userData = mesh.userData; this.picks.push(inside); }
      this.solids.push({ mesh, inside, body, shape });
      solid.push(mesh, inside);
    }
    if (lines) {
      edges.push(new THREE.LineSegments(lines, this.materials.line(role)));
      group.add(...edges);
    }
    let present = dimensionsOf(shape);
    this.fits.push(() => {
      const next = body.shapes[k], text = dimensionsOf(next);
      if (text === present) return;
      present = text;
      const record = this.solids.find(({ mesh }) => mesh === solid[0]), parts = solidOf(next, this.unit);
      if (record) record.shape = next;
      [solid, edges].forEach((meshes, i) => {
        const geometry = parts[i];
        if (!geometry) return;
        meshes[0]?.geometry.dispose();
        for (const mesh of meshes) mesh.geometry = geometry;
      });
    });
  }

  /** Role of the ellipsoid of inertia of a body. @param {Part} body @returns {Part} */
  ellipsoidOf(body) { return body.inertia ??= { ...body, of: body, shapes: [], name: `inertia of ${body.name}`, ellipsoid: true }; }

  /** Thin rods from the solids of bodies to joints and links beside them. */
  addStalks() {
    const { joints, links } = this.motion;
    /** @type {Map<Part, { point: Point }[]>} */
    const spots = new Map(this.motion.bodies.map((body) => [body, []]));
    for (const end of [...joints, ...joints.flatMap(({ base }) => base ?? []), ...links.flatMap(({ i, j }) => [i, j])]) spots.get(end.body)?.push(end);
    for (const [body, ends] of spots) {
      const solids = this.solids.filter((solid) => solid.body === body && solid.shape.kind !== "ellipsoid");
      /** @type {THREE.Mesh[]} */
      let rods = [];
      let present = "";
      this.fitted(() => {
        const points = new Map(ends.map(({ point }) => [point.join(), point])), text = dimensionsOf([...points.keys(), body.shapes]);
        if (text === present || !solids.length) return;
        present = text;
        for (const rod of rods) { rod.geometry.dispose(); this.groupOf(body).remove(rod); }
        this.picks = this.picks.filter((mesh) => !rods.includes(mesh));
        rods = [...points.values()].flatMap((point) => {
          const nearest = solids.map(({ mesh, shape }) => nearestOn(mesh.geometry, shape, vector(point)).toArray()).sort((a, b) => apart(a, point) - apart(b, point))[0];
          return apart(nearest, point) > 1.5 * this.unit ? [this.add(this.groupOf(body), tube(nearest, point, 0.45 * this.unit, 16), body, { kind: "body", item: body })] : [];
        });
      });
    }
  }

  /** Group at a point of a body, with z along its axis. @param {End} end @returns {THREE.Group} */
  seat(end) {
    const group = new THREE.Group();
    this.fitted(() => {
      group.position.set(...end.point);
      if (end.axis) group.quaternion.setFromUnitVectors(vector(AXES.z), vector(end.axis).normalize());
    });
    this.groupOf(end.body).add(group);
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
    const placed = () => (joint.body.fixed ? joint.point : base?.body.fixed ? base.point : this.motion.at(joint.body, joint.point, START)), place = placed(), { centre, up, radius } = this.view;
    if (!place) return;
    const hangs = centre.clone().sub(vector(place)).dot(up) < -0.25 * radius;
    this.stand(placed, up.clone().multiplyScalar(hangs ? -1 : 1));
  }

  /** Pedestal on the ground. @param {() => Point | null} placed its place @param {THREE.Vector3} away from the ground */
  stand(placed, away, size = 1) {
    const group = new THREE.Group();
    this.fitted(() => group.position.set(...placed() ?? [0, 0, 0]));
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
      seat.add(new THREE.LineSegments(rims(ends, wheel.radius), this.materials.line("dark")));
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
      ends.forEach((end, k) => { if (end.body.fixed && !occupied(end.point)) this.stand(() => end.point, way.clone().multiplyScalar(k ? -1 : 1), 0.6); });
    }
    return { link, group, parts, rest };
  }

  /** @param {Ghost} ghost */
  addGhost({ shapes }) {
    const group = new THREE.Group();
    for (const shape of shapes) {
      const [geometry, lines] = solidOf(shape, this.unit);
      if (geometry) this.add(group, geometry, "ghost", null).castShadow = false;
      if (lines) group.add(new THREE.LineSegments(lines, this.materials.line("ghost")));
    }
    this.parts.add(group);
    return group;
  }

  // Painting -------------------------------------------------------------------------------------

  /** @param {Paper | null} paper @returns {Paper} */
  paint(paper) {
    const { canvas, scene, view } = this;
    moveParts(this);
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
  hit(pixel) { return this.struck(pixel)?.object.userData ?? null; }

  /** Nearest solid at a pixel, with the point on it; symbols before the bodies around them. @param {Pixel} pixel @returns {{ distance: number, point: THREE.Vector3, face: any, object: THREE.Mesh } | null} */
  struck([x, y]) {
    const { clientWidth: w, clientHeight: h } = this.scene.canvas, ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / w - 1, 1 - (2 * y) / h), this.view.camera);
    /** @type {{ distance: number, point: THREE.Vector3, face: any, object: THREE.Mesh }[]} */
    const hits = ray.intersectObjects(this.picks, false).filter((/** @type {any} */ { point, object }) => visible(object) && !(this.materials.section && this.materials.cut.distanceToPoint(point) < 0 && object.userData.kind === "body"))
      .map((/** @type {any} */ hit) => (hit.object.material.side === THREE.BackSide ? this.onSection(hit, ray.ray) : hit));
    const symbol = hits.find(({ object }) => object.userData.kind !== "body");
    return (symbol && symbol.distance < hits[0].distance + 4 * this.unit ? symbol : hits[0]) ?? null;
  }

  /** A hit inside a solid that is cut: its section seems filled, so the ray ends in the plane of the section. @param {any} hit @param {any} ray */
  onSection(hit, ray) {
    const { cut } = this.materials, point = ray.intersectPlane(cut, new THREE.Vector3());
    if (!point) return hit;
    const normal = cut.normal.clone().negate().transformDirection(hit.object.matrixWorld.clone().invert());
    return { ...hit, point, distance: point.distanceTo(ray.origin), face: { ...hit.face, normal } };
  }

  labels() { return spatialLabels(this); }
}

/** Dimensions of shapes as a text; of long lists, which a drag does not change, their lengths. @param {unknown} shapes @returns {string} */
const dimensionsOf = (shapes) => JSON.stringify(shapes, (_, value) => ((Array.isArray(value) || ArrayBuffer.isView(value)) && Number(/** @type {any} */ (value).length) > LONG ? /** @type {any} */ (value).length : value));

/** Whether an object and all its parents are visible. @param {THREE.Object3D | null} object @returns {boolean} */
const visible = (object) => !object || (object.visible && visible(object.parent));
