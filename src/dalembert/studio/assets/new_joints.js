// Joints and bodies that are drawn: guides, welds, gears, cams, links, masses, points.

/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Change, Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { neat, neatSpot } from "./neat.js";
import { bodiesAt, reference } from "./operations.js";
import { angleOf, inBody } from "./snapping.js";

/** Mass of a new particle [kg]. */
const MASS = 1;
/** Number of control points of a new cam. */
const CONTROLS = 12;
/** Young's modulus, density and poisson's ratio of a new beam (spring steel), and its square cross section [m]. */
const STEEL = { modulus: 210e9, density: 7850, poisson: 0.3 }, SIDE = 2e-3;
/** Lead of the internal forces of a new beam, so that its oscillations decay [s]. */
const DAMPING = 0.01;

/** @param {string} label @param {string} section @param {string} base @param {Record<string, unknown>} fields @returns {Change} */
export const added = (label, section, base, fields) => ({ label: `add ${label}`, operations: [{ op: "add", section, base, fields }] });

/** Direction in the axes of a body. @param {Page} page @param {string | null} body @param {Place} from @param {Place} to */
function axis(page, body, from, to) {
  const length = Math.hypot(to.x - from.x, to.y - from.y), angle = Math.atan2(to.y - from.y, to.x - from.x) - angleOf(page, body);
  return length > 0 ? neatSpot([Math.cos(angle), Math.sin(angle)]) : null;
}

/** Reference to a place on a body, or on the ground if it is none. @param {Page} page @param {string | null} body @param {Place} place */
export const on = (page, body, place) => (body === null ? { body: "ground", at: [neat(place.x), neat(place.y)] } : { body, at: (inBody(page, body, place.x, place.y) ?? [0, 0]).map(neat) });

/** Pin of one body in a slot of another body. @param {Page} page @param {Place[]} places @returns {Change | null} */
export function slot(page, [pin, carrier, toward]) {
  const direction = axis(page, carrier.body, pin, toward);
  if (!pin.body || pin.body === carrier.body || !direction) return null;
  return added("slot", "joints", "slot", { type: "PinInSlot", connect: [on(page, carrier.body, pin), reference(pin, pin.body)], axis: direction });
}

/** Body that slides along another one. @param {Page} page @param {Place[]} places @returns {Change | null} */
export function guide(page, [slides, carrier, toward]) {
  const direction = axis(page, carrier.body, slides, toward);
  if (!slides.body || slides.body === carrier.body || !direction) return null;
  const angle = neat(angleOf(page, slides.body) - angleOf(page, carrier.body));
  return added("guide", "joints", "guide", { type: "Prismatic", connect: [on(page, carrier.body, slides), reference(slides, slides.body)], axis: direction, ...(angle && { angle }) });
}

/** Weld of the bodies at a point, or of one to the ground; a pin of these bodies is replaced. @param {Page} page @param {Document} document @param {Place} place @returns {Change | null} */
export function weld(page, document, place) {
  const pin = document.joints?.[place.joint ?? ""];
  if (pin?.type === "Revolute") {
    const { angle } = bodiesAt(page, pin), fields = { type: "Weld", connect: pin.connect, ...(angle && { angle }) };
    return { label: "weld pin", operations: [{ op: "remove", section: "joints", name: place.joint }, { op: "add", section: "joints", base: "weld", fields }] };
  }
  if (!place.body) return null;
  const other = place.names.find((name) => name.split(".")[0] !== place.body && name.split(".")[0] !== "ground"), first = other?.split(".")[0] ?? null;
  const angle = neat(angleOf(page, place.body) - angleOf(page, first));
  return added("weld", "joints", "weld", { type: "Weld", connect: [other ?? on(page, null, place), reference(place, place.body)], ...(angle && { angle }) });
}

/** Massless link of constant length. @param {Place} from @param {Place} to @returns {Change | null} */
export function link(from, to) {
  const length = neat(Math.hypot(to.x - from.x, to.y - from.y));
  if (!length || from.body === to.body) return null;
  return added("link", "joints", "link", { type: "RigidLink", connect: [reference(from, from.body), reference(to, to.body)], length });
}

/** Gears about two points, whose pitch circles touch on the side of a third one. @param {Place[]} places @returns {Change | null} */
export function gears([first, second, touch]) {
  const distance = Math.hypot(second.x - first.x, second.y - first.y), along = ((touch.x - first.x) * (second.x - first.x) + (touch.y - first.y) * (second.y - first.y)) / distance;
  if (!first.body || !second.body || first.body === second.body || !(distance > 0) || !(along > 0) || along === distance) return null;
  const internal = along > distance, [big, small] = internal ? [along, along - distance] : [along, distance - along];
  const [i, j] = internal ? [second, first] : [first, second], radii = internal ? [small, big] : [big, small];
  return added("gears", "joints", "gears", { type: "GearPair", connect: [reference(i, i.body), reference(j, j.body)], radius_i: neat(radii[0]), radius_j: neat(radii[1]), ...(internal && { internal }) });
}

