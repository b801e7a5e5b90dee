// Mesh of a structure: positions of its vertices in the states, fields, tables of its nodes.

/** @import { Cursor, Point, Range } from "./types.d.ts" */
/** @import { ItemData, MeshData, Pixel, SceneData, States, Tables } from "./scene_types.d.ts" */

import { Ramp } from "./colours.js";
import { extent, floats, isNum, list } from "./numbers.js";
import { distanceToSegment, inside } from "./polygons.js";
import { unitOf } from "./units.js";

/** Limit of the vertices by which the extent of a mesh is measured. */
const MEASURED = 3000;
/** Limit of elements that are drawn with thick lines, and of nodes that are drawn. */
export const FEW_ELEMENTS = 400;
const FEW_NODES = 60;
/** Opacity of the edges of cells of a size on the canvas [px], and its largest value. @param {number} size */
export const edgeOpacity = (size) => EDGES * Math.min(1, size / 12);
const EDGES = 0.4;
/** Names of strains, whose unit is 1. */
const STRAIN = /strain|^e[xyz]{2}$|^g(xy|yz|zx|xz)$/;

/** Quantity over the elements, or over the vertices, in each state.
 * @typedef {{ name: string, unit: string, values: Float64Array[], atVertices: boolean }} Field */

export class Mesh {
  /** @param {MeshData} data @param {Tables & { states?: States }} tables @param {SceneData} scene */
  constructor(data, tables, scene) {
    const n = list(data.rest).length, states = tables.states;
    this.count = n / 3;
    this.rest = floats(data.rest, n);
    this.moved = list(data.vertex_displacements).map((column) => floats(column, n));
    this.lines = list(data.lines);
    this.faces = list(data.faces);
    this.points = list(data.points);
    this.outline = list(data.outline);
    this.nodes = list(data.nodes);
    this.elements = list(data.elements);
    this.drop = data.drop || 0;
    this.scales = [...list(data.scales)];
    /** Values relative to the largest, for shapes without an absolute scale. */
    this.relative = Boolean(states?.relative);
    this.sequence = list(states?.times).length > 1;
    const names = list(tables.directions), numbers = list(tables.numbers);
    const used = names.filter((_, k) => this.nodes.some((_, node) => numbers[node * names.length + k] >= 0));
    this.directions = used;
    /** Number of each displacement by node and direction; −1 for none. */
    this.numbers = this.nodes.flatMap((_, node) => used.map((name) => numbers[node * names.length + names.indexOf(name)]));
    this.displacements = list(tables.displacements).map((column) => Array.from(column));
    this.reactions = list(tables.reactions);
    const sizes = this.moved.map(magnitudes);
    if (this.relative) this.moved.forEach((_, k) => this.normalise(k, sizes[k].reduce((a, b) => Math.max(a, b), 0)));
    /** @type {Field[]} */
    this.fields = [{ name: this.relative ? "shape" : "displacement", unit: this.unitOf("u"), values: this.moved.map(magnitudes), atVertices: true }];
    for (const { name, values, ...data } of list(scene.fields)) {
      const columns = values.map((column) => floats(column, this.elements.length)), unit = unitOf(data);
      this.fields.push({ name, unit: this.relative ? "1" : unit === "1" && STRAIN.test(name) ? "strain" : unit, values: this.relative ? columns.map(relative) : columns, atVertices: false });
    }
    /** Factor of the automatic scale of the displacements. */
    this.factor = 1;
    /** Field that gives the colours. @type {Field | null} */
    this.field = this.fields.find(({ name }) => (this.relative ? ["shape"] : ["von_mises", "stress", "force"]).includes(name)) ?? this.fields[0];
    this.diagrams = list(scene.diagrams);
    /** Name of the diagram that is drawn. */
    this.diagram = "";
    /** @type {Cursor} */
    this.cursor = { i: 0, f: 0 };
    /** Positions of the vertices in the drawing. */
    this.places = this.rest;
  }

  /** Take over scale and field of another design. @param {Mesh} mesh */
  adopt({ factor, field, diagram, scales }) {
    this.factor = factor;
    if (this.relative) this.scales = [...scales];
    this.diagram = diagram;
    this.field = this.fields.find(({ name }) => name === field?.name) ?? null;
  }

  /** Scale a shape to a largest displacement of one. @param {number} state @param {number} largest */
  normalise(state, largest) {
    if (!(largest > 0)) return;
    this.moved[state] = this.moved[state].map((v) => v / largest);
    this.displacements[state] = this.displacements[state]?.map((v) => (v ?? NaN) / largest);
    this.scales[state] *= largest;
  }

  /** Unit of a displacement or rotation. @param {string} name */
  unitOf(name) { return this.relative ? (name[0] === "r" ? "rad/m" : "") : name[0] === "r" ? "rad" : "m"; }

