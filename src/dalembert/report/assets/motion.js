// Scene of a page over time: bodies, primitives between them, the mesh of a structure.

/** @import { Column, Cursor, Payload, Point, TracedPoint } from "./types.d.ts" */
/** @import { BodyData, End, EndData, Gap, Ghost, Item, ItemData, Link, Part, Parts, Shape, States, Wheel } from "./scene_types.d.ts" */

import { TAU, clock, floats, list, steady } from "./numbers.js";
import { Signal } from "./theme.js";
import { Timeline } from "./timeline.js";

/** Period in which a model swings in one of its states [s]. */
const SWING = 2.4;

/** What follows from the whole motion: paths of points, mean lengths of links. */
const KEPT = ["index", "names", "traced", "way", "length", "rest", "offset"];

/** Names of states; those of modes state a value, which a live page computes. @param {States | undefined} states */
function stateNames({ names, kind, numbers, values, unit = "" } = { kind: "", names: [] }) {
  return list(names).map((name, k) => (values ? `${kind} ${numbers?.[k]}: ${+Number(values[k]).toPrecision(5)} ${unit}`.trim() : String(name)));
}

/** Base class of planar and spatial scenes, whose methods read and place points. */
export class Motion extends Timeline {
  /** @param {Payload} payload @param {Parts} parts of pages of structures and modes */
  constructor(payload, { structure = null, Swing } = {}) {
    const { scene = {}, states } = payload;
    super(states ? { ...payload, time: states.times } : payload);
    /** Signal of another state, field or scale. @type {Signal} */
    this.onState = new Signal();
    this.states = { kind: String(states?.kind ?? ""), names: Swing?.names(states) ?? stateNames(states), relative: Boolean(states?.relative) };
    /** Whether the model swings in the chosen one of its states. */
    this.swings = Boolean(states) && this.n < 2;
    this.chosen = 0;
    if (this.swings) Object.assign(this, { n: this.states.names.length, start: 0, end: SWING, span: SWING, moves: true, cursor: { i: 0, f: 0 } });
    /** Share of the displacements of a mesh in a swing. */
    this.share = 1;
    /** Oscillation of a mechanism. */
    this.swing = this.swings && Swing ? new Swing(this) : null;

    /** @type {Float64Array[]} */
    const poses = [], column = (/** @type {unknown} */ values) => poses[poses.push(this.column(values)) - 1];
    this.setBodies(list(scene.bodies), (/** @type {BodyData} */ body) => this.readBody(body, column));
    this.ground.shapes = this.readShapes(scene.ground?.shapes);
    const gravity = scene.gravity ? this.point(scene.gravity) : null;
    this.gravity = gravity && Math.hypot(...gravity) > 0 ? gravity : null;
    const known = (/** @type {EndData} */ { body }) => this.has(body ?? "ground");
    /** @type {Item[]} */
    this.joints = list(scene.joints).filter(known).map((item) => this.readItem(item));
    /** @type {Item[]} */
    this.symbols = list(scene.symbols).filter(known).map((item) => this.readItem(item));
    /** @type {Link[]} */
    this.links = list(scene.links).filter(({ i, j }) => i && j && known(i) && known(j)).map((link) => ({ ...this.header(link), i: this.readEnd(link.i), j: this.readEnd(link.j), rest: 0, offset: 0 }));
    /** @type {TracedPoint[]} */
    this.points = list(scene.points).filter(known).map((item, index) => ({ name: String(item.name ?? ""), ...this.readEnd(item), index, traced: false, names: [], way: [], length: 0 }));
    /** Bodies of another design or run, or of the initial guess. @type {Ghost[]} */
    this.ghosts = list(scene.ghosts).filter(({ mesh }) => !mesh).map((ghost) => this.readBody(ghost, (values) => (this.swing ? this.column(values) : steady(/** @type {Column} */ (values), this.n))));
    /** Bodies at rest behind an oscillation. @type {Ghost[]} */
    this.resting = [];
    /** @type {Gap[]} */
    this.gaps = list(scene.gaps).map(({ from, to, text }) => ({ from: this.point(from), to: this.point(to), text: String(text ?? "") }));
    this.mesh = scene.mesh && structure ? new structure.Mesh(scene.mesh, payload, scene) : null;
    const other = list(scene.ghosts).find(({ mesh }) => mesh)?.mesh;
    /** Mesh of another design or run. */
    this.otherMesh = other && structure ? new structure.Mesh(other, { states: payload.states }, {}) : null;
    /** Reactions of the supports of a structure. @type {Item[]} */
    this.reactions = (this.mesh?.reactionItems() ?? []).map((item) => this.readItem(item));
    this.swing?.begin(list(scene.bodies), poses);
  }

  // Reading ------------------------------------------------------------------------------------

  /** @returns {2 | 3} */
  get dimension() { return 2; }

