// Spatial structures as they are drawn: places of nodes and members, and what lies under the pointer.

/** @import { Page } from "./pictures.js" */
/** @import { Vec } from "./space_math.js" */
/** @import { Pixel } from "./space_places.js" */
/** @import { Keys } from "./structure_plan.js" */
/** @import { Document } from "./types.d.ts" */

import { numberOf } from "./space_numbers.js";

/** @typedef {{ name: string, type: string, connect: string[], ends: Vec[] }} Member */
/** Node that can be moved. @typedef {{ keys: Keys, name: string, kind: "node", at: Vec }} SpaceHandle */
/** What a support or a load acts on. @typedef {{ kind: "node" | "element", name: string, fields: Record<string, unknown>, spots: Vec[] }} SpaceTarget */

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

  /** A node as a target. @param {string | null} name @returns {SpaceTarget | null} */
  targetOf(name) {
    const at = name === null ? undefined : this.nodes.get(name);
    return at && name !== null ? { kind: "node", name, fields: { nodes: name }, spots: [at] } : null;
  }

  /** Node, or with `bars` a member, at a pixel. @param {Page} page @param {Pixel} pixel @param {number} reach [px] @param {"nodes" | "bars" | "both"} kinds @returns {SpaceTarget | null} */
  targetAt({ scene: { view } }, pixel, reach, kinds) {
    const nodes = kinds === "bars" ? [] : this.handles.map(({ name, at }) => ({ name, at, pixel: view.screen(at) })).filter((node) => node.pixel && Math.hypot(node.pixel[0] - pixel[0], node.pixel[1] - pixel[1]) < reach);
    const [node] = nodes.sort((a, b) => view.scaleAt(b.at) - view.scaleAt(a.at));  // the nearer one
    if (node) return this.targetOf(node.name);
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
