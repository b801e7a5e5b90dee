// Spatial structures as they are drawn: places of nodes and members, and what lies under the pointer.

/** @import { Page } from "./pictures.js" */
/** @import { Vec } from "./space_math.js" */
/** @import { Pixel } from "./space_places.js" */
/** @import { Keys } from "./structure_plan.js" */
/** @import { Document } from "./types.d.ts" */

import { numberOf } from "./space_numbers.js";

/** @typedef {{ name: string, type: string, connect: string[], ends: Vec[] }} Member */
/** Node that can be moved. @typedef {{ keys: Keys, name: string, kind: "node", at: Vec }} SpaceHandle */
/** What a support or a load acts on; a node of a mesh of solids has no rotations. @typedef {{ kind: "node" | "element", name: string, fields: Record<string, unknown>, spots: Vec[], solid?: boolean }} SpaceTarget */

/** Distance of pixels at which nodes count as lying behind each other [px]. */
const SAME = 4;
/** Name of a node of a mesh in the picture. */
const OF_MESH = /^(.+)_nodes\[\d+\]$/;

export class SpacePlan {
  /** @param {Document} document @param {Page | null} page whose mesh has the places that are formulas */
  constructor(document, page) {
    this.document = document;
    this.isPlanar = false;
    /** A region of a spatial structure is a mesh of the text. */
    this.regions = [];
    const mesh = page?.motion.mesh;
    /** @type {Map<string, Vec>} */
    this.nodes = new Map();
    for (const [name, entry] of Object.entries(document.nodes ?? {})) {
      const values = Array.isArray(entry) ? entry.map((part) => numberOf(part, document)) : [], k = mesh?.nodes.indexOf(name) ?? -1;
      const at = values.length === 3 && values.every((value) => value !== null) ? /** @type {Vec} */ (values) : k >= 0 ? [0, 1, 2].map((i) => mesh.rest[3 * k + i]) : null;
      if (at) this.nodes.set(name, at);
    }
    /** Nodes of meshes, which have no names in the file. @type {{ mesh: string, at: Vec }[]} */
    this.solidNodes = (mesh?.nodes ?? []).flatMap((/** @type {string} */ name, /** @type {number} */ k) => {
      const owner = OF_MESH.exec(name)?.[1];
      return owner !== undefined && document.meshes?.[owner] ? [{ mesh: owner, at: [0, 1, 2].map((i) => Number(mesh.rest[3 * k + i].toPrecision(6))) }] : [];
    });
    /** @type {SpaceHandle[]} */
    this.handles = [...this.nodes].map(([name, at]) => ({ keys: ["nodes", name], name, kind: "node", at }));
    /** @type {Member[]} */
    this.bars = Object.entries(document.elements ?? {}).flatMap(([name, { type, connect }]) => {
      const ends = Array.isArray(connect) ? connect.map((node) => this.nodes.get(node)) : [];
      return ends.length && ends.every((end) => end) ? [{ name, type, connect, ends: /** @type {Vec[]} */ (ends) }] : [];
    });
  }

  /** Whether the nodes of a file are spatial: by their coordinates, its dimension, gravity or solid meshes. @param {Document} document */
  static isSpatial(document) {
    const { gravity, dimension } = /** @type {any} */ (document), nodes = Object.values(document.nodes ?? {});
    if (nodes.length) return nodes.every((entry) => Array.isArray(entry) && entry.length === 3);
    const solid = Object.values(document.meshes ?? {}).some((mesh) => mesh?.box || /^(Hexa|Tetra)hedron/.test(mesh?.type ?? ""));
    return dimension === 3 || (Array.isArray(gravity) && gravity.length === 3) || solid;
  }

  /** The drawing as a page for `space_places.js`: nodes are named points. @param {Page} page @returns {Page} */
  asPage({ scene, player }) {
    const points = this.handles.map(({ name, at }) => ({ name, point: at, body: { name } }));
    return { scene, player, motion: { points, joints: [], at: (/** @type {unknown} */ _, /** @type {Vec} */ p) => p } };
  }