  /** Names of the axes of vectors in the payload. */
  get axes() { return ["x", "y", "z"].slice(0, this.dimension); }

  /** @param {unknown} value @returns {Point} */
  point(value) { throw new Error(`a point ${value} is read in the plane or in space`); }

  /** @param {Partial<Shape>[] | undefined} shapes @returns {Shape[]} */
  readShapes(shapes) { return /** @type {Shape[]} */ (list(shapes)); }

  /** Values over the instants or states; of an oscillation three blocks of them. @param {unknown} values */
  column(values) {
    const column = /** @type {Column} */ (values);
    return floats(column, this.swing ? list(column).length : this.n);
  }

  /** Columns of the pose of a body, and its shapes. @param {BodyData} body @param {(values: unknown) => Float64Array} column @returns {Ghost} */
  readBody(body, column) { return { shapes: this.readShapes(body.shapes), column }; }

  /** @param {{ name?: string, description?: string, symbol?: string }} item */
  header({ name = "", description, symbol = "" }) { return { name: String(name), description: String(description ?? symbol), symbol: String(symbol) }; }

  /** @param {EndData} end @returns {End} */
  readEnd({ body = "ground", point, axis }) { return { body: this.find(body), point: this.point(point), axis: axis ? this.point(axis) : null }; }

  /** @param {EndData[] | undefined} ends @returns {Wheel[]} */
  readWheels(ends) { return list(ends).filter(({ body = "ground" }) => this.has(body)).map((end) => ({ ...this.readEnd(end), radius: Math.abs(end.radius ?? 0) })); }

  /** Columns of a vector, `name_x` …, or of a planar moment, `name`. @param {ItemData} item @param {string} name */
  readVector(item, name) {
    const names = item[`${name}_x`] ? this.axes.map((axis) => `${name}_${axis}`) : item[name] ? [name] : null;
    return names && names.map((key) => this.column(item[key]));
  }

  /** @param {ItemData} item @returns {Item} */
  readItem(item) {
    const { base, on, i, j, internal, crossed, node, grounded, roller, clamp } = item;
    return {
      ...this.header(item), ...this.readEnd(item), base: base ? this.readEnd(base) : null, on: this.byName.get(String(on)) ?? null,
      i: this.find(String(i)), j: this.find(String(j)), mesh: this.readWheels(item.mesh), wheels: this.readWheels(item.wheels),
      grounded: Boolean(grounded), internal: Boolean(internal), crossed: Boolean(crossed), roller: Boolean(roller), clamp: Boolean(clamp),
      force: this.readVector(item, "force"), moment: this.readVector(item, "moment"), at: this.readVector(item, "at"), normal: this.readVector(item, "normal"),
      node: node ?? null, nodes: list(item.nodes), inward: item.inward ? floats(item.inward, this.n) : null,
    };
  }

  /** Show another design. @param {Motion} next */
  replace(next) {
    const { onState, mesh, swing, chosen } = this;
    Object.assign(this, next, { onState, chosen: Math.max(0, Math.min(chosen, next.states.names.length - 1)) });
    if (mesh) this.mesh?.adopt(mesh);
    if (swing) this.swing?.adopt(swing, this);
    this.choose(this.chosen);
  }

  /** Take the poses and dimensions of another design; the parts remain the same objects. @param {Motion} next */
  follow(next) {
    const own = (/** @type {Part} */ part) => this.find(part.name);
    /** @type {(value: any) => any} */
    const local = (value) => (Array.isArray(value) ? value.map(local) : value?.shapes ? own(value) : value?.body ? { ...value, body: own(value.body) } : value);
    this.ground.shapes = next.ground.shapes;
    this.bodies.forEach((body, k) => {
      const { index, name, label, node, of, ...read } = next.bodies[k];
      body.shapes.forEach(({ teeth }, i) => { if (teeth && read.shapes[i]) read.shapes[i].teeth ??= teeth; });
      Object.assign(body, read);
    });
    for (const kind of /** @type {const} */ (["joints", "symbols", "links", "points"])) this[kind].forEach((/** @type {any} */ item, k) => {
      for (const [key, value] of Object.entries(next[kind][k])) {
        if (KEPT.includes(key)) continue;
        if (item[key]?.body && value) Object.assign(item[key], local(value)); else item[key] = local(value);
      }
    });
  }

  // Time ---------------------------------------------------------------------------------------

  /** Time at rest: the first instant; of a swing, the largest displacement. */
  get home() { return this.swings ? this.span / 4 : this.start; }

  /** @override @param {number} t */
  setTime(t) {
    const { state } = this;
    this.now = t;
    this.cursor = this.swings ? { i: this.chosen, f: this.swing ? (t / this.span) % 1 : 0 } : this.locate(t);
    this.share = this.swings ? Math.sin((TAU * t) / this.span) : 1;
    if (this.mesh && this.state !== state) this.onState.emit();
  }

