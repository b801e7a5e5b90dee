// Changes of the model file for what is drawn, see `studio/drawing_edits.py`.

/** @import { Place } from "./snapping.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Document } from "./types.d.ts" */

import { beamLengths } from "./beam_ends.js";
import { isSame, linkLengths } from "./ends.js";
import { gearRadii } from "./gear_radii.js";
import { neat } from "./neat.js";
import { angleOf, inBody, namedPlaces, onOutline, placeOf } from "./snapping.js";

/** Mass of a new bar per length [kg/m], and of a new plate per area [kg/m²]. */
const BAR = 1, PLATE = 10;
/** Stiffness of a new spring [N/m], magnitude of a new force [N], time of a turn of a new motor [s]. */
const STIFFNESS = 200, FORCE = 10, TURN = 2;

/** @typedef {Record<string, unknown>} Operation */
/** @typedef {{ label: string, operations: Operation[] }} Change */

/** Reference to a place: a point with a name, a point of a body, or a point of the ground. @param {Place} place @param {string | null} [body] */
export function reference({ x, y, names, local }, body = null) {
  if (names.length) return names[0];
  if (body && local) return { body, at: local.map(neat) };
  return { body: "ground", at: [neat(x), neat(y)] };
}

/** @param {Place} place @param {string} end @returns {Operation[]} */
const pinnedTo = (place, end) => (place.names.length || place.body ? [{ op: "add", section: "joints", base: "", fields: { type: "Revolute", connect: [reference(place, place.body), end] } }] : []);

/** @param {Place} from @param {Place} to @returns {Change | null} */
export function bar(from, to) {
  const [dx, dy] = [to.x - from.x, to.y - from.y], length = Math.hypot(dx, dy);
  if (!(length > 0)) return null;
  const fields = { type: "Bar", length: neat(length), mass: neat(BAR * Number(length.toPrecision(3))), position: [neat((from.x + to.x) / 2), neat((from.y + to.y) / 2)], angle: neat(Math.atan2(dy, dx)) };
  return { label: "add bar", operations: [{ op: "add", section: "bodies", base: "bar", as: "$bar", fields }, ...pinnedTo(from, "$bar.start"), ...pinnedTo(to, "$bar.end")] };
}

/** Area, centroid and second moment of area about it. @param {Place[]} corners */
function areaOf(corners) {
  let [area, cx, cy, polar] = [0, 0, 0, 0];
  corners.forEach((p, k) => {
    const q = corners[(k + 1) % corners.length], cross = p.x * q.y - q.x * p.y;
    area += cross / 2;
    cx += ((p.x + q.x) * cross) / 6;
    cy += ((p.y + q.y) * cross) / 6;
    polar += ((p.x ** 2 + p.x * q.x + q.x ** 2 + p.y ** 2 + p.y * q.y + q.y ** 2) * cross) / 12;
  });
  const [x, y] = [cx / area, cy / area];
  return { area: Math.abs(area), x, y, polar: Math.abs(polar - area * (x * x + y * y)) };
}

/** @param {Place[]} corners @returns {Change | null} */
export function plate(corners) {
  const { area, x, y, polar } = areaOf(corners);
  if (corners.length < 3 || !(area > 0)) return null;
  const points = Object.fromEntries(corners.map((corner, k) => [`P${k + 1}`, [neat(corner.x - x), neat(corner.y - y)]]));
  const fields = { type: "Body", mass: neat(PLATE * area), inertia: neat(PLATE * polar), position: [neat(x), neat(y)], angle: 0, points };
  return { label: "add plate", operations: [{ op: "add", section: "bodies", base: "plate", as: "$plate", fields }, ...corners.flatMap((corner, k) => pinnedTo(corner, `$plate.P${k + 1}`))] };
}

/** Pin of two bodies, also where they cross, or of one to the ground. @param {Page} page @param {Place} place @returns {Change | null} */
export function pin(page, place) {
  if (!place.body) return null;
  const others = place.names.filter((name) => name.split(".")[0] !== place.body), own = reference(place, place.body), crossing = place.names.length ? null : onOutline(page, place.x, place.y, place.body);
  const other = others.length && !place.joint ? others[0] : crossing?.body && page.motion.byName.get(crossing.body) ? { body: crossing.body, at: (inBody(page, crossing.body, place.x, place.y) ?? [0, 0]).map(neat) } : null;
  const connect = other ? [own, other] : [{ body: "ground", at: [neat(place.x), neat(place.y)] }, own];
  return { label: "add pin", operations: [{ op: "add", section: "joints", base: "", fields: { type: "Revolute", connect } }] };
}

/** Pin in a slot of the ground. @param {Place} place @param {Place} toward @returns {Change | null} */
export function slider(place, toward) {
  const [dx, dy] = [toward.x - place.x, toward.y - place.y], length = Math.hypot(dx, dy);
  if (!place.body || !(length > 0)) return null;
  const fields = { type: "PinInSlot", connect: [{ body: "ground", at: [neat(place.x), neat(place.y)] }, reference(place, place.body)], axis: [neat(dx / length), neat(dy / length)] };
  return { label: "add slider", operations: [{ op: "add", section: "joints", base: "slot", fields }] };
}

/** @param {Place} from @param {Place} to @returns {Change | null} */
export function spring(from, to) {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0) || !(from.body || to.body)) return null;
  const fields = { type: "Spring", connect: [reference(from, from.body), reference(to, to.body)], stiffness: STIFFNESS, free_length: neat(length) };
  return { label: "add spring", operations: [{ op: "add", section: "forces", base: "spring", fields }] };
}

