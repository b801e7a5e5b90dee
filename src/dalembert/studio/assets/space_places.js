// Places in space under the pointer: named points, surfaces of bodies, the grid of the working plane.

/** @import { Page } from "./pictures.js" */
/** @import { Vec } from "./space_math.js" */

import { neat } from "./neat.js";
import { gridStep, rounded } from "./snapping.js";
import { alongLine, minus, onPlane, plus, times, unit } from "./space_math.js";

/** Distance within which the pointer catches a point [px]. */
const CATCH = 11;
/** Size of the whole motion, relative to the position at the start, above which it is far. */
const FAR = 4;

/** A place: its coordinates, the names of the points there, the body it is on, and the normal of the surface there.
 * @typedef {{ p: Vec, names: string[], body: string | null, joint: string | null, normal: Vec | null, how: string }} SpacePlace */
/** Working plane. @typedef {{ axis: "x" | "y" | "z", normal: Vec, origin: Vec }} WorkingPlane */
/** @typedef {[number, number]} Pixel */

/** How coordinates are typed. */
export const COORDINATES = "type three coordinates, such as 0.1, 0, 0.25, or one along the normal of the plane from the last place";

/** A place without a reference. @param {Vec} p @returns {SpacePlace} */
export const spacePlaced = (p) => ({ p, names: [], body: null, joint: null, normal: null, how: "typed" });

/** Place with three typed coordinates, or with one along the normal of the plane from the last place. @param {string} typed @param {WorkingPlane} plane @param {Vec | null} last @returns {SpacePlace | null} */
export function typedSpacePlace(typed, { axis }, last) {
  const values = typed.split(/[\s,;]+/).filter(Boolean).map(Number), k = "xyz".indexOf(axis);
  const p = values.length === 3 ? values : values.length === 1 && last ? last.map((v, i) => (i === k ? v + values[0] : v)) : null;
  return p?.every(Number.isFinite) ? spacePlaced(p) : null;
}

