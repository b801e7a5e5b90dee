// Structures as they are drawn: places of nodes, bars, outlines and holes of regions.

/** @import { Page } from "./pictures.js" */
/** @import { Document } from "./types.d.ts" */

import { numberOf } from "./space_numbers.js";
import { SpacePlan } from "./space_plan.js";
import { rounded } from "./snapping.js";

/** @typedef {[number, number]} Spot */
/** @typedef {(string | number)[]} Keys */
/** Place that can be dragged: the keys of its coordinates, or of a radius about `of`.
 * @typedef {{ keys: Keys, name: string, kind: "node" | "vertex" | "radius", at: Spot, of?: Spot }} Handle */
/** Closed loop of a region: a circle where it has a radius; names of its edges.
 * @typedef {{ spots: Spot[], edges: string[], center?: Spot, radius?: number }} Loop */
/** @typedef {{ name: string, type: string, connect: string[], ends: Spot[] }} Bar */
/** @typedef {{ name: string, loops: Loop[] }} Region */
/** What a support or a load acts on: a selection of nodes of the file, and where it is shown.
 * @typedef {{ kind: "node" | "edge" | "element", name: string, fields: Record<string, unknown>, spots: Spot[] }} Target */

/** Corners of a polygon that stands for a circle. */
const ROUND = 48;

export class Plan {
  /** @param {Document} document @param {Page | null} page whose mesh has the places that are formulas */
  constructor(document, page) {
    this.document = document;
    const mesh = page?.motion.mesh;
    const pair = (/** @type {unknown} */ entry) => {
      const values = Array.isArray(entry) && entry.length === 2 ? entry.map((part) => numberOf(part, document)) : [null];
      return values.every((value) => value !== null) ? /** @type {Spot} */ (values) : null;
    };
    /** @type {Map<string, Spot>} */
    this.nodes = new Map();
    /** Whether all nodes lie in the plane; a structure without nodes may be spatial. */
    this.isPlanar = !SpacePlan.isSpatial(document) && Object.values(document.nodes ?? {}).every((entry) => Array.isArray(entry) && entry.length === 2);
    for (const [name, entry] of Object.entries(document.nodes ?? {})) {
      const k = mesh?.nodes.indexOf(name) ?? -1, at = pair(entry) ?? (k >= 0 ? /** @type {Spot} */ ([mesh.rest[3 * k], mesh.rest[3 * k + 1]]) : null);
      if (at) this.nodes.set(name, at);
    }
    /** @type {Bar[]} */
    this.bars = Object.entries(document.elements ?? {}).flatMap(([name, { type, connect }]) => {
      const ends = Array.isArray(connect) ? connect.map((node) => this.nodes.get(node)) : [];
      return ends.length && ends.every((end) => end) ? [{ name, type, connect, ends: /** @type {Spot[]} */ (ends) }] : [];
    });
    /** @type {Handle[]} */
    this.handles = [...this.nodes].map(([name, at]) => ({ keys: ["nodes", name], name, kind: "node", at }));
    /** @type {Region[]} */
    this.regions = Object.entries(document.meshes ?? {}).flatMap(([name, entry]) => {
      const { polygon, rectangle } = entry ?? {}, keys = ["meshes", name, "polygon"];
      if (rectangle?.size?.length === 2) {
        const [w, h] = rectangle.size;
        return [{ name, loops: [{ spots: [[0, 0], [w, 0], [w, h], [0, h]], edges: ["y = 0", `x = ${w}`, `y = ${h}`, "x = 0"].map((where) => `${name} ${where}`) }] }];
      }
      const spots = this.loop(polygon?.vertices, [...keys, "vertices"], pair, (k) => `${name}.vertex${k + 1}`);
      if (!spots) return [];
      const holes = (polygon.holes ?? []).flatMap((/** @type {any} */ hole, /** @type {number} */ k) => this.hole(hole, [...keys, "holes", k], pair, `${name}.hole${k + 1}`));
      return [{ name, loops: [{ spots, edges: spots.map((_, k) => `${name}.edge${k + 1}`) }, ...holes] }];
    });
  }

  /** @param {any} places @param {Keys} keys @param {(entry: unknown) => Spot | null} pair @param {(k: number) => string} name @returns {Spot[] | null} */
  loop(places, keys, pair, name) {
    const spots = Array.isArray(places) ? places.map(pair) : [null];
    if (!spots.every((spot) => spot)) return null;
    spots.forEach((at, k) => this.handles.push({ keys: [...keys, k], name: name(k), kind: "vertex", at: /** @type {Spot} */ (at) }));
    return /** @type {Spot[]} */ (spots);
  }

  /** @param {any} hole @param {Keys} keys @param {(entry: unknown) => Spot | null} pair @param {string} name @returns {Loop[]} */
  hole(hole, keys, pair, name) {
    if (Array.isArray(hole)) {
      const spots = this.loop(hole, keys, pair, (k) => `${name} vertex ${k + 1}`);
      return spots ? [{ spots, edges: spots.map(() => name) }] : [];
    }
    const center = pair(hole?.center), radius = numberOf(hole?.radius, this.document);
    if (!center || !(radius !== null && radius > 0)) return [];
    this.handles.push({ keys: [...keys, "center"], name: `${name} centre`, kind: "vertex", at: center }, { keys: [...keys, "radius"], name: `${name} radius`, kind: "radius", at: [center[0] + radius, center[1]], of: center });
    return [{ center, radius, spots: circle(center, radius), edges: [name] }];
  }

