// Motion over the instants of a page: series, events, bodies, paths of points.

/** @import { Body, Cursor, Payload, Point, Series, TracedPoint } from "./types.d.ts" */
/** @import { BodyData } from "./scene_types.d.ts" */

import { TAU, clamp, extent, floats, isNum, list } from "./numbers.js";
import { unitOf } from "./units.js";

/** Upper limit of the points of a path, approximately. */
const PATH_POINTS = 2000;

export class Timeline {
  /** @param {Payload} payload */
  constructor(payload) {
    this.title = String(payload.title || "mechanism");
    this.time = Float64Array.from(list(payload.time), (t) => t ?? NaN).filter((t) => isNum(t));
    this.n = this.time.length;
    this.start = this.n ? this.time[0] : 0;
    this.end = this.n ? this.time[this.n - 1] : 0;
    this.span = this.end - this.start;
    this.moves = this.n > 1 && this.span > 0;
    /** Names of the points whose paths the report requests; null for a choice by length. @type {string[] | null} */
    this.requested = Array.isArray(payload.trace) ? payload.trace.map(String) : null;
    const count = this.n || list(payload.states?.numbers).length;
    this.series = list(payload.series).map((s) => /** @type {Series} */ ({
      name: String(s.name ?? ""), unit: unitOf(s), group: String(s.group || "other"), values: floats(s.values, count),
      other: s.other ? floats(s.other, count) : null,
    }));
    this.seriesByName = new Map(this.series.map((s) => [s.name, s]));
    /** Name of the second run. */
    this.other = payload.other ? String(payload.other) : "";
    this.events = list(payload.events).filter((e) => isNum(e.time)).map((e) => ({ name: String(e.name ?? "event"), time: e.time }));
    /** @type {Body[]} */
    this.bodies = [];
    /** @type {Map<string, Body>} */
    this.byName = new Map();
    /** @type {object[]} */
    this.joints = [];
    /** Bodies of another run or design. @type {object[]} */
    this.ghosts = [];
    /** @type {TracedPoint[]} */
    this.points = [];
    /** Points at distinct positions. @type {TracedPoint[]} */
    this.spots = [];
    /** @type {Body} */
    this.ground = { name: "ground", index: -1, label: "", node: false, fixed: true, shapes: [] };
    this.now = this.start;
    this.cursor = this.locate(this.start);
  }

  /** Series by their groups. @returns {[string, Series[]][]} */
  get groups() {
    /** @type {Map<string, Series[]>} */
    const groups = new Map();
    for (const s of this.series) groups.set(s.group, [...(groups.get(s.group) ?? []), s]);
    return [...groups];
  }

  /** Series of some names; unknown ones are left out. @param {string[]} names */
  named(names) { return names.map((name) => this.seriesByName.get(name)).filter((s) => s !== undefined); }

  /** Read the bodies of a drawing; a part of a body shares its colour.
   * @param {BodyData[]} items @param {(item: BodyData) => object} read */
  setBodies(items, read) {
    this.bodies = list(items).map((item, index) => /** @type {Body} */ ({ name: String(item.name ?? `body ${index + 1}`), index, node: Boolean(item.node), ...read(item) }));
    for (const [k, { of }] of list(items).entries()) {
      const owner = this.bodies.find((body) => of !== undefined && body.name === String(of));
      if (owner) Object.assign(this.bodies[k], { index: owner.index, of: owner });
    }
    for (const body of this.bodies) body.label = body.of || body.node ? "" : body.name.length > 28 ? `${body.name.slice(0, 27)}…` : body.name;
    this.byName = new Map(this.bodies.map((body) => [body.name, body]));
  }

  /** @param {string} name */
  has(name) { return name === "ground" || this.byName.has(String(name)); }

  /** @param {string} name */
  find(name) { return this.byName.get(String(name)) ?? this.ground; }

  /** Position of a point of a body; null where the body has no pose.
   * @param {Body} body @param {Point} point @param {Cursor} cursor @returns {Point | null} */
  at(body, point, cursor) { return null; }

  /** @param {number} t */
  setTime(t) {
    this.now = t;
    this.cursor = this.locate(t);
  }

  /** Position of a time between the instants. @param {number} t @returns {Cursor} */
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

