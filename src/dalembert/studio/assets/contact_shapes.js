// Shapes of contacts that are drawn: all are in one element Collisions, in groups by the names of their bodies.

/** @import { Change, Operation } from "./operations.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Tool } from "./tools.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { on } from "./new_joints.js";
import { reference } from "./operations.js";
import { inBody } from "./snapping.js";

/** Friction and restitution of a new element. */
const LAW = { friction: 0.3, restitution: 0.2 };

/** Elements Collisions of a document: their names and entries. @param {Document | null} document @returns {[string, any][]} */
export const collisionsIn = (document) => Object.entries(document?.forces ?? {}).filter(([, entry]) => entry?.type === "Collisions");

/** The first of them, which has the shapes that are drawn. @param {Document | null} document @returns {[string, any] | null} */
export const collisionsOf = (document) => collisionsIn(document)[0] ?? null;

/** Groups of shapes by name; a list without groups is one without a name. @param {any} entry @returns {Record<string, any[]>} */
export const groupsOf = (entry) => (Array.isArray(entry?.shapes) ? { "": entry.shapes } : entry?.shapes ?? {});

/** Add a shape to the group of its body. @param {Document} document @param {string | null} body @param {Record<string, unknown>} shape @returns {Change} */
function withShape(document, body, shape) {
  const found = collisionsOf(document), group = body ?? "ground", label = `add ${String(shape.type).toLowerCase()} of contacts`;
  if (!found) return { label, operations: [{ op: "add", section: "forces", base: "collisions", fields: { type: "Collisions", ...LAW, shapes: { [group]: [shape] } } }] };
  const [name, { shapes }] = found;
  /** @type {Operation} */
  const set = Array.isArray(shapes) ? { op: "set list", keys: ["forces", name, "shapes"], value: [...shapes, shape] } : { op: "set list", keys: ["forces", name, "shapes", group], value: [...(shapes?.[group] ?? []), shape] };
  return { label, operations: [set] };
}

/** @param {Document} document @param {Place} center @param {Place} edge @returns {Change | null} */
function circle(document, center, edge) {
  const radius = neat(Math.hypot(edge.x - center.x, edge.y - center.y));
  return radius > 0 ? withShape(document, center.body, { type: "Circle", point: reference(center, center.body), radius }) : null;
}

/** @param {Page} page @param {Document} document @param {Place[]} places @returns {Change | null} */
function capsule(page, document, [from, to, side]) {
  const length = Math.hypot(to.x - from.x, to.y - from.y), radius = neat(Math.abs((to.x - from.x) * (side.y - from.y) - (to.y - from.y) * (side.x - from.x)) / length), { body } = from;
  if (!(length > 0) || !(radius > 0)) return null;
  const end = (/** @type {Place} */ place) => place.names.find((name) => name.split(".")[0] === (body ?? "ground")) ?? on(page, body, place);
  return withShape(document, body, { type: "Capsule", point_i: end(from), point_j: end(to), radius });
}

/** @param {Page} page @param {Document} document @param {Place[]} places @returns {Change | null} */
function polygon(page, document, places) {
  const { body } = places[0], local = places.map((place) => (body ? inBody(page, body, place.x, place.y) ?? [0, 0] : [place.x, place.y]).map(neat));
  if (local.length < 3) return null;
  const turns = local.map((p, k) => { const q = local[(k + 1) % local.length], r = local[(k + 2) % local.length]; return Math.sign((q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0])); });
  if (turns.includes(0) || new Set(turns).size > 1) throw new Error("the corners of a polygon of contacts must be convex; draw a concave shape as several polygons");
  return withShape(document, body, { type: "Polygon", body: body ?? "ground", vertices: turns[0] > 0 ? local : local.reverse() });
}

/** @param {Page} page @param {Document} document @param {Place} at @param {Place} along @returns {Change | null} */
function halfPlane(page, document, at, along) {
  const length = Math.hypot(along.x - at.x, along.y - at.y), normal = [neat(-(along.y - at.y) / length), neat((along.x - at.x) / length)];
  return length > 0 ? withShape(document, null, { type: "HalfPlane", point: on(page, null, at), normal }) : null;
}

/** @param {(page: Page, document: Document, places: Place[]) => Change | null} make @returns {Tool["make"]} */
const using = (make) => (places, { page, document }) => page && document && make(page, document, places);

/** @type {Tool[]} */
export const SHAPE_TOOLS = [
  { name: "circle", key: "D", group: "Contacts", title: "Circle", hint: ["click the centre, on a body or the ground", "click a place on the circle, or type its radius"], clicks: 2, onBody: true, make: using((_, document, [center, edge]) => circle(document, center, edge)) },
  { name: "capsule", key: "K", group: "Contacts", title: "Capsule", hint: ["click the first end of the axis, on a body or the ground", "click its other end", "click a place on its side"], clicks: 3, onBody: true, make: using(capsule) },
  { name: "polygon", key: "Y", group: "Contacts", title: "Polygon", hint: ["click the corners, the first on the body that has the shape; Enter, or a click on the first, closes it"], clicks: 0, onBody: true, make: using(polygon) },
  { name: "halfplane", key: "F", group: "Contacts", title: "Half plane", hint: ["click a place of the surface", "click along the surface, so that bodies are on its left"], clicks: 2, make: using((page, document, [at, along]) => halfPlane(page, document, at, along)) },
];
