// Places under the pointer: named points, bodies and the grid.

/** @import { Page } from "./pictures.js" */

import { neatSpot } from "./neat.js";

/** Distance within which the pointer catches a point [px]. */
const CATCH = 11;
/** Shortest distance of lines of the grid [px]. */
const CELL = 26;
/** Directions to which lines snap [rad], and within which angle. */
const DIRECTION = Math.PI / 12, TURN = 0.03;

/** Difference of cosines and sines up to which two directions are the same. */
const SAME_ANGLE = 1e-5;
/** Points of the picture have at least this many places in a pixel. */
export const FINE = 100;

/** A place on the drawing: world coordinates, and the reference to it in the file.
 * `names` are the points there, `guides` lines by which it was chosen.
 * @typedef {{ x: number, y: number, names: string[], body: string | null, local: number[] | null, joint: string | null, how: string, guides?: { x: number, y: number }[][] }} Place */

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

/** Pose of a body; that of the file, which has all digits, where the picture shows the body there and it is stated in numbers.
 * @param {Page} page @param {any} body @returns {any} */
export function poseOf({ motion, scene, document }, body) {
  const pose = motion.pose(body), { position = [0, 0], angle = 0 } = document?.bodies?.[body.name] ?? {};
  if (!pose) return null;
  if (body.fixed) return { ...pose, exact: true };
  if (!document?.bodies?.[body.name] || ![...position, angle].every(Number.isFinite)) return pose;
  const [x, y] = position, turns = Math.round((pose.a - angle) / (2 * Math.PI)), own = { ...pose, x, y, a: angle + 2 * Math.PI * turns, c: Math.cos(angle), s: Math.sin(angle), exact: true };
  const isThere = Math.hypot(x - pose.x, y - pose.y) * scene.view.s * FINE < 1 && Math.hypot(own.c - pose.c, own.s - pose.s) < SAME_ANGLE;
  return isThere ? own : pose;
}

/** Angle of a body, or of the ground [rad]. @param {Page} page @param {string | null} name */
export const angleOf = (page, name) => poseOf(page, page.motion.bodies.find((/** @type {any} */ body) => body.name === name) ?? page.motion.ground)?.a ?? 0;

/** Points of the drawing with a name, grouped by place. @param {Page} page */
export function namedPlaces(page) {
  const { motion, scene: { view: { s: scale } } } = page;
  const places = /** @type {{ x: number, y: number, exact: boolean, names: string[], bodies: string[], locals: number[][] }[]} */ ([]);
  for (const point of motion.points) {
    const pose = poseOf(page, point.body);
    if (!pose) continue;
    const exact = Boolean(pose.exact), spot = motion.placed(pose, point.point), [x, y] = exact ? neatSpot(spot) : spot.map((/** @type {number} */ v) => rounded(v, FINE * scale));
    const near = places.find((place) => Math.hypot(place.x - x, place.y - y) * scale < 1);
    /** @type {typeof places[number]} */
    const place = near ?? { x, y, exact, names: [], bodies: [], locals: [] };
    if (!near) places.push(place);
    else if (exact && !near.exact) Object.assign(near, { x, y, exact });
    place.names.push(point.name);
    place.bodies.push(point.body.name);
    place.locals.push(point.point);
  }
  return places;
}

/** Coordinates in the frame of a body. @param {Page} page @param {string} name @param {number} x @param {number} y */
export function inBody(page, name, x, y) {
  const body = page.motion.bodies.find((/** @type {any} */ part) => part.name === name), pose = body && poseOf(page, body);
  if (!pose) return null;
  const [u, v] = [x - pose.x, y - pose.y];
  return neatSpot([pose.c * u + pose.s * v, pose.c * v - pose.s * u], [x, y, pose.x, pose.y]);
}

/** A place without a reference. @param {number} x @param {number} y @returns {Place} */
export const placed = (x, y) => ({ x, y, names: [], body: null, local: null, joint: null, how: "" });

