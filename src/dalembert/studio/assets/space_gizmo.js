// Gizmo of the selected element: arrows and planes that move it, rings that rotate it.

/** @import { Page } from "./pictures.js" */
/** @import { Pose } from "./space_poses.js" */
/** @import { Pixel } from "./space_places.js" */
/** @import { Vec } from "./space_math.js" */

import { cleaned, rayAt, stepAt } from "./space_places.js";
import { AXES, about, alongLine, cross, dot, minus, onPlane, plus, product, size, times, unit } from "./space_math.js";

/** Lengths of arrows, radius of rings, near and far sides of planes [px]; distance at which the pointer takes hold. */
const ARROW = 92, RING = 74, NEAR = 20, FAR = 40, REACH = 7;
/** Steps of rotations [rad]. */
const STEP = Math.PI / 36;
const COLOURS = /** @type {Record<string, Record<string, string>>} */ ({ light: { x: "#c8332b", y: "#23813a", z: "#1f62c9" }, dark: { x: "#ff7a70", y: "#5fd07a", z: "#79aaff" } });

/** Part of the gizmo: an axis along which, across which or about which it moves, and the other axes of the frame, right-handed with it.
 * @typedef {{ kind: "move" | "plane" | "turn", axis: string, way: Vec, sides: [Vec, Vec] }} Handle */
/** @typedef {{ handle: Handle, before: Pose, after: Pose, start: Vec | number | null, free: boolean, typed: string, value: number, pixel: Pixel }} Grip */

/** Colour of an axis in the theme of the page. @param {string} axis */
export const axisColour = (axis) => COLOURS[document.documentElement.dataset.theme === "dark" ? "dark" : "light"][axis];

/** Handles of a pose. @param {Pose} pose @param {boolean} turns @param {Vec[]} axes of the frame in which it moves @returns {Handle[]} */
export function handles(pose, turns, axes) {
  const names = Object.keys(AXES), all = (/** @type {Handle["kind"]} */ kind) => names.map((axis, k) => ({ kind, axis, way: axes[k], sides: /** @type {[Vec, Vec]} */ ([axes[(k + 1) % 3], axes[(k + 2) % 3]]) }));
  return [...all("move"), ...all("plane"), ...(turns ? all("turn") : [])];
}

/** Corners of a handle in space: of an arrow, a plane or a ring. @param {Page} page @param {Pose} pose @param {Handle} handle */
export function outline({ scene }, { p }, { kind, way, sides: [u, v] }) {
  const px = 1 / scene.view.scaleAt(p), at = (/** @type {Vec} */ u, /** @type {number} */ a, /** @type {Vec} */ v = u, b = 0) => plus(p, plus(times(u, a * px), times(v, b * px)));
  if (kind === "move") return [at(way, 8), at(way, ARROW)];
  if (kind === "plane") return [at(u, NEAR, v, NEAR), at(u, FAR, v, NEAR), at(u, FAR, v, FAR), at(u, NEAR, v, FAR)];
  return Array.from({ length: 49 }, (_, k) => at(u, RING * Math.cos((k * Math.PI) / 24), v, RING * Math.sin((k * Math.PI) / 24)));
}

/** Handle at a pixel. @param {Page} page @param {Pose} pose @param {Handle[]} list @param {Pixel} pixel @returns {Handle | null} */
export function handleAt(page, pose, list, [x, y]) {
  let [nearest, least] = [/** @type {Handle | null} */ (null), REACH];
  for (const handle of list) {
    const corners = outline(page, pose, handle).map((p) => page.scene.view.screen(p));
    if (corners.some((corner) => !corner)) continue;
    const shape = /** @type {Pixel[]} */ (corners), inside = handle.kind === "plane" && contains(shape, [x, y]);
    const away = inside ? 0 : Math.min(...shape.slice(1).map((q, k) => fromSegment([x, y], shape[k], q)));
    const edgeOn = handle.kind === "plane" && Math.abs(area(shape)) < 60;
    if (away < least && !edgeOn) [nearest, least] = [handle, Math.max(away, handle.kind === "turn" ? 0.5 : 0)];
  }
  return nearest;
}

