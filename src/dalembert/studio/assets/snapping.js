// Places under the pointer: named points, bodies and the grid.

/** @import { Page } from "./pictures.js" */

/** Distance within which the pointer catches a point [px]. */
const CATCH = 11;
/** Shortest distance of lines of the grid [px]. */
const CELL = 26;
/** Directions to which lines snap [rad], and within which angle. */
const DIRECTION = Math.PI / 12, TURN = 0.03;

/** Points of the picture have at least this many places in a pixel. */
export const FINE = 100;

/** A place on the drawing: world coordinates, and the reference to it in the file.
 * `names` are the points there; `reference` is the first of them.
 * @typedef {{ x: number, y: number, names: string[], body: string | null, local: number[] | null, joint: string | null, how: string }} Place */

/** Distance of lines of the grid at a scale [m]. @param {number} scale pixels per metre */
export function gridStep(scale) {
  const exponent = Math.floor(Math.log10(CELL / scale));
  return [1, 2, 5, 10].map((m) => m * 10 ** exponent).find((step) => step * scale >= CELL) ?? 10 ** (exponent + 1);
}

/** Number without the noise of the pointer. @param {number} value @param {number} scale pixels per metre */
export function rounded(value, scale) {
  const digits = Math.max(0, Math.min(9, Math.ceil(Math.log10(scale * 4))));
  return Number(value.toFixed(digits)) || 0;
}

/** Points of the drawing with a name, grouped by place. @param {Page} page */
export function namedPlaces({ motion, scene }) {
  const places = /** @type {{ x: number, y: number, names: string[], bodies: string[], locals: number[][] }[]} */ ([]);
  for (const point of motion.points) {
    const pose = motion.pose(point.body);
    if (!pose) continue;
    const [x, y] = motion.placed(pose, point.point);
    const near = places.find((place) => Math.hypot(place.x - x, place.y - y) * scene.view.s < 1);
    /** @type {typeof places[number]} */
    const place = near ?? { x, y, names: [], bodies: [], locals: [] };
    if (!near) places.push(place);
    place.names.push(point.name);
    place.bodies.push(point.body.name);
    place.locals.push(point.point);
  }
  return places;
}

/** Coordinates in the frame of a body. @param {Page} page @param {string} name @param {number} x @param {number} y */
export function inBody({ motion }, name, x, y) {
  const body = motion.bodies.find((/** @type {any} */ part) => part.name === name), pose = body && motion.pose(body);
  if (!pose) return null;
  const [u, v] = [x - pose.x, y - pose.y];
  return [pose.c * u + pose.s * v, pose.c * v - pose.s * u];
}

/** Place under the pointer. @param {Page} page @param {[number, number]} pixel @param {{ from?: { x: number, y: number } | null, free?: boolean, ignore?: string[] }} options
 * @returns {Place} */
export function snap(page, pixel, { from = null, free = false, ignore = [] } = {}) {
  const { scene } = page, { view } = scene, [x, y] = view.world(pixel), scale = view.s;
  const joint = page.motion.joints.map((/** @type {any} */ item) => ({ item, at: placeOf(page, item) })).find((/** @type {any} */ { at }) => at && Math.hypot(at[0] - x, at[1] - y) * scale < CATCH)?.item.name ?? null;
  if (free) return { x, y, names: [], body: null, local: null, joint, how: "" };
  const near = namedPlaces(page).map((place) => ({ ...place, names: place.names.filter((name) => !ignore.includes(name)), away: Math.hypot(place.x - x, place.y - y) * scale }))
    .filter(({ away, names }) => names.length && away < CATCH).sort((a, b) => a.away - b.away)[0];
  if (near) return { x: rounded(near.x, FINE * scale), y: rounded(near.y, FINE * scale), names: near.names, body: near.bodies[0], local: near.locals[0], joint, how: near.names[0] };
  const step = gridStep(scale), [gx, gy] = [x, y].map((v) => Number((Math.round(v / step) * step).toPrecision(9)));
  if (Math.hypot(gx - x, gy - y) * scale < CATCH * 0.7) return { x: gx, y: gy, names: [], body: null, local: null, joint, how: "grid" };
  if (from) {
    const length = Math.hypot(x - from.x, y - from.y), angle = Math.atan2(y - from.y, x - from.x), straight = Math.round(angle / DIRECTION) * DIRECTION;
    if (Math.abs(angle - straight) < TURN && length * scale > 3 * CATCH) {
      const whole = Math.abs(Math.round(length / step) * step - length) * scale < CATCH / 2 ? Math.round(length / step) * step : length;
      return { x: rounded(from.x + whole * Math.cos(straight), scale), y: rounded(from.y + whole * Math.sin(straight), scale), names: [], body: null, local: null, joint, how: `${Math.round((straight * 180) / Math.PI)}°` };
    }
  }
  return { x: rounded(x, scale), y: rounded(y, scale), names: [], body: null, local: null, joint, how: "" };
}

/** World coordinates of a joint. @param {Page} page @param {any} item */
export function placeOf({ motion }, item) {
  const pose = item.body && motion.pose(item.body);
  return pose && item.point ? motion.placed(pose, item.point) : null;
}

/** Element under the pointer. @param {Page} page @param {[number, number]} pixel @returns {{ kind: string, name: string } | null} */
export function elementAt({ scene, motion }, pixel) {
  const hit = scene.painter.hit(pixel);
  if (!hit) return null;
  return { kind: hit.kind, name: hit.kind === "point" ? motion.points[hit.item.index]?.body.name ?? "" : hit.item.name };
}