/** Place with typed coordinates: the points there, if they have names. @param {Page} page @param {{ x: number, y: number }} at @returns {Place} */
export function typedAt(page, { x, y }) {
  const { s: scale } = page.scene.view, near = namedPlaces(page).find((place) => Math.hypot(place.x - x, place.y - y) * scale < 0.5);
  if (!near) return { ...placed(x, y), how: "typed" };
  const joint = page.motion.joints.find((/** @type {any} */ item) => { const at = placeOf(page, item); return at && Math.hypot(at[0] - x, at[1] - y) * scale < 0.5; })?.name ?? null;
  return { ...placed(near.x, near.y), names: near.names, body: near.bodies[0], local: near.locals[0], joint, how: near.names[0] };
}

/** Place under the pointer. @param {Page} page @param {[number, number]} pixel @param {{ from?: { x: number, y: number } | null, free?: boolean, ignore?: string[] }} options
 * @returns {Place} */
export function snap(page, pixel, { from = null, free = false, ignore = [] } = {}) {
  const { scene } = page, { view } = scene, [x, y] = view.world(pixel), scale = view.s;
  const joint = page.motion.joints.map((/** @type {any} */ item) => ({ item, at: placeOf(page, item) })).find((/** @type {any} */ { at }) => at && Math.hypot(at[0] - x, at[1] - y) * scale < CATCH)?.item.name ?? null;
  if (free) return { ...placed(x, y), joint };
  const others = namedPlaces(page).map((place) => ({ ...place, names: place.names.filter((name) => !ignore.includes(name)), away: Math.hypot(place.x - x, place.y - y) * scale })).filter(({ names }) => names.length);
  const near = others.filter(({ away }) => away < CATCH).sort((a, b) => a.away - b.away)[0];
  if (near) return { ...placed(near.x, near.y), names: near.names, body: near.bodies[0], local: near.locals[0], joint, how: near.names[0] };
  const step = gridStep(scale), [gx, gy] = [x, y].map((v) => Number((Math.round(v / step) * step).toPrecision(9)));
  if (Math.hypot(gx - x, gy - y) * scale < CATCH * 0.7) return { ...placed(gx, gy), joint, how: "grid" };
  const found = (from && alongDirection(page, from, x, y, step)) ?? equalLength(page, from, x, y) ?? aligned(others, x, y, scale) ?? onOutline(page, x, y);
  return found ? { ...found, joint } : { ...placed(rounded(x, scale), rounded(y, scale)), joint };
}

/** Place in a direction of 15°, of a whole length where one is near. @param {Page} page @param {{ x: number, y: number }} from @param {number} x @param {number} y @param {number} step @returns {Place | null} */
function alongDirection(page, from, x, y, step) {
  const { s: scale } = page.scene.view, length = Math.hypot(x - from.x, y - from.y), angle = Math.atan2(y - from.y, x - from.x), straight = Math.round(angle / DIRECTION) * DIRECTION;
  if (Math.abs(angle - straight) > TURN || length * scale < 3 * CATCH) return null;
  const near = (/** @type {number} */ other) => Math.abs(other - length) * scale < CATCH / 2;
  const equal = barLengths(page).find((bar) => near(bar.length)), whole = Math.round(length / step) * step, size = equal ? equal.length : near(whole) ? whole : length;
  return { ...placed(rounded(from.x + size * Math.cos(straight), FINE * scale), rounded(from.y + size * Math.sin(straight), FINE * scale)), how: `${Math.round((straight * 180) / Math.PI)}°${equal ? `, length of ${equal.name}` : ""}` };
}

/** Lengths of the bars of the drawing. @param {Page} page @returns {{ name: string, length: number }[]} */
function barLengths({ motion, scene }) {
  return motion.bodies.flatMap((/** @type {any} */ { name, shapes }) => shapes.filter((/** @type {any} */ { kind }) => kind === "bar").map((/** @type {any} */ { from, to }) => ({ name, length: rounded(Math.hypot(to[0] - from[0], to[1] - from[1]), FINE * scene.view.s) })));
}

