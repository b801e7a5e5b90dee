// Shapes of contacts: those of mirrored bodies, and those on the ground that are moved with their element.

/** @import { Transform } from "./transforms.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { applied, flipped, turned } from "./transforms.js";

/** @typedef {Record<string, any>} Entry */

/** Body of a shape. @param {any} shape a point, or a table */
function bodyOf(shape) {
  const end = typeof shape === "string" ? shape : shape?.body ?? shape?.point ?? shape?.point_i;
  return typeof end === "string" ? end.split(".")[0] : end?.body;
}

/** Elements of contacts after a map of some bodies. @param {Document} document @param {Transform} map @param {Set<string>} bodies @param {Set<string>} chosen elements whose shapes on the ground are mapped too @returns {{ name: string, entry: Entry, next: Entry }[]} */
export function mappedContacts(document, map, bodies, chosen) {
  return Object.entries(document.forces ?? {}).filter(([, { type }]) => type === "Contact" || type === "Collisions").map(([name, entry]) => {
    const image = (/** @type {any} */ shape) => {
      const body = bodyOf(shape);
      if (body === "ground" && chosen.has(name)) return onGround(name, document, map, shape);
      return map.mirrored && bodies.has(body) ? mirrored(name, shape) : shape;
    };
    const next = { ...entry };
    for (const key of ["shape_i", "shape_j"]) if (entry[key] !== undefined) next[key] = image(entry[key]);
    if (Array.isArray(entry.shapes)) next.shapes = entry.shapes.map(image);
    else if (entry.shapes) next.shapes = Object.fromEntries(Object.entries(entry.shapes).map(([group, shapes]) => [group, shapes.map(image)]));
    return { name, entry, next };
  });
}

/** A shape with other places, directions, and order of its corners. @param {string} name of the element @param {any} shape @param {boolean} reversed @param {(end: any) => any} end @param {(at: any) => any} place @param {(vector: any) => any} direction */
function replaced(name, shape, reversed, end, place, direction) {
  if (typeof shape === "string" || "at" in shape) return end(shape);
  const next = { ...shape }, list = (/** @type {any[]} */ places) => (reversed ? places.map(place).reverse() : places.map(place));
  for (const key of ["point", "point_i", "point_j"]) if (shape[key] !== undefined) next[key] = end(shape[key]);
  if (shape.type === "HalfPlane") next.normal = direction(shape.normal ?? [0, 1]);
  if (shape.vertices) next.vertices = list(shape.vertices);
  if (shape.curve && !Array.isArray(shape.curve.points)) throw new Error(`${name}: this curve is mapped in the text`);
  if (shape.curve) next.curve = { ...shape.curve, points: list(shape.curve.points) };
  return next;
}

/** A shape of a mirrored body, in the axes of the body. @param {string} name @param {any} shape */
const mirrored = (name, shape) => replaced(name, shape, true, (end) => (typeof end === "string" ? end : { ...end, at: flipped(end.at) }), flipped, flipped);

/** A shape on the ground. @param {string} name @param {Document} document @param {Transform} map @param {any} shape */
function onGround(name, document, map, shape) {
  if (["Rectangle", "Sprocket"].includes(shape.type) && neat(Math.sin(map.turn)) !== 0) throw new Error(`${name}: a ${shape.type.toLowerCase()} on the ground is rotated in the text`);
  const place = (/** @type {any} */ at) => {
    if (!at || at.some((/** @type {any} */ value) => typeof value !== "number")) throw new Error(`${name}: its place on the ground is a formula; change it in the text`);
    return applied(map, at).map(neat);
  };
  const end = (/** @type {any} */ old) => {
    const point = typeof old === "string" ? old.split(".")[1] : null;
    return { body: "ground", at: place(typeof old === "object" ? old.at : point && point !== "center" ? document.ground?.points?.[point] : [0, 0]) };
  };
  return replaced(name, shape, map.mirrored, end, place, (vector) => turned(map, vector));
}