/** Line of sight. @param {Page} page @param {Pixel} pixel */
export function rayAt({ scene }, [x, y]) {
  const { canvas, view: { camera } } = scene, spot = (/** @type {number} */ depth) => camera.position.clone().set((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight, depth).unproject(camera);
  const from = camera.position.toArray(), way = spot(0.5).sub(camera.position).normalize().toArray();
  return { from, way };
}

/** Points with a name, grouped by place. @param {Page} page */
export function namedPoints({ motion, scene }) {
  const places = /** @type {{ p: Vec, names: string[], bodies: string[] }[]} */ ([]);
  for (const { body, point, name } of motion.points) {
    const p = motion.at(body, point);
    if (!p) continue;
    const near = places.find((place) => Math.hypot(...minus(place.p, p)) * scene.view.scaleAt(p) < 1);
    /** @type {typeof places[number]} */
    const place = near ?? { p, names: [], bodies: [] };
    if (!near) places.push(place);
    place.names.push(name);
    place.bodies.push(body.name);
  }
  return places;
}

/** A typed place with the points and the joint that are there, or with the body whose mass centre is there. @param {Page} page @param {SpacePlace} place @returns {SpacePlace} */
export function joinedPlace(page, place) {
  const { motion, scene } = page, isNear = (/** @type {Vec | null | undefined} */ p) => Boolean(p) && Math.hypot(...minus(/** @type {Vec} */ (p), place.p)) * scene.view.scaleAt(place.p) < 1;
  const points = namedPoints(page).find(({ p }) => isNear(p)), joint = motion.joints.find((/** @type {any} */ item) => isNear(motion.placeOf(item)));
  const centre = motion.bodies.find((/** @type {any} */ body) => !body.of && isNear(motion.pose(body)?.p.toArray()));
  return { ...place, names: points?.names ?? [], body: points?.bodies[0] ?? centre?.name ?? null, joint: joint?.name ?? null };
}

/** Coordinates without the noise of the pointer. @param {Page} page @param {Vec} p @param {number} fine places in a pixel */
export const cleaned = ({ scene }, p, fine) => p.map((v) => rounded(v, fine * scene.view.scaleAt(p)));

/** Distance of lines of the grid near a place [m]. @param {Page} page @param {Vec} p */
export const stepAt = ({ scene }, p) => gridStep(scene.view.scaleAt(p));

/** Place under the pointer.
 * @param {Page} page @param {Pixel} pixel @param {WorkingPlane} plane @param {{ free?: boolean, onBody?: boolean, from?: Vec | null, lift?: boolean }} options
 * `lift` moves along the normal of the plane from a place. @returns {SpacePlace | null} */
export function spaceSnap(page, pixel, plane, { free = false, onBody = false, from = null, lift = false } = {}) {
  const { motion, scene } = page, ray = rayAt(page, pixel), none = /** @type {Pick<SpacePlace, "names" | "body" | "joint" | "normal">} */ ({ names: [], body: null, joint: null, normal: null });
  const snapped = (/** @type {number} */ v, /** @type {number} */ step) => (free ? v : Number((Math.round(v / step) * step).toPrecision(9)));
  if (lift && from) {
    const s = alongLine(ray, from, plane.normal);
    return s === null ? null : { ...none, p: plus(from, times(plane.normal, free ? rounded(s, scene.view.scaleAt(from)) : snapped(s, stepAt(page, from)))).map(neat), how: `along ${plane.axis}` };
  }
  const away = (/** @type {Vec | null} */ p) => { const at = p && scene.view.screen(p); return at ? Math.hypot(at[0] - pixel[0], at[1] - pixel[1]) : Infinity; };
  const joint = motion.joints.map((/** @type {any} */ item) => ({ name: item.name, p: motion.placeOf(item) })).filter((/** @type {any} */ { p }) => away(p) < CATCH)[0] ?? null;
  if (!free) {
    const near = namedPoints(page).map((place) => ({ ...place, away: away(place.p) })).filter((place) => place.away < CATCH).sort((a, b) => a.away - b.away)[0];
    if (near) return { p: near.p.map(neat), names: near.names, body: near.bodies[0], joint: joint?.name ?? null, normal: null, how: near.names[0] };
    if (joint) return { ...none, p: joint.p.map(neat), joint: joint.name, how: joint.name };
  }
  const hit = onBody ? scene.painter.struck(pixel) : null;
  if (hit?.object.userData.kind === "body") {
    const normal = hit.face.normal.clone().transformDirection(hit.object.matrixWorld).toArray(), name = hit.object.userData.item.name;
    return { ...none, p: cleaned(page, hit.point.toArray(), 1), body: name, normal: unit(normal), how: `on ${name}` };
  }
  const p = onPlane(ray, plane.origin, plane.normal);
  if (!p || scene.view.scaleAt(p) < 2) return null;
  const step = stepAt(page, p), fixed = "xyz".indexOf(plane.axis), ordered = p.map((v, k) => (k === fixed ? plane.origin[k] : snapped(v, step)));
  return { ...none, p: free ? cleaned(page, ordered, 1) : ordered, how: free ? "" : "grid" };
}

/** Fit ground, grid and light to the position at the start, where free bodies go far from it. @param {Page} page */
export function settleAtStart({ motion, scene }) {
  const { view } = scene, { camera, controls, fitted } = view, cloud = motion.cloud([{ i: 0, f: 0 }]), [low, high] = [Math.min, Math.max].map((limit) => [0, 1, 2].map((k) => cloud.reduce((/** @type {number} */ v, /** @type {Vec} */ p) => limit(v, p[k]), cloud[0]?.[k] ?? 0)));
  const extent = Math.hypot(...minus(high, low));
  if (!(extent > 0) || scene.size < FAR * extent) return;
  const [from, target] = [camera.position.clone(), controls.target.clone()];
  Object.assign(scene, { cloud, size: extent, followed: null });
  view.radius = 0;
  view.enclose(cloud, motion.gravity);
  scene.restyle();
  view.enclose = () => {};  // a live page that computes again leaves it so
  if (fitted) return scene.fit();
  camera.position.copy(from);
  view.controls.target.copy(target);
  view.controls.update();
  view.aim(scene.canvas.clientWidth, scene.canvas.clientHeight);
  view.fitted = false;
}
