// Ends of elements that are coordinates in the file: handles of the selected element; lengths of links whose ends are moved.

/** @import { Page } from "./pictures.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { inBody, namedPlaces } from "./snapping.js";

/** Sections of elements with ends. */
const SECTIONS = ["joints", "forces", "drivers"];

/** @typedef {(string | number)[]} Keys */
/** @typedef {{ x: number, y: number }} Spot */
/** Ends at one place: keys of their coordinates, and their bodies. @typedef {Spot & { name: string, ends: { keys: Keys, body: string }[] }} End */

/** Whether two places are the same on the screen. @param {Page} page @param {Spot} p @param {Spot} q */
export const isSame = (page, p, q) => Math.hypot(p.x - q.x, p.y - q.y) * page.scene.view.s <= 1;

/** Place of a reference; null if it is a formula, or not in the picture. @param {Page} page @param {any} reference @returns {Spot | null} */
export function placeOfEnd(page, reference) {
  if (typeof reference === "string" && !reference.includes(".")) return placeOfEnd(page, { body: reference, at: [0, 0] });
  if (typeof reference === "string") return namedPlaces(page).find(({ names }) => names.includes(reference)) ?? null;
  const { motion } = page, at = reference?.at, body = reference?.body === "ground" ? motion.ground : motion.bodies.find((/** @type {any} */ { name }) => name === reference?.body), pose = body && motion.pose(body);
  if (!pose || !Array.isArray(at) || !at.every((value) => typeof value === "number")) return null;
  const [x, y] = motion.placed(pose, at);
  return { x, y };
}

/** Body of a reference. @param {any} reference @returns {string} */
export const ownerOf = (reference) => (typeof reference === "string" ? reference.split(".")[0] : reference.body);

/** Ends of the selected element that are stated by coordinates, at places without a named point: those with one are dragged by it.
 * @param {Page} page @param {Document} document @param {string | null} selected @returns {End[]} */
export function endsOf(page, document, selected) {
  const section = selected === null ? undefined : SECTIONS.find((name) => document[name]?.[selected]);
  if (!section || selected === null) return [];
  const entry = document[section]?.[selected], named = namedPlaces(page);
  /** @type {End[]} */
  const places = [];
  for (const list of ["connect", "points"]) for (const [k, reference] of Array.isArray(entry[list]) ? entry[list].entries() : []) {
    const place = typeof reference === "object" ? placeOfEnd(page, reference) : null;
    if (!place || named.some((other) => isSame(page, place, other))) continue;
    const end = { keys: [section, selected, list, k, "at"], body: reference.body }, same = places.find((other) => isSame(page, place, other));
    if (same) same.ends.push(end);
    else places.push({ ...place, name: selected, ends: [end] });
  }
  return places;
}

/** Coordinates in the axes of a body or the ground. @param {Page} page @param {string} body @param {Spot} to */
const coordinates = (page, body, { x, y }) => (body === "ground" ? [x, y] : inBody(page, body, x, y))?.map(neat);

/** Operation that moves the coordinates of a reference. @param {Page} page @param {Keys} keys @param {string} body @param {Spot} to @returns {Operation[]} */
export const movedReference = (page, keys, body, to) => [{ op: "set", keys, value: coordinates(page, body, to) }];

/** Operations that move ends to another place. @param {Page} page @param {Document} document @param {End} end @param {Spot} to @returns {Operation[]} */
export function movedEnd(page, document, end, to) {
  const operations = end.ends.flatMap(({ keys, body }) => movedReference(page, keys, body, to));
  return [...operations, ...linkLengths(page, document, (place) => (isSame(page, end, place) ? to : null), (name) => name === end.name)];
}

/** New lengths of massless links of which ends are moved; formulas stay.
 * @param {Page} page @param {Document} document @param {(place: Spot, body: string) => Spot | null | undefined} moved new place of an end, if it is moved
 * @param {(name: string) => boolean} [which] the links that may change @returns {Operation[]} */
export function linkLengths(page, document, moved, which = () => true) {
  return Object.entries(document.joints ?? {}).flatMap(([name, { type, connect, length }]) => {
    if (type !== "RigidLink" || typeof length !== "number" || !Array.isArray(connect) || !which(name)) return [];
    const now = connect.map((end) => placeOfEnd(page, end));
    const next = now.map((place, k) => place && (moved(place, ownerOf(connect[k])) ?? place)), [p, q] = next;
    if (!p || !q || next.every((place, k) => place === now[k])) return [];
    return [{ op: "set", keys: ["joints", name, "length"], value: neat(Math.hypot(q.x - p.x, q.y - p.y)) }];
  });
}