  // States -------------------------------------------------------------------------------------

  /** Number of the present state. */
  get state() { return this.cursor.i + (this.cursor.f >= 0.5 ? 1 : 0); }

  /** Automatic factor of the displacements of the present state. */
  get automatic() { return this.scales[this.state] || 1; }

  /** Factor of the displacements. */
  get scale() { return this.factor * this.automatic; }

  /** Move to an instant or state. @param {Cursor} cursor @param {number} factor of the displacements */
  update(cursor, factor) {
    this.cursor = cursor;
    this.places = this.placesAt(cursor, factor);
  }

  /** @param {Cursor} cursor @param {number} factor */
  placesAt(cursor, factor) {
    const moved = interpolated(this.moved, cursor), { drop } = this;
    return this.rest.map((v, k) => v + factor * (moved[k] || 0) - (k % 3 === 1 ? drop : 0));
  }

  /** Position of a vertex. @param {number} vertex @param {number} dimension @returns {Point} */
  placeOf(vertex, dimension, places = this.places) { return /** @type {Point} */ (Array.from(places.subarray(3 * vertex, 3 * vertex + dimension))); }

  /** Positions at rest and displaced. @param {Cursor[]} cursors @param {number} dimension @returns {Point[]} */
  cloud(cursors, dimension) {
    const stride = Math.ceil(this.count / MEASURED), some = new Set(stride > 1 ? this.outline : []);
    for (let k = 0; k < this.count; k += stride) some.add(k);
    const positions = [this.rest, ...cursors.filter((_, k) => k % Math.ceil(cursors.length / 12) === 0).map((cursor) => this.placesAt(cursor, this.scale))];
    return positions.flatMap((places) => [...some].map((vertex) => this.placeOf(vertex, dimension, places)));
  }

  /** Nodes that are drawn: elements at nodes, and the ends of few lines. */
  get drawnNodes() {
    const drawn = new Set(this.points.flatMap(({ vertices }) => vertices)), { nodes: { length } } = this;
    for (const { vertices } of length <= FEW_NODES ? this.lines : []) for (const k of vertices) if (k < length) drawn.add(k);
    return drawn;
  }

  /** Number of the drawn faces. */
  get faceCount() { return this.faces.reduce((sum, { elements }) => sum + elements.length, 0); }

  // Values -------------------------------------------------------------------------------------

  /** Values of a field in the present state. @param {Field} field */
  values(field) { return interpolated(field.values, this.cursor); }

  /** Range of a field in the present state, or in a whole sequence; about zero where both signs occur. @param {Field} field @returns {Range} */
  range(field) {
    const [lo, hi] = extent(this.sequence ? field.values : [field.values[this.state] ?? []]) ?? [0, 0];
    if (lo < 0 && hi > 0) return [-Math.max(-lo, hi), Math.max(-lo, hi)];
    if (lo > 0 && lo < 1e-4 * hi) return [0, hi];
    return hi > lo ? [lo, hi] : [lo, lo + (Math.abs(lo) || 1)];
  }

  /** Colours of the present field. */
  ramp() { return this.field && new Ramp(this.range(this.field)); }

  /** Value of an element. @param {Field} field @param {number} element */
  valueOf(field, element) { return field.atVertices ? NaN : this.values(field)[element]; }

  /** Ordinates of the present diagram: the ends of its lines, the values there, the direction across the line. */
  ordinates() {
    const byName = (/** @type {string} */ name) => this.fields.find((field) => field.name === name), ends = this.ends();
    return this.diagrams.filter(({ name }) => name === this.diagram).flatMap(({ start, end, sign, elements, across }) => {
      const [first, last] = [byName(start), byName(end)], [from, to] = [first, last].map((field) => (field ? this.values(field) : null));
      return elements.flatMap((element, k) => {
        const vertices = ends.get(element);
        return vertices && from && to && last ? [{ vertices, values: [sign * from[element], to[element]], unit: last.unit, across: Array.from(across.slice(3 * k, 3 * k + 3)) }] : [];
      });
    });
  }

  /** First and last vertices of the lines of elements. @returns {Map<number, [number, number]>} */
  ends() {
    return new Map(this.lines.flatMap(({ size, vertices, elements }) => elements.map((element, row) => [element, [vertices[row * size], vertices[(row + 1) * size - 1]]])));
  }

  /** Displacements and rotations of a node; null where it has none. @param {number} node */
  components(node) {
    const width = this.directions.length, displacements = this.displacements[this.state] ?? [];
    return this.directions.map((name, k) => {
      const number = this.numbers[node * width + k];
      return number >= 0 ? { name, unit: this.unitOf(name), value: displacements[number] } : null;
    });
  }

