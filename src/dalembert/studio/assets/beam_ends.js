// Ends of flexible beams: a straight beam stays straight and without stress when its ends are moved.

/** @import { Page } from "./pictures.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Spot } from "./ends.js" */

import { isSame, movedReference, ownerOf, placeOfEnd } from "./ends.js";
import { neat } from "./neat.js";
import { angleOf, namedPlaces } from "./snapping.js";

/** Difference up to which a beam is straight, relative to its length [-, rad]. */
const STRAIGHT = 1e-6;

/** @param {number} angle */
const whole = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** A straight beam: place and body of its start, of its other end or of its free tip. @typedef {{ start: Spot, end: Spot, bodies: [string, string | null] }} Straight */

/** Ends of a beam that is straight, with numbers for its length and angles; null of another one. @param {Page} page @param {any} entry @returns {Straight | null} */
export function straightBeam(page, { frame_i: i, frame_j: j, length, angle_i = 0, angle_j = 0, curvature = 0 }) {
  const start = i === undefined ? null : placeOfEnd(page, i);
  if (!start || curvature !== 0 || ![length, angle_i, angle_j].every((value) => typeof value === "number")) return null;
  const angle = angle_i + angleOf(page, ownerOf(i)), tip = { x: start.x + length * Math.cos(angle), y: start.y + length * Math.sin(angle) };
  if (j === undefined) return { start, end: tip, bodies: [ownerOf(i), null] };
  const end = placeOfEnd(page, j), bent = end ? Math.hypot(end.x - tip.x, end.y - tip.y) / length : Infinity;
  if (!end || bent > STRAIGHT || Math.abs(whole(angle - angle_j - angleOf(page, ownerOf(j)))) > STRAIGHT) return null;
  return { start, end, bodies: [ownerOf(i), ownerOf(j)] };
}

/** Lengths and angles of straight beams of which ends or bodies are moved.
 * @param {Page} page @param {Document} document @param {(place: Spot, body: string | null) => Spot | null | undefined} moved new place of an end, if it is moved; a free tip has no body
 * @param {(body: string) => number} angle of a body afterwards [rad] @param {(name: string) => boolean} [which] the beams that may change @returns {Operation[]} */
export function beamLengths(page, document, moved, angle, which = () => true) {
  return Object.entries(document.beams ?? {}).flatMap(([name, entry]) => {
    const beam = which(name) ? straightBeam(page, entry) : null;
    if (!beam) return [];
    const { start, end, bodies } = beam, [from, to] = [moved(start, bodies[0]), moved(end, bodies[1])];
    const turns = bodies.some((body) => body !== null && Math.abs(angle(body) - angleOf(page, body)) > STRAIGHT);
    if (!to && (bodies[1] === null || !(from || turns))) return [];  // a free tip moves with the first body
    const { x, y } = from ?? start, [dx, dy] = [(to ?? end).x - x, (to ?? end).y - y], way = Math.atan2(dy, dx), length = Math.hypot(dx, dy);
    const next = { length, angle_i: way - angle(bodies[0]), ...(bodies[1] !== null && { angle_j: way - angle(bodies[1]) }) };
    return Object.entries(next).flatMap(([key, value]) => (Math.abs(value - (entry[key] ?? 0)) > STRAIGHT * length ? [{ op: "set", keys: ["beams", name, key], value: neat(value) }] : []));
  });
}

/** Ends of the selected beam that are stated by coordinates, or by its length alone, as control points.
 * @param {Page} page @param {Document} document @param {string | null} selected @returns {import("./controls.js").Control[]} */
export function beamControls(page, document, selected) {
  const entry = selected === null ? undefined : document.beams?.[selected], beam = entry && straightBeam(page, entry), named = namedPlaces(page);
  if (!beam || selected === null) return [];
  const ends = /** @type {[string, Spot][]} */ ([["frame_i", beam.start], ["frame_j", beam.end]]).filter(([key]) => entry[key] === undefined || typeof entry[key] === "object");
  return ends.filter(([, place]) => !named.some((other) => isSame(page, place, other))).map(([key, place]) => ({
    ...place, label: `move ${selected}`,
    change: (still, now, to) => {
      const reference = now.beams?.[selected]?.[key], angle = (/** @type {string} */ body) => angleOf(still, body);
      return [...(reference ? movedReference(still, ["beams", selected, key, "at"], reference.body, to) : []), ...beamLengths(still, now, (at) => (isSame(still, at, place) ? to : null), angle, (name) => name === selected)];
    },
  }));
}