/** @param {Place} place @param {Place} toward @returns {Change | null} */
export function force(place, toward) {
  const [dx, dy] = [toward.x - place.x, toward.y - place.y], length = Math.hypot(dx, dy);
  if (!place.body || !(length > 0)) return null;
  const fields = { type: "Force", connect: [reference(place, place.body)], vector: [neat((FORCE * dx) / length), neat((FORCE * dy) / length)] };
  return { label: "add force", operations: [{ op: "add", section: "forces", base: "force", fields }] };
}

/** Bodies of a joint, and the angle of the second relative to the first. @param {Page} page @param {any} joint @returns {{ bodies: string[], angle: number }} */
export function bodiesAt(page, joint) {
  const bodies = /** @type {any[]} */ (joint.connect).map((end) => (typeof end === "string" ? end.split(".")[0] : end.body));
  return { bodies, angle: neat(angleOf(page, bodies[1]) - angleOf(page, bodies[0])) };
}

/** Motor at a joint. @param {Place} place @param {Page} page @param {Document} document @returns {Change | null} */
export function motor(place, page, document) {
  const joint = place.joint === null ? null : document.joints?.[place.joint];
  if (!joint) return null;
  const { bodies, angle: phase } = bodiesAt(page, joint);
  const fields = { type: "RotationalDriver", connect: bodies, law: `${phase} + 2*pi*t/${TURN}` };
  return { label: "add motor", operations: [{ op: "add", section: "drivers", base: "motor", fields }] };
}

/** Move the points of a place, with bars and plates that end there. @param {Page} page @param {Document} document @param {Place} place @param {{ x: number, y: number }} to @returns {Change | null} */
export function move(page, document, place, to) {
  const operations = movedPoints(page, document, [{ from: place, to }]);
  return operations.length ? { label: `move ${place.names[0]}`, operations } : null;
}

/** Points in other places, with the joints there. @param {Page} page @param {Document} document
 * @param {{ from: { x: number, y: number, names: string[] }, to: { x: number, y: number } }[]} moves @param {Set<string>} [done] joints that are moved already @returns {Operation[]} */
export function movedPoints(page, document, moves, done = new Set()) {
  const { motion, scene } = page;
  /** @type {Operation[]} */
  const operations = [], set = (/** @type {(string | number)[]} */ keys, /** @type {unknown} */ value) => operations.push({ op: "set", keys, value });
  /** New ends of bars. @type {Map<string, Record<string, { x: number, y: number }>>} */
  const bars = new Map();
  for (const { from: { names }, to } of moves) for (const name of names) {
    const [body, ...rest] = name.split("."), point = rest.join("."), entry = document.bodies?.[body];
    if (!entry) continue;
    if (entry.type === "Bar" && (point === "start" || point === "end")) bars.set(body, { ...bars.get(body), [point]: to });
    else if (entry.points && point in entry.points) set(["bodies", body, "points", point], inBody(page, body, to.x, to.y)?.map(neat));
    else if (entry.type === "Particle" && "position" in entry) set(["bodies", body, "position"], [neat(to.x), neat(to.y)]);
  }
  for (const [body, { start = otherEnd(page, body, "end"), end = otherEnd(page, body, "start") }] of bars) {
    if (!start || !end) continue;
    set(["bodies", body, "length"], neat(Math.hypot(end.x - start.x, end.y - start.y)));
    set(["bodies", body, "angle"], neat(Math.atan2(end.y - start.y, end.x - start.x)));
    if ("position" in (document.bodies?.[body] ?? {})) set(["bodies", body, "position"], [neat((start.x + end.x) / 2), neat((start.y + end.y) / 2)]);
  }
  for (const [name, joint] of Object.entries(document.joints ?? {})) {
    const item = motion.joints.find((/** @type {any} */ part) => part.name === name), at = item && placeOf(page, item);
    const to = at && !done.has(name) && moves.find(({ from }) => Math.hypot(at[0] - from.x, at[1] - from.y) * scene.view.s <= 1)?.to;
    if (!to) continue;
    /** @type {any[]} */ (joint.connect ?? []).forEach((end, k) => {
      if (typeof end === "object" && end.body === "ground") set(["joints", name, "connect", k, "at"], [neat(to.x), neat(to.y)]);
      else if (typeof end === "object") set(["joints", name, "connect", k, "at"], inBody(page, end.body, to.x, to.y)?.map(neat));
      else if (end.startsWith("ground.") && document.ground?.points?.[end.slice(7)]) set(["ground", "points", end.slice(7)], [neat(to.x), neat(to.y)]);
    });
  }
  const next = (/** @type {{ x: number, y: number }} */ place) => moves.find(({ from }) => isSame(page, from, place))?.to;
  return [...operations, ...linkLengths(page, document, next), ...gearRadii(page, document, next, (name) => !done.has(name)), ...beamLengths(page, document, next, anglesAfter(page, operations), (name) => !done.has(name))];
}

/** World coordinates of the other end of a bar. @param {Page} page @param {string} body @param {string} point */
export function otherEnd(page, body, point) {
  const name = `${body}.${point === "start" ? "end" : "start"}`, place = namedPlaces(page).find(({ names }) => names.includes(name));
  return place ? { x: place.x, y: place.y } : null;
}

/** Angles of bodies after operations. @param {Page} page @param {Operation[]} operations @returns {(body: string) => number} */
export function anglesAfter(page, operations) {
  const stated = new Map(operations.flatMap(({ keys, value }) => (Array.isArray(keys) && keys[0] === "bodies" && keys[2] === "angle" && typeof value === "number" ? [[String(keys[1]), value]] : [])));
  return (body) => stated.get(body) ?? angleOf(page, body);
}