/** @param {Pixel[]} corners */
const area = (corners) => corners.reduce((sum, [x, y], k) => { const [u, v] = corners[(k + 1) % corners.length]; return sum + (x * v - u * y) / 2; }, 0);

/** @param {Pixel[]} corners @param {Pixel} pixel */
function contains(corners, [x, y]) {
  const sides = corners.map(([a, b], k) => { const [c, d] = corners[(k + 1) % corners.length]; return (c - a) * (y - b) - (d - b) * (x - a); });
  return sides.every((side) => side >= 0) || sides.every((side) => side <= 0);
}

/** @param {Pixel} pixel @param {Pixel} from @param {Pixel} to */
function fromSegment([x, y], [a, b], [c, d]) {
  const [u, v] = [c - a, d - b], t = Math.max(0, Math.min(1, ((x - a) * u + (y - b) * v) / (u * u + v * v || 1)));
  return Math.hypot(x - a - t * u, y - b - t * v);
}

/** Coordinate of the pointer on a handle: along its arrow, in its plane, or the angle on its ring [rad].
 * @param {Page} page @param {Pose} pose @param {Handle} handle @param {Pixel} pixel @returns {Vec | number | null} */
function coordinateAt(page, { p }, { kind, way, sides: [u, v] }, pixel) {
  const ray = rayAt(page, pixel);
  if (kind === "move") return alongLine(ray, p, way);
  const spot = onPlane(ray, p, way);
  if (kind === "plane") return spot;
  if (spot && Math.abs(dot(ray.way, way)) > 0.12) return Math.atan2(dot(minus(spot, p), v), dot(minus(spot, p), u));
  const tangent = unit(cross(way, ray.way)), px = page.scene.view.scaleAt(p), s = alongLine(ray, p, tangent);  // the ring is seen from the side
  return s === null ? null : (-s * px) / RING;
}

/** Take hold of a handle. @param {Page} page @param {Pose} pose @param {Handle} handle @param {Pixel} pixel @returns {Grip} */
export const grip = (page, pose, handle, pixel) => ({ handle, before: pose, after: pose, start: coordinateAt(page, pose, handle, pixel), free: false, typed: "", value: 0, pixel });

/** Pose for a displacement [m] or an angle [rad] of a handle. @param {Grip} held @param {number} value @returns {Pose} */
const shifted = ({ before: { p, q }, handle: { kind, way } }, value) => (kind === "turn" ? { p, q: product(about(way, value), q) } : { p: plus(p, times(way, value)), q });

/** The grip after a movement of the pointer. @param {Page} page @param {Grip} held @param {Pixel} pixel @param {boolean} free @returns {Grip} */
export function pulled(page, held, pixel, free) {
  const { before, handle, start } = held, now = coordinateAt(page, before, handle, pixel), next = { ...held, free, pixel };
  if (now === null || start === null || held.typed) return next;
  const step = stepAt(page, before.p), toStep = (/** @type {number} */ v) => (free ? v : Math.round(v / step) * step);
  if (handle.kind === "plane") {
    const raw = minus(/** @type {Vec} */ (now), /** @type {Vec} */ (start));
    const shift = handle.sides.reduce((sum, axis) => plus(sum, times(axis, onGrid(before.p, axis, dot(raw, axis), toStep))), [0, 0, 0]);
    return { ...next, after: { p: tidy(page, before.p, shift, free), q: before.q }, value: size(shift) };
  }
  const raw = /** @type {number} */ (now) - /** @type {number} */ (start);
  if (handle.kind === "turn") {
    const whole = Math.atan2(Math.sin(raw), Math.cos(raw)), value = free ? whole : Math.round(whole / STEP) * STEP;
    return { ...next, value, after: shifted(held, value) };
  }
  const value = onGrid(before.p, handle.way, raw, toStep);
  return { ...next, value, after: { p: tidy(page, before.p, times(handle.way, value), free), q: before.q } };
}

/** Displacement to a line of the grid along an axis of it; along an inclined axis, of whole steps. @param {Vec} p @param {Vec} axis @param {number} shift @param {(v: number) => number} toStep */
function onGrid(p, axis, shift, toStep) {
  const k = axis.findIndex((v) => Math.abs(v) > 1 - 1e-9);
  return k < 0 ? toStep(shift) : (toStep(p[k] + axis[k] * shift) - p[k]) / axis[k];
}