  /** The drawing as a page for `snapping.js`: nodes and vertices are points, bars and outlines bodies. @param {Page} page @returns {Page} */
  asPage({ scene, player }) {
    const points = this.handles.filter(({ kind }) => kind !== "radius").map(({ name, at }) => ({ name, point: at, body: { name } }));
    const bodies = [...this.bars.filter(({ ends }) => ends.length === 2).map(({ name, ends: [from, to] }) => ({ name, shapes: [{ kind: "bar", from, to }] })), ...this.regions.map(({ name, loops }) => ({ name, shapes: loops.map(({ spots }) => ({ kind: "polygon", points: spots })) }))];
    const motion = { points, bodies, joints: [], links: [], pose: () => ({ x: 0, y: 0, c: 1, s: 0, a: 0 }), placed: (/** @type {unknown} */ _, /** @type {Spot} */ p) => p, outline: (/** @type {any} */ shape) => shape.points ?? [shape.from, shape.to] };
    return { scene, player, motion };
  }

  /** Node at a place. @param {Spot} at */
  nodeAt([x, y]) {
    const size = Math.max(1e-9, ...[...this.nodes.values()].flat().map(Math.abs));
    return [...this.nodes].find(([, p]) => Math.hypot(p[0] - x, p[1] - y) < 1e-7 * size)?.[0] ?? null;
  }

  /** What lies at a place, within a distance: a node or vertex, an edge, a bar. @param {Spot} at @param {number} reach [m] @param {boolean} [bars] @returns {Target | null} */
  targetAt(at, reach, bars = false) {
    const node = nearest(this.handles.filter(({ kind, name }) => kind === "node" || /\.vertex\d+$/.test(name)), (handle) => Math.hypot(handle.at[0] - at[0], handle.at[1] - at[1]), reach);
    if (node) return { kind: "node", name: node.name, fields: { nodes: node.name }, spots: [node.at] };
    const edges = this.regions.flatMap(({ name, loops }) => loops.flatMap((loop) => loop.spots.map((spot, k) => ({ mesh: name, edge: loop.edges[k] ?? loop.edges[0], ends: [spot, loop.spots[(k + 1) % loop.spots.length]], loop }))));
    const edge = nearest(edges, ({ ends }) => away(at, ends[0], ends[1]), reach);
    if (edge) {
      const [mesh, axis, , value] = edge.edge.split(" "), whole = edge.loop.edges.filter((name) => name === edge.edge).length > 1 || edge.loop.radius;
      return { kind: "edge", name: edge.edge, fields: value ? { nodes: mesh, where: { [axis]: Number(value) } } : { nodes: edge.edge }, spots: whole ? [...edge.loop.spots, edge.loop.spots[0]] : edge.ends };
    }
    const bar = bars ? this.barAt(at, reach) : null;
    return bar && { kind: "element", name: bar.name, fields: { elements: bar.name }, spots: bar.ends };
  }

  /** Bar or region at a place. @param {Spot} at @param {number} reach [m] @returns {Target | null} */
  partAt(at, reach) {
    const bar = this.barAt(at, reach), region = bar ? null : this.regionAt(at), name = bar?.name ?? region?.name;
    return name ? { kind: "element", name, fields: { elements: name }, spots: bar?.ends ?? [...(region?.loops[0].spots ?? []), ...(region?.loops[0].spots.slice(0, 1) ?? [])] } : null;
  }

  /** @param {Spot} at @param {number} reach [m] */
  barAt(at, reach) { return nearest(this.bars, ({ ends }) => Math.min(...ends.slice(1).map((end, k) => away(at, ends[k], end))), reach); }

  /** Region at a place. @param {Spot} at */
  regionAt(at) { return this.regions.find(({ loops: [outline, ...holes] }) => inside(at, outline.spots) && !holes.some(({ spots }) => inside(at, spots))) ?? null; }

  /** Size of the drawing [m]. */
  get extent() {
    const all = [...this.nodes.values(), ...this.regions.flatMap(({ loops }) => loops[0].spots)];
    return Math.max(0, ...[0, 1].map((k) => Math.max(...all.map((p) => p[k])) - Math.min(...all.map((p) => p[k]))).filter(Number.isFinite));
  }
}

/** @template T @param {T[]} items @param {(item: T) => number} distance @param {number} reach @returns {T | null} */
function nearest(items, distance, reach) {
  /** @type {T | null} */
  let found = null;
  let least = reach;
  for (const item of items) {
    const away = distance(item);
    if (away < least) [found, least] = [item, away];
  }
  return found;
}

/** @param {Spot} center @param {number} radius @returns {Spot[]} */
export const circle = ([x, y], radius) => Array.from({ length: ROUND }, (_, k) => [x + radius * Math.cos((2 * Math.PI * k) / ROUND), y + radius * Math.sin((2 * Math.PI * k) / ROUND)]);

/** Distance from a segment. @param {Spot} p @param {Spot} a @param {Spot} b */
function away(p, a, b) {
  const [u, v] = [b[0] - a[0], b[1] - a[1]], along = Math.min(1, Math.max(0, ((p[0] - a[0]) * u + (p[1] - a[1]) * v) / (u * u + v * v || 1)));
  return Math.hypot(a[0] + along * u - p[0], a[1] + along * v - p[1]);
}

/** @param {Spot} p @param {Spot[]} spots */
function inside([x, y], spots) {
  let odd = false;
  spots.forEach(([ax, ay], k) => {
    const [bx, by] = spots[(k + 1) % spots.length];
    if ((ay > y) !== (by > y) && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) odd = !odd;
  });
  return odd;
}

/** Coordinates without the noise of the pointer. @param {Page} page @param {number} v @param {boolean} [fine] */
export const cleaned = ({ scene }, v, fine = false) => rounded(v, (fine ? 100 : 1) * scene.view.s);