  /** Forces and moments of the supported nodes as loads. @returns {ItemData[]} */
  reactionItems() {
    /** @type {Map<string, ItemData>} */
    const items = new Map(), zero = this.moved.map(() => 0), planar = !this.directions.includes("uz");
    for (const { node, name, values } of this.reactions) {
      const item = items.get(node) ?? { name: node, description: "support", symbol: "reaction", node: this.nodes.indexOf(node) };
      const key = name[0] === "f" ? "force" : "moment", axes = planar ? "xy" : "xyz";
      if (planar && key === "moment") item.moment = values;
      else for (const axis of axes) item[`${key}_${axis}`] ??= zero;
      if (!planar || key === "force") item[`${key}_${name[1]}`] = values;
      items.set(node, item);
    }
    return [...items.values()];
  }

  // Under the pointer ----------------------------------------------------------------------------

  /** Node or element at a pixel; `seen` are positions on the canvas and depths of the vertices.
   * @param {Pixel} pixel @param {Float64Array} seen */
  hit(pixel, seen) {
    const face = this.faceAt(pixel, seen), [x, y] = pixel;
    let node = -1, least = 8;
    for (let k = 0; k < this.nodes.length; k++) {
      const away = Math.hypot(seen[3 * k] - x, seen[3 * k + 1] - y);
      if (away < least && (face.corners.includes(k) || seen[3 * k + 2] >= face.depth)) [node, least] = [k, away];
    }
    if (node >= 0) return { kind: /** @type {const} */ ("node"), item: node };
    const element = this.lineAt(pixel, seen) ?? face.element;
    return element === null ? null : { kind: /** @type {const} */ ("element"), item: element };
  }

  /** @param {Pixel} pixel @param {Float64Array} seen */
  lineAt(pixel, seen) {
    /** @type {number | null} */
    let nearest = null;
    let least = 7;
    for (const { size, vertices, elements } of this.lines) elements.forEach((element, row) => {
      for (let k = row * size; k < (row + 1) * size - 1; k++) {
        const away = distanceToSegment(pixel, pixelOf(seen, vertices[k]), pixelOf(seen, vertices[k + 1]));
        if (away < least) [nearest, least] = [element, away];
      }
    });
    return nearest;
  }

  /** The nearest face: its element, vertices and depth. @param {Pixel} pixel @param {Float64Array} seen */
  faceAt(pixel, seen) {
    let face = { element: /** @type {number | null} */ (null), corners: /** @type {number[]} */ ([]), depth: -Infinity };
    for (const { size, vertices, elements } of this.faces) elements.forEach((element, row) => {
      const corners = vertices.slice(row * size, (row + 1) * size);
      const depth = corners.reduce((sum, vertex) => sum + seen[3 * vertex + 2] / size, 0);
      if (depth > face.depth && inside(pixel, corners.map((vertex) => pixelOf(seen, vertex)))) face = { element, corners, depth };
    });
    return face;
  }

  /** Names and values of a node or an element. @param {"node" | "element"} kind @param {number} k */
  describe(kind, k) {
    if (kind === "element") {
      const fields = this.fields.filter((field) => isNum(this.valueOf(field, k))).slice(0, 14);
      return { name: this.elements[k], description: "element", rows: fields.map((field) => ({ name: field.name.replaceAll("_", " "), unit: field.unit, value: this.valueOf(field, k) })) };
    }
    const reactions = this.reactions.filter(({ node }) => node === this.nodes[k]).map(({ name, unit, values }) => ({ name, unit, value: values[this.state] }));
    return { name: this.nodes[k], description: reactions.length ? "support" : "node", rows: [...this.components(k).filter((row) => row !== null), ...reactions] };
  }
}

/** Columns between two states. @param {Float64Array[]} columns @param {Cursor} cursor */
function interpolated(columns, { i, f }) {
  const a = columns[i] ?? new Float64Array(0), b = columns[i + 1];
  return f > 0 && b ? a.map((v, k) => v + f * (b[k] - v)) : a;
}

/** Lengths of vectors. @param {Float64Array} m */
const magnitudes = (m) => Float64Array.from({ length: m.length / 3 }, (_, k) => Math.hypot(m[3 * k], m[3 * k + 1], m[3 * k + 2]));

/** Values relative to the largest one. @param {Float64Array} values */
function relative(values) {
  const largest = values.reduce((size, v) => (isNum(v) ? Math.max(size, Math.abs(v)) : size), 0);
  return largest > 0 ? values.map((v) => v / largest) : values;
}

/** @param {Float64Array} seen @param {number} vertex @returns {Pixel} */
const pixelOf = (seen, vertex) => [seen[3 * vertex], seen[3 * vertex + 1]];