  /** The present time, or the name of the present state. @param {number} t */
  timeText(t) { return this.inTime ? `${clock(t, this.span)} s` : this.states.names[this.state]; }

  /** Whether its states follow each other in time; those of a load path do not. */
  get inTime() { return !this.states?.kind || this.states.kind === "instant"; }

  /** Number of the present state. */
  get state() { return this.cursor.i + (this.cursor.f >= 0.5 && !this.swing ? 1 : 0); }

  /** @param {number} state */
  choose(state) {
    this.chosen = state;
    if (this.swings) this.cursor = { i: state, f: this.swing ? this.cursor.f : 0 };
    this.onState.emit();
  }

  /** Value between two instants, or at a phase of a mode. @override @param {Float64Array} column @param {Cursor} cursor */
  sample(column, cursor) { return this.swing?.sample(column, cursor) ?? super.sample(column, cursor); }

  /** Evenly distributed instants, or phases of all modes. @override @param {number} limit @returns {Cursor[]} */
  frames(limit) { return this.swing?.frames(limit) ?? super.frames(limit); }

  /** Values of columns. @param {Float64Array[] | null} columns */
  vectorOf(columns, cursor = this.cursor) { return columns ? columns.map((column) => this.sample(column, cursor)) : null; }

  // Positions ------------------------------------------------------------------------------------

  /** Pose of a body; null where it has none. @param {Part | Ghost} body @param {Cursor} cursor @returns {any} */
  pose(body, cursor = this.cursor) { return null; }

  /** Position of a point in a pose. @param {any} pose @param {Point} point @returns {Point} */
  placed(pose, point) { return point; }

  /** A direction in the axes of a body. @param {Part} body @param {number[]} direction @param {Cursor} cursor */
  turnedBack(body, direction, cursor) { return direction; }

  /** Position of a point of a body. @override @param {Part} body @param {Point} point @param {Cursor} cursor @returns {Point | null} */
  at(body, point, cursor = this.cursor) {
    const pose = this.pose(body, cursor);
    return pose && this.placed(pose, point);
  }

  /** Position of a joint, symbol or load. @param {Item} item @returns {Point | null} */
  placeOf({ node, at, body, point }) {
    if (node !== null) return this.mesh?.placeOf(node, this.dimension) ?? null;
    const place = at ? /** @type {Point} */ (this.vectorOf(at)) : this.at(body, point);
    return place && place.every(Number.isFinite) ? place : null;
  }

  /** Name and text of the rotation of a body. @param {Part} body @returns {[string, string]} */
  rotationRow(body) { return ["", body.name]; }

  /** Points that bound a shape, in the axes of its body. @param {Shape} shape @returns {Point[]} */
  outline(shape) { return shape.points; }

  /** Points that the scene occupies, over the motion with ground and ghosts, or the bodies alone at some instants. @param {Cursor[]} [instants] */
  cloud(instants) {
    const all = !instants, frames = instants ?? this.frames(120), { ground, bodies, joints, symbols, points, links } = this;
    /** @type {Map<Part, Point[]>} */
    const marks = new Map([ground, ...bodies].map((body) => [body, body.shapes.flatMap((shape) => this.outline(shape))]));
    const items = [...joints, ...symbols].filter(({ at, node, nodes }) => !at && node === null && !nodes.length);
    for (const { body, point } of [...items, ...points, ...links.flatMap(({ i, j }) => [i, j])]) marks.get(body)?.push(point);
    for (const { body, point, radius } of [...joints, ...symbols].flatMap(({ wheels }) => wheels)) {
      for (const axis of point.keys()) for (const side of [-radius, radius]) marks.get(body)?.push(/** @type {Point} */ (point.map((v, k) => (k === axis ? v + side : v))));
    }
    for (const body of bodies) if (!marks.get(body)?.length) marks.set(body, [this.point(null)]);
    const places = all ? [...marks.get(ground) ?? [], ...this.gaps.flatMap(({ from, to }) => [from, to])] : [];
    const occupy = (/** @type {Part | Ghost} */ body, /** @type {Cursor} */ cursor, /** @type {Point[]} */ outline) => {
      const pose = this.pose(body, cursor);
      if (pose) for (const point of outline) places.push(this.placed(pose, point));
    };
    for (const cursor of frames) for (const body of bodies) occupy(body, cursor, marks.get(body) ?? []);
    for (const ghost of all ? this.ghosts : []) {
      const outline = ghost.shapes.flatMap((shape) => this.outline(shape));
      for (const cursor of this.frames(30)) occupy(ghost, cursor, outline);
    }
    if (this.mesh) places.push(...this.mesh.cloud(this.swings ? [this.cursor] : frames, this.dimension));
    return places.length ? places : [this.point(null)];
  }
}