  /** Value between two instants, linear; beside a gap, that of the nearer instant.
   * @param {Float64Array} column @param {Cursor} cursor */
  sample(column, { i, f }) {
    const a = column[i];
    if (f === 0 || i + 1 >= column.length) return a;
    const b = column[i + 1];
    if (a !== a || b !== b) return f < 0.5 ? a : b;
    return a + (b - a) * f;
  }

  /** Body that the view follows where the motion leads far away. @param {number} whole size of the motion @param {number} once size of the mechanism */
  traveller(whole, once) {
    const drawn = this.bodies.filter((body) => body.shapes.length && !body.of && !body.node);
    return drawn.length > 1 && whole > 4 * once && once > 0 ? drawn[0] : null;
  }

  /** Positions of a point over the motion, thinned out. @param {Body} body @param {Point} point */
  path(body, point) {
    const stride = Math.max(1, Math.ceil(this.n / PATH_POINTS)), path = [];
    for (let i = 0; i < this.n; i += stride) path.push({ t: this.time[i], p: this.at(body, point, { i, f: 0 }) });
    if (this.n && (this.n - 1) % stride) path.push({ t: this.end, p: this.at(body, point, { i: this.n - 1, f: 0 }) });
    return path;
  }

  /** Evenly distributed instants. @param {number} limit @returns {Cursor[]} */
  frames(limit) {
    const count = Math.min(this.n, limit);
    return Array.from({ length: count }, (_, k) => ({ i: count > 1 ? Math.round((k * (this.n - 1)) / (count - 1)) : 0, f: 0 }));
  }

  /** Angles in degrees or in radians. @param {boolean} degrees */
  setDegrees(degrees) {
    for (const s of this.series) {
      const { unit, values, other } = s.original ??= { unit: s.unit, values: s.values, other: s.other }, angle = degrees && /^rad\b/.test(unit);
      const scaled = (/** @type {Float64Array | null} */ column) => (column && angle ? column.map((v) => (v * 360) / TAU) : column);
      Object.assign(s, { unit: angle ? unit.replace("rad", "°") : unit, values: scaled(values), other: scaled(other) });
    }
  }

  /** Merge points that coincide during the whole motion. @param {number} size of the mechanism */
  joinPoints(size) {
    const near = (/** @type {Point | null} */ p, /** @type {Point | null} */ q) => (p && q ? distance(p, q) < 1e-4 * size : p === q);
    /** @type {Map<TracedPoint, (Point | null)[]>} */
    const samples = new Map();
    for (const point of this.points) {
      const stride = Math.max(1, Math.floor(point.way.length / 24)), own = point.way.filter((_, k) => k % stride === 0).map(({ p }) => p);
      const first = this.moves && [...samples].find(([, others]) => others.every((p, k) => near(p, own[k])))?.[0];
      point.names = [point.name];
      if (first) { point.same = first; first.names.push(point.name); } else samples.set(point, own);
    }
    this.spots = [...samples.keys()];
  }

  /** Trace the requested points; by default up to three moving ones, of more the one with the longest path. @param {number} size of the mechanism */
  chooseTraces(size) {
    for (const point of this.points) {
      point.way = this.path(point.body, point.point);
      const positions = point.way.map(({ p }) => p).filter((p) => p !== null);
      point.length = positions.reduce((sum, p, k) => sum + (k ? distance(p, positions[k - 1]) : 0), 0);
    }
    this.joinPoints(size);
    const { requested } = this, moving = this.spots.filter((point) => point.length > 1e-6 * size);
    const chosen = requested ? this.spots.filter(({ names }) => names.some((name) => requested.includes(name)))
      : moving.length <= 3 ? moving : [...moving].sort((a, b) => b.length - a.length).slice(0, 1);
    for (const point of chosen) point.traced = true;
  }
}

/** @param {Point} p @param {Point} q */
export const distance = (p, q) => Math.hypot(...p.map((v, k) => v - q[k]));

/** Lower and upper corner of the box about points. @param {Point[]} cloud @returns {Point[]} */
export const boxOf = (cloud) => [0, 1].map((end) => /** @type {Point} */ (cloud[0].map((_, axis) => (extent([cloud.map((p) => p[axis])]) ?? [0, 0])[end])));

/** Diagonal of the box about points. @param {Point[]} cloud */
export function diagonal(cloud) {
  const [low, high] = boxOf(cloud);
  return distance(low, high) || 1;
}
