// Forces and drivers that are drawn.

/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { added } from "./new_joints.js";
import { bodiesAt, reference } from "./operations.js";

/** Values of new elements: damping, and that of hydraulic cylinders [N s/m], moment [N m], torsional stiffness [N m/rad], force of a cylinder [N], stiffness of stops, ropes and contacts [N/m]. */
const DAMPING = 20, SEALS = 2000, MOMENT = 1, TORSION = 5, PUSH = 100, STOP = 1000, ROPE = 1e4, CONTACT = 1e5;
/** Time of an oscillation of a new drive [s], and its amplitude relative to the length. */
const PERIOD = 2, STROKE = 0.1;
/** Amplitude of the opening of the valve of a new cylinder per length [1/m], so that it uses about half of its stroke. */
const VALVE = 0.2;

/** Ends of an element between two points. @param {Place} from @param {Place} to */
function ends(from, to) {
  const length = neat(Math.hypot(to.x - from.x, to.y - from.y));
  return length > 0 && (from.body || to.body) && from.body !== to.body ? { connect: [reference(from, from.body), reference(to, to.body)], length } : null;
}

/** @param {Place} from @param {Place} to @returns {Change | null} */
export function damper(from, to) {
  const pair = ends(from, to);
  return pair && added("damper", "forces", "damper", { type: "Spring", connect: pair.connect, damping: DAMPING });
}

/** @param {Place} from @param {Place} to @returns {Change | null} */
export function actuator(from, to) {
  const pair = ends(from, to);
  return pair && added("cylinder", "forces", "cylinder", { type: "Actuator", connect: pair.connect, force: PUSH });
}

/** @param {Place} from @param {Place} to @returns {Change | null} */
export function hydraulic(from, to) {
  const pair = ends(from, to);
  if (!pair) return null;
  return added("hydraulic cylinder", "forces", "hydraulic", { type: "HydraulicCylinder", connect: pair.connect, opening: `${neat(VALVE * pair.length)}*sin(2*pi*t/${PERIOD})`, stroke: neat(0.8 * pair.length), retracted_length: neat(0.6 * pair.length), damping: SEALS });
}

/** Drive of a distance. @param {Place} from @param {Place} to @returns {Change | null} */
export function stroke(from, to) {
  const pair = ends(from, to);
  return pair && added("length drive", "drivers", "stroke", { type: "DistanceDriver", connect: pair.connect, law: `${pair.length} + ${neat(STROKE * pair.length)}*sin(2*pi*t/${PERIOD})` });
}

/** Rope through points. @param {Place[]} places @returns {Change | null} */
export function rope(places) {
  const length = places.slice(1).reduce((sum, place, k) => sum + Math.hypot(place.x - places[k].x, place.y - places[k].y), 0);
  if (!(length > 0) || !places.some(({ body }) => body)) return null;
  return added("rope", "forces", "rope", { type: "Cable", points: places.map((place) => reference(place, place.body)), length: neat(length), stiffness: ROPE, damping: DAMPING });
}

/** @param {Place} place @returns {Change | null} */
export function torque(place) {
  return place.body ? added("torque", "forces", "torque", { type: "Torque", connect: [place.body], value: MOMENT }) : null;
}

/** The clicked joint. @param {Place} place @param {Document} document */
const jointAt = (place, document) => (place.joint === null ? null : document.joints?.[place.joint] ?? null);

/** @param {Place} place @param {Page} page @param {Document} document @returns {Change | null} */
export function torsionSpring(place, page, document) {
  const joint = jointAt(place, document);
  if (!joint) return null;
  const { bodies, angle } = bodiesAt(page, joint);
  return added("torsion spring", "forces", "torsion", { type: "TorsionSpring", connect: bodies, stiffness: TORSION, ...(angle && { free_angle: angle }) });
}

/** Limits of the free motion of a joint. @param {Place} place @param {Page} page @param {Document} document @returns {Change | null} */
export function stop(place, page, document) {
  const joint = jointAt(place, document), turns = ["Revolute", undefined].includes(joint?.type);
  if (!joint || !["Revolute", "Prismatic", "PinInSlot"].includes(joint.type)) return null;
  const now = turns ? bodiesAt(page, joint).angle : 0, range = turns ? 1 : 0.2;
  return added("stop", "forces", "stop", { type: "Stop", coordinate: `${place.joint}.${turns ? "angle" : "displacement"}`, lower: neat(now - range), upper: neat(now + range), stiffness: STOP });
}