/** Place at the distance of the length of a bar. @param {Page} page @param {{ x: number, y: number } | null} from @param {number} x @param {number} y @returns {Place | null} */
function equalLength(page, from, x, y) {
  const { s: scale } = page.scene.view, length = from ? Math.hypot(x - from.x, y - from.y) : 0;
  const equal = from && barLengths(page).find((bar) => Math.abs(bar.length - length) * scale < CATCH / 2);
  if (!from || !equal) return null;
  const factor = equal.length / length;
  return { ...placed(rounded(from.x + (x - from.x) * factor, FINE * scale), rounded(from.y + (y - from.y) * factor, FINE * scale)), how: `length of ${equal.name}` };
}

/** Place above, below or beside points. @param {{ x: number, y: number, names: string[] }[]} points @param {number} x @param {number} y @param {number} scale @returns {Place | null} */
function aligned(points, x, y, scale) {
  const nearest = (/** @type {"x" | "y"} */ axis, /** @type {number} */ value) => points.map((point) => ({ point, away: Math.abs(point[axis] - value) * scale })).filter(({ away }) => away < CATCH / 2).sort((a, b) => a.away - b.away)[0]?.point;
  const above = nearest("x", x), beside = nearest("y", y);
  if (!above && !beside) return null;
  const place = placed(above?.x ?? rounded(x, scale), beside?.y ?? rounded(y, scale));
  const how = [above && `x of ${above.names[0]}`, beside && `y of ${beside.names[0]}`].filter(Boolean).join(", ");
  return { ...place, how, guides: [above, beside].flatMap((point) => (point ? [[point, { x: place.x, y: place.y }]] : [])) };
}

/** Place on the outline of a body. @param {Page} page @param {number} x @param {number} y @param {string} [but] body that is left out @returns {Place | null} */
export function onOutline(page, x, y, but = "") {
  const { motion, scene: { view: { s: scale } } } = page;
  for (const body of motion.bodies) {
    if (body.name === but) continue;
    const pose = motion.pose(body);
    for (const shape of pose ? body.shapes : []) {
      const corners = motion.outline(shape).map((/** @type {any} */ p) => motion.placed(pose, p)), closed = corners.length > 2;
      for (let k = closed ? 0 : 1; k < corners.length; k++) {
        const [ax, ay] = corners[(k || corners.length) - 1], [bx, by] = corners[k], square = (bx - ax) ** 2 + (by - ay) ** 2 || 1;
        const along = Math.min(1, Math.max(0, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / square)), [px, py] = [ax + along * (bx - ax), ay + along * (by - ay)];
        if (Math.hypot(px - x, py - y) * scale > CATCH / 2) continue;
        const place = placed(rounded(px, FINE * scale), rounded(py, FINE * scale));
        return { ...place, body: body.name, local: inBody(page, body.name, place.x, place.y), how: `outline of ${body.name}` };
      }
    }
  }
  return null;
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

/** Places of each element: corners of the outline of bodies, ends of links, joints. @param {Page} page @returns {{ name: string, places: [number, number][] }[]} */
export function elementPlaces(page) {
  const { motion } = page, at = (/** @type {any} */ { body, point }) => { const pose = motion.pose(body); return pose ? [motion.placed(pose, point)] : []; };
  const bodies = motion.bodies.map((/** @type {any} */ body) => {
    const pose = motion.pose(body), outline = body.shapes.flatMap((/** @type {any} */ shape) => motion.outline(shape));
    return { name: body.name, places: pose ? (outline.length ? outline : [[0, 0]]).map((/** @type {any} */ p) => motion.placed(pose, p)) : [] };
  });
  const joints = motion.joints.map((/** @type {any} */ item) => ({ name: item.name, places: [placeOf(page, item)].filter(Boolean) }));
  return [...bodies, ...joints, ...motion.links.map((/** @type {any} */ { name, i, j }) => ({ name, places: [...at(i), ...at(j)] }))];
}