/** Displaced place; coordinates that change have few digits. @param {Page} page @param {Vec} p @param {Vec} shift @param {boolean} free */
const tidy = (page, p, shift, free) => { const next = plus(p, shift), clean = cleaned(page, next, free ? 10 : 100); return next.map((v, k) => (Math.abs(shift[k]) < 1e-12 ? p[k] : clean[k])); };

/** The grip with a typed displacement in metres, or angle in degrees; a beginning such as "-" or "." is none yet, and what is no number is left out. @param {Grip} held @param {string} typed @returns {Grip} */
export function withTyped(held, typed) {
  const text = typed.replace(",", ".");
  if (held.handle.kind === "plane" || !/^-?\d*\.?\d*$/.test(text)) return held;
  const value = (Number(text) || 0) * (held.handle.kind === "turn" ? Math.PI / 180 : 1);
  return { ...held, typed: text, value, after: shifted(held, value) };
}

/** Text of a grip beside the pointer. @param {Grip} held */
export function gripText({ handle: { kind, axis }, value, typed, after }) {
  if (kind === "plane") return after.p.map((v) => Number(v.toPrecision(4))).join(", ");
  const shown = typed || Number((kind === "turn" ? (value * 180) / Math.PI : value).toPrecision(4));
  return `${kind === "turn" ? "about" : "along"} ${axis}  ${shown}${kind === "turn" ? "°" : " m"}`;
}

/** Draw the gizmo over the picture. @param {CanvasRenderingContext2D} ctx @param {Page} page @param {Pose} pose @param {Handle[]} list @param {Handle | null} active @param {boolean} held */
export function drawGizmo(ctx, page, pose, list, active, held) {
  const { view } = page.scene, toward = unit(minus(view.camera.position.toArray(), pose.p));
  ctx.save();
  ctx.lineCap = "round";
  for (const handle of [...list].reverse()) {
    const same = active?.kind === handle.kind && active.axis === handle.axis;
    if (held && !same) continue;
    const corners = outline(page, pose, handle), pixels = corners.map((p) => view.screen(p));
    if (pixels.some((pixel) => !pixel)) continue;
    [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth] = [axisColour(handle.axis), axisColour(handle.axis), same ? 4 : 2.4];
    if (handle.kind === "plane") {
      if (Math.abs(area(/** @type {Pixel[]} */ (pixels))) < 60) continue;
      path(ctx, pixels);
      ctx.closePath();
      ctx.globalAlpha = same ? 0.75 : 0.35;
      ctx.fill();
    } else if (handle.kind === "turn") {
      for (let k = 1; k < pixels.length; k++) {
        ctx.globalAlpha = dot(minus(corners[k], pose.p), toward) < -1e-9 * size(pose.p) && !same ? 0.22 : 1;
        path(ctx, [pixels[k - 1], pixels[k]]);
        ctx.stroke();
      }
    } else {
      ctx.globalAlpha = 1;
      arrowTo(ctx, /** @type {Pixel} */ (pixels[0]), /** @type {Pixel} */ (pixels[1]), handle.axis);
    }
    ctx.globalAlpha = 1;
  }
  ctx.restore();
}

/** @param {CanvasRenderingContext2D} ctx @param {(Pixel | null)[]} pixels */
function path(ctx, pixels) {
  ctx.beginPath();
  for (const pixel of pixels) if (pixel) ctx.lineTo(...pixel);
}

/** @param {CanvasRenderingContext2D} ctx @param {Pixel} from @param {Pixel} to @param {string} name */
function arrowTo(ctx, from, to, name) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (length < 6) return;
  const [u, v] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length], head = Math.min(13, length / 2), neck = /** @type {Pixel} */ ([to[0] - head * u, to[1] - head * v]);
  path(ctx, [from, neck]);
  ctx.stroke();
  path(ctx, [to, [neck[0] - 5.5 * v, neck[1] + 5.5 * u], [neck[0] + 5.5 * v, neck[1] - 5.5 * u]]);
  ctx.fill();
  ctx.font = "600 12px system-ui, sans-serif";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.fillText(name, to[0] + 10 * u, to[1] + 10 * v);
}
