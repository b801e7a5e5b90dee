// Selected elements, and what belongs to them.

/** @import { Page } from "./pictures.js" */
/** @import { Document } from "./types.d.ts" */

import { elementPlaces } from "./snapping.js";
import { bodiesOf, references } from "./transforms.js";

/** Sections of what the drawing shows. */
export const SECTIONS = ["bodies", "beams", "joints", "drivers", "forces"];

/** Names of all elements that the drawing shows. @param {Document | null} document */
export const namesIn = (document) => SECTIONS.flatMap((section) => Object.keys(document?.[section] ?? {}));

/** Section of an element. @param {Document} document @param {string} name */
export const sectionOf = (document, name) => SECTIONS.find((section) => document[section]?.[name] !== undefined) ?? null;

/** Bodies among the selected names. @param {Document} document @param {Iterable<string>} names */
export const bodiesAmong = (document, names) => [...names].filter((name) => document.bodies?.[name] !== undefined);

/** Selected bodies with the elements between them and the ground.
 * @param {Document} document @param {Iterable<string>} selected @returns {{ section: string, name: string, entry: Record<string, any> }[]} */
export function group(document, selected) {
  const chosen = new Set(bodiesAmong(document, selected)), all = new Set(Object.keys(document.bodies ?? {}));
  const parts = [...chosen].map((name) => ({ section: "bodies", name, entry: document.bodies?.[name] }));
  const rows = ["joints", "beams", "drivers", "forces"].flatMap((section) => Object.entries(document[section] ?? {}).map(([name, entry]) => ({ section, name, entry })));
  const elements = new Set(rows.map(({ name }) => name));
  for (const row of rows) {
    const others = references(row.entry, (name) => all.has(name) || elements.has(name));
    const bodies = [...others, ...bodiesOf(document, row.entry)].filter((name) => all.has(name)), rest = [...others].filter((name) => elements.has(name));
    if (bodies.length && bodies.every((name) => chosen.has(name)) && rest.every((name) => parts.some((part) => part.name === name))) parts.push(row);
  }
  return parts;
}

/** Elements within a rectangle of the plane: bodies and links as wholes, others by their places.
 * @param {Page} page @param {Document} document @param {{ x: number, y: number }} p @param {{ x: number, y: number }} q */
export function within(page, document, p, q) {
  const inside = (/** @type {number[]} */ [x, y]) => (x - p.x) * (x - q.x) <= 0 && (y - p.y) * (y - q.y) <= 0;
  return elementPlaces(page).filter(({ name, places }) => sectionOf(document, name) && places.length && places.every(inside)).map(({ name }) => name);
}

/** Middle and size of the places of elements. @param {Page} page @param {Iterable<string>} names */
export function bounds(page, names) {
  const chosen = new Set(names), places = elementPlaces(page).filter(({ name }) => chosen.has(name)).flatMap((item) => item.places);
  if (!places.length) return null;
  const [xs, ys] = [0, 1].map((axis) => places.map((place) => place[axis]));
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  return { x: (x0 + x1) / 2, y: (y0 + y1) / 2, x0, x1, y0, y1 };
}