  /** Node at a place. @param {Vec} at */
  nodeAt(at) {
    const size = Math.max(1e-9, ...[...this.nodes.values()].flat().map(Math.abs));
    return [...this.nodes].find(([, p]) => Math.hypot(...p.map((v, k) => v - at[k])) < 1e-7 * size)?.[0] ?? null;
  }

  /** A node as a target. @param {string} name @returns {SpaceTarget | null} */
  targetOf(name) {
    const at = this.nodes.get(name);
    return at ? { kind: "node", name, fields: { nodes: name }, spots: [at] } : null;
  }

  /** A node of a mesh as a target. @param {{ mesh: string, at: Vec }} node @returns {SpaceTarget} */
  solidTarget({ mesh, at }) { return { kind: "node", name: `${mesh} at ${at.join(", ")}`, fields: { nodes: mesh, nearest: at }, spots: [at], solid: true }; }

  /** Node at a place. @param {Vec} place @returns {SpaceTarget | null} */
  targetAtPlace(place) {
    const name = this.nodeAt(place), size = Math.max(1e-9, ...this.solidNodes.flatMap(({ at }) => at.map(Math.abs)));
    const solid = name === null ? this.solidNodes.find(({ at }) => Math.hypot(...at.map((v, k) => v - place[k])) < 1e-5 * size) : undefined;
    return name !== null ? this.targetOf(name) : solid ? this.solidTarget(solid) : null;
  }

  /** Node, or with `bars` a member, at a pixel; with `solids` also a node of a mesh. @param {Page} page @param {Pixel} pixel @param {number} reach [px] @param {"nodes" | "bars" | "both"} kinds @param {boolean} [solids] @returns {SpaceTarget | null} */
  targetAt({ scene: { view } }, pixel, reach, kinds, solids = false) {
    const off = (/** @type {Vec} */ at) => { const spot = view.screen(at); return spot ? Math.hypot(spot[0] - pixel[0], spot[1] - pixel[1]) : Infinity; };
    // The nearest to the pixel; of those behind each other, the nearest to the eye.
    const first = (/** @type {any[]} */ nodes) => nodes.map((node) => ({ node, step: Math.round(off(node.at) / SAME) })).filter(({ node }) => off(node.at) < reach).sort((a, b) => a.step - b.step || view.scaleAt(b.node.at) - view.scaleAt(a.node.at))[0]?.node;
    const node = kinds === "bars" ? null : first(this.handles), solid = kinds === "bars" || !solids || node ? null : first(this.solidNodes);
    if (node) return this.targetOf(node.name);
    if (solid) return this.solidTarget(solid);
    const bar = kinds === "nodes" ? null : this.bars.find(({ ends }) => ends.length === 2 && away(pixel, view.screen(ends[0]), view.screen(ends[1])) < reach);
    return bar ? { kind: "element", name: bar.name, fields: { elements: bar.name }, spots: bar.ends } : null;
  }

  /** Size of the drawing [m]. */
  get extent() {
    const all = [...this.nodes.values()];
    return Math.max(0, ...[0, 1, 2].map((k) => Math.max(...all.map((p) => p[k])) - Math.min(...all.map((p) => p[k]))).filter(Number.isFinite));
  }
}

/** Distance of a pixel from a segment. @param {Pixel} p @param {Pixel | null} a @param {Pixel | null} b */
function away(p, a, b) {
  if (!a || !b) return Infinity;
  const [u, v] = [b[0] - a[0], b[1] - a[1]], along = Math.min(1, Math.max(0, ((p[0] - a[0]) * u + (p[1] - a[1]) * v) / (u * u + v * v || 1)));
  return Math.hypot(a[0] + along * u - p[0], a[1] + along * v - p[1]);
}