/** Motor along the free displacement of a joint. @param {Place} place @param {Document} document @returns {Change | null} */
export function linearMotor(place, document) {
  const joint = jointAt(place, document);
  if (!joint || !["Prismatic", "PinInSlot"].includes(joint.type)) return null;
  return added("linear motor", "drivers", "drive", { type: "TranslationalDriver", joint: place.joint, law: `${STROKE}*sin(2*pi*t/${PERIOD})` });
}

/** Contact of a body with another one, or with a half-plane below the second place. @param {Place} first @param {Place} second @param {Document} document @returns {Change | null} */
export function contact(first, second, document) {
  if (!first.body || first.body === second.body) return null;
  const floor = { type: "HalfPlane", point: { body: "ground", at: [neat(second.x), neat(second.y)] }, normal: [0.0, 1.0] };
  const shape_i = second.body ? shapeOf(second.body, document) : floor, shape_j = shapeOf(first.body, document, !second.body);
  if (!shape_i || !shape_j) return null;
  if (!CONTACTS.has([shape_i.type, shape_j.type].sort().join())) throw new Error(`a contact of ${first.body} and ${second.body ?? "a floor"} is not available, only those of point masses, of convex plates, and of bodies with a floor; draw contacts among many bodies instead, with capsules (Shift+K) on bars and convex polygons (Shift+Y) on plates`);
  return added("contact", "forces", "contact", { type: "Contact", shape_i, shape_j, law: { type: "HuntCrossley", stiffness: CONTACT, damping: 0.5 } });
}

/** Pairs of shapes whose contact is an element of its own. */
const CONTACTS = new Set(["Capsule,Circle", "Capsule,HalfPlane", "Circle,Circle", "Circle,HalfPlane", "Circle,Outline", "Circle,Polygon", "HalfPlane,Polygon", "Polygon,Polygon"]);

/** Shape of a body for contacts. @param {string} name @param {Document} document @param {boolean} [onFloor] whether only its convex hull touches */
function shapeOf(name, document, onFloor = false) {
  const entry = document.bodies?.[name], corners = Object.values(entry?.points ?? {});
  if (entry?.type === "Bar") return { type: "Capsule", point_i: `${name}.start`, point_j: `${name}.end`, radius: 0.01 };
  if (entry?.type === "Particle") return { type: "Circle", point: name, radius: 0.02 };
  if (!entry || corners.length < 3) return entry ? { type: "Circle", point: name, radius: 0.05 } : null;
  const convex = isConvex(corners), hulled = onFloor && !convex && corners.flat().every(Number.isFinite);
  return { type: convex || hulled ? "Polygon" : "Outline", body: name, vertices: hulled ? hull(corners) : anticlockwise(corners) };
}

/** Corners of the convex hull, anticlockwise. @param {any[]} corners */
function hull(corners) {
  const sorted = [...corners].sort(([x, y], [u, v]) => x - u || y - v);
  const chain = (/** @type {any[]} */ list) => list.reduce((/** @type {any[]} */ kept, corner) => {
    while (kept.length > 1 && turn(kept.at(-2), kept.at(-1), corner) <= 0) kept.pop();
    return [...kept, corner];
  }, []).slice(0, -1);
  return [...chain(sorted), ...chain(sorted.reverse())];
}

/** Twice the signed area of a triangle. @param {any} a @param {any} b @param {any} c */
const turn = ([x, y], [u, v], [p, q]) => (u - x) * (q - v) - (v - y) * (p - u);

/** @param {any[]} corners */
const isConvex = (corners) => new Set(corners.map((corner, k) => Math.sign(turn(corner, corners[(k + 1) % corners.length], corners[(k + 2) % corners.length]))).filter((side) => side !== 0)).size === 1;

/** @param {any[]} corners */
function anticlockwise(corners) {
  const area = corners.reduce((sum, [x, y], k) => { const [u, v] = corners[(k + 1) % corners.length]; return sum + x * v - u * y; }, 0);
  return area < 0 ? [...corners].reverse() : corners;
}