/** Pinion about a point on a rack through a second one. @param {Page} page @param {Place[]} places @returns {Change | null} */
export function rack(page, [pinion, line, toward]) {
  const direction = axis(page, line.body, line, toward), length = Math.hypot(toward.x - line.x, toward.y - line.y);
  const height = ((toward.x - line.x) * (pinion.y - line.y) - (toward.y - line.y) * (pinion.x - line.x)) / length;
  if (!pinion.body || pinion.body === line.body || !direction || !(Math.abs(height) > 0)) return null;
  return added("rack", "joints", "rack", { type: "RackAndPinion", connect: [on(page, line.body, line), reference(pinion, pinion.body)], axis: direction, radius: neat(Math.abs(height)), side: height > 0 ? 1 : -1 });
}

/** Cam about a point of a body: at first a circle through the follower; its control points are dragged. @param {Page} page @param {Place} center @param {Place} follower @returns {Change | null} */
export function cam(page, center, follower) {
  const middle = center.body && inBody(page, center.body, center.x, center.y), at = center.body && inBody(page, center.body, follower.x, follower.y);
  if (!middle || !at || !follower.body || follower.body === center.body) return null;
  const radius = Math.hypot(at[0] - middle[0], at[1] - middle[1]), start = Math.atan2(at[1] - middle[1], at[0] - middle[0]);
  if (!(radius > 0)) return null;
  const points = Array.from({ length: CONTROLS }, (_, k) => [neat(middle[0] + radius * Math.cos(start + (2 * Math.PI * k) / CONTROLS)), neat(middle[1] + radius * Math.sin(start + (2 * Math.PI * k) / CONTROLS))]);
  return added("cam", "joints", "cam", { type: "PointOnCurve", connect: [center.body, reference(follower, follower.body)], curve: { type: "SplineCurve", points, closed: true }, parameter: 0 });
}

/** @param {Place} place @returns {Change | null} */
export function mass(place) {
  /** @type {Operation[]} */
  const operations = [{ op: "add", section: "bodies", base: "mass", as: "$mass", fields: { type: "Particle", mass: MASS, position: [neat(place.x), neat(place.y)] } }];
  if (place.body) operations.push({ op: "add", section: "joints", base: "", fields: { type: "Revolute", connect: [reference(place, place.body), "$mass"] } });
  return { label: "add mass", operations };
}

/** Named point of a body, or of the ground. @param {Place} place @param {import("./types.d.ts").Document} document @returns {Change | null} */
export function point(place, document) {
  const owner = place.body ? document.bodies?.[place.body] : document.ground, points = owner?.points ?? {};
  const name = Array.from({ length: 200 }, (_, k) => `P${k + 1}`).find((free) => !(free in points)) ?? "P", at = place.body ? (place.local ?? [0, 0]).map(neat) : [neat(place.x), neat(place.y)];
  if (place.names.length || (place.body && !owner)) return null;
  const keys = place.body ? ["bodies", place.body] : ["ground"];
  if (!place.body && !document.ground) return { label: "add point", operations: [{ op: "add", section: "ground", name: "points", fields: { [name]: at } }] };
  return { label: "add point", operations: [owner.points ? { op: "set", keys: [...keys, "points", name], value: at } : { op: "set", keys: [...keys, "points"], value: { [name]: at } }] };
}

/** Flexible beam, clamped at both ends where it begins and ends on bodies or the ground. @param {Page} page @param {Place} from @param {Place} to @returns {Change | null} */
export function beam(page, from, to) {
  const length = Math.hypot(to.x - from.x, to.y - from.y), angle = Math.atan2(to.y - from.y, to.x - from.x);
  if (!(length > 0)) return null;
  const { modulus, density, poisson } = STEEL, area = SIDE ** 2, inertia = SIDE ** 4 / 12;
  const turn = (/** @type {Place} */ place) => neat(angle - angleOf(page, place.body));
  const ends = { frame_i: reference(from, from.body), ...(to.body && { frame_j: reference(to, to.body) }) };
  const stiffness = { axial_rigidity: neat(modulus * area), shear_rigidity: neat(((5 / 6) * modulus * area) / (2 * (1 + poisson))), bending_rigidity: neat(modulus * inertia) };
  const angles = { angle_i: turn(from), ...(to.body && { angle_j: turn(to) }) };
  return added("beam", "beams", "beam", { ...ends, length: neat(length), ...stiffness, damping: DAMPING, elements: 2, order: 2, mass_per_length: neat(density * area), ...angles });
}
