// Overlays of planar mechanisms: curves, velocities, instant centres, limit positions, transmission angles.

/** @import { Page } from "./pictures.js" */
/** @import { Twist, Vector } from "./plane_kinematics.js" */

import { GROUND, accelerationAt, crankAngle, deadCentres, instantCentre, transmissions, twistOf, velocityAt } from "./plane_kinematics.js";
import { elementAt, inBody } from "./snapping.js";
import { pathSizes, sweptOf } from "./swept.js";

/** Length of the longest arrow [pixels], and the instants over which it is sought. */
const ARROW = 90, SAMPLES = 60;
/** Distance from the edge of the picture beyond which instant centres are not drawn [pixels]. */
const BEYOND = 40;

/** A drawing over the picture. @typedef {{ name: string, title: string, key: string, note: string, draw: (pen: Pen) => void }} Overlay */

/** Pen of a picture: places in metres, colours of the theme. */
class Pen {
  /** @param {CanvasRenderingContext2D} ctx @param {Page} page @param {Vector | null} pointer [pixels] @param {Set<string>} selected */
  constructor(ctx, page, pointer, selected) {
    const style = getComputedStyle(document.documentElement), { motion, scene } = page;
    this.ctx = ctx; this.page = page; this.motion = motion; this.scene = scene; this.pointer = pointer; this.selected = selected;
    /** @param {string} name */
    this.colour = (name) => style.getPropertyValue(`--${name}`).trim();
    /** Bodies with a motion of their own. @type {{ body: any, twist: Twist }[]} */
    this.moving = motion.bodies.filter((/** @type {any} */ body) => !body.of && !body.node).flatMap((/** @type {any} */ body) => { const twist = twistOf(motion, body); return twist ? [{ body, twist }] : []; });
  }

  /** @param {Vector} place @returns {Vector} */
  at(place) { return this.scene.view.screen(place); }

  /** @param {Vector[]} places [pixels] @param {string} colour @param {number} width @param {number[]} dash */
  line(places, colour, width = 1.6, dash = []) {
    const { ctx } = this;
    ctx.setLineDash(dash);
    ctx.beginPath();
    for (const place of places) ctx.lineTo(...place);
    [ctx.strokeStyle, ctx.lineWidth, ctx.lineJoin, ctx.lineCap] = [colour, width, "round", "round"];
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /** @param {Vector} place [pixels] @param {Vector} vector [pixels, y down] @param {string} colour */
  arrow(place, [u, v], colour) {
    const size = Math.hypot(u, v);
    if (size < 2) return;
    const head = Math.min(9, size / 2), [tx, ty] = [u / size, v / size], tip = /** @type {Vector} */ ([place[0] + u, place[1] + v]), neck = /** @type {Vector} */ ([tip[0] - tx * head, tip[1] - ty * head]);
    this.line([place, neck], colour, 2);
    const { ctx } = this;
    ctx.beginPath();
    for (const corner of [tip, [neck[0] - ty * head * 0.4, neck[1] + tx * head * 0.4], [neck[0] + ty * head * 0.4, neck[1] - tx * head * 0.4]]) ctx.lineTo(corner[0], corner[1]);
    ctx.fillStyle = colour;
    ctx.fill();
  }

  /** @param {string} text @param {Vector} place [pixels] @param {string} colour */
  text(text, [x, y], colour) {
    const { ctx } = this;
    [ctx.font, ctx.lineWidth, ctx.strokeStyle, ctx.fillStyle] = ["12px system-ui, sans-serif", 4, this.colour("surface"), colour];
    ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
  }

  /** The body under the pointer, and the place there. */
  get target() {
    const hit = this.pointer && elementAt(this.page, this.pointer), body = hit && this.motion.byName.get(hit.name);
    if (!body || !this.pointer) return null;
    const [x, y] = this.scene.view.world(this.pointer), owner = body.of ?? body;
    return { body: owner, place: /** @type {Vector} */ ([x, y]), point: inBody(this.page, owner.name, x, y) };
  }

  /** Named points, centres of bodies and the point under the pointer, with the motion of their bodies. @returns {{ place: Vector, twist: Twist }[]} */
  get points() {
    const twists = new Map(this.moving.map(({ body, twist }) => [body, twist])), { target } = this, seen = new Set();
    const named = this.motion.points.flatMap((/** @type {any} */ { body, point }) => {
      const twist = twists.get(body.of ?? body), place = this.motion.at(body, point), key = place && this.at(place).map(Math.round).join();
      if (!twist || !place || seen.has(key)) return [];
      seen.add(key);
      return [{ place, twist }];
    });
    const centres = this.moving.map(({ twist }) => ({ place: /** @type {Vector} */ ([twist.x, twist.y]), twist })), own = target && twists.get(target.body);
    return [...named, ...centres, ...(target && own ? [{ place: target.place, twist: own }] : [])];
  }
}

/** Scales of arrows, by motion: pixels per unit. @type {WeakMap<object, Record<string, number>>} */
const scales = new WeakMap();

/** Scale by which the longest arrow of named points over the motion has a fixed length. @param {any} motion @param {string} kind @param {(twist: Twist, place: Vector) => Vector} vector */
function scaleOf(motion, kind, vector) {
  const key = motion.series[0]?.values ?? motion, known = scales.get(key) ?? {};
  if (!(kind in known)) {
    let most = 0;
    for (const cursor of motion.frames(SAMPLES)) for (const { body, point } of motion.points) {
      const twist = twistOf(motion, body, cursor), place = motion.at(body, point, cursor);
      if (twist && place) most = Math.max(most, Math.hypot(...vector(twist, place)) || 0);
    }
    known[kind] = most > 0 ? ARROW / most : 0;
    scales.set(key, known);
  }
  return known[kind];
}

/** @param {Pen} pen @param {string} kind @param {(twist: Twist, place: Vector) => Vector} vector @param {string} colour @param {string} unit */
function drawVectors(pen, kind, vector, colour, unit) {
  const scale = scaleOf(pen.motion, kind, vector), { target } = pen;
  for (const { place, twist } of pen.points) {
    const [u, v] = vector(twist, place);
    pen.arrow(pen.at(place), [u * scale, -v * scale], colour);
    if (target && place === target.place) pen.text(`${Number(Math.hypot(u, v).toPrecision(4))} ${unit}`, [pen.at(place)[0] + 14, pen.at(place)[1] + (kind === "velocity" ? 22 : 38)], colour);
  }
}

/** @param {Pen} pen @param {Vector} place @param {string} label @param {string} colour */
function drawCentre(pen, place, label, colour) {
  const [x, y] = pen.at(place), { canvas } = pen.scene;
  if (x < -BEYOND || y < -BEYOND || x > canvas.clientWidth + BEYOND || y > canvas.clientHeight + BEYOND) return;
  pen.line([[x - 6, y], [x + 6, y]], colour, 2);
  pen.line([[x, y - 6], [x, y + 6]], colour, 2);
  pen.text(label, [x + 8, y - 8], colour);
}

/** Lines of a body at an instant: between its named points. @param {Pen} pen @param {any} body @param {{ i: number, f: number }} cursor @returns {Vector[]} */
function skeleton({ motion, at }, body, cursor) {
  return motion.points.filter((/** @type {any} */ point) => point.body === body).flatMap((/** @type {any} */ { point }) => { const place = motion.at(body, point, cursor); return place ? [place] : []; });
}

/** @param {number} angle */
const degrees = (angle) => `${Number(((angle * 180) / Math.PI).toFixed(1))}°`;

/** Least transmission angle of a motion, by its poses. @type {WeakMap<object, Map<string, number>>} */
const least = new WeakMap();

/** @param {any} motion @param {string} name of the follower */
function leastTransmission(motion, name) {
  const key = motion.series[0]?.values ?? motion, known = least.get(key) ?? new Map();
  if (!known.size) {
    for (let i = 0; i < motion.n; i++) for (const { body, angle } of transmissions(motion, { i, f: 0 })) known.set(body.name, Math.min(angle, known.get(body.name) ?? Infinity));
    least.set(key, known);
  }
  return known.get(name) ?? NaN;
}

/** @type {Overlay[]} */
export const OVERLAYS = [
  { name: "curve", title: "Curve under the pointer", key: "1", note: "Path of the point of a body under the pointer", draw(pen) {
    const { target, motion } = pen;
    if (!target) return;
    const path = motion.frames(400).flatMap((/** @type {any} */ cursor) => { const place = motion.at(target.body, target.point, cursor); return place ? [pen.at(place)] : []; });
    pen.line(path, pen.colour("accent"), 2);
    const [x, y] = pen.at(target.place), { length, area } = pathSizes(motion, target.body, target.point);
    pen.line([[x - 3, y], [x + 3, y]], pen.colour("accent"), 6);
    pen.text(`${Number(length.toPrecision(4))} m${area === null ? "" : `, encloses ${Number(area.toPrecision(4))} m²`}`, [x + 14, y + 6], pen.colour("accent"));
  } },
  { name: "velocity", title: "Velocities", key: "2", note: "Velocities of points", draw: (pen) => drawVectors(pen, "velocity", velocityAt, pen.colour("good"), "m/s") },
  { name: "acceleration", title: "Accelerations", key: "3", note: "Accelerations of points", draw: (pen) => drawVectors(pen, "acceleration", accelerationAt, pen.colour("warning"), "m/s²") },
  { name: "centres", title: "Instant centres", key: "4", note: "Instant centre of each body with the ground, and where two bodies have the same velocity", draw(pen) {
    const { moving } = pen;
    moving.forEach(({ body, twist }, k) => {
      const centre = instantCentre(twist, GROUND);
      if (centre) drawCentre(pen, centre, `${body.name}/ground`, pen.colour("accent"));
      for (const other of moving.slice(k + 1)) {
        const shared = instantCentre(twist, other.twist);
        if (shared) drawCentre(pen, shared, `${body.name}/${other.body.name}`, pen.colour("muted"));
      }
    });
  } },
  { name: "limits", title: "Dead centres", key: "5", note: "Limit positions, in which a rocker or slider turns back: both dead centres of the linkage for this member as input, with the angle of the crank and the ratio of the times between them", draw(pen) {
    const { motion } = pen, positions = deadCentres(motion).slice(0, 8), bodies = pen.moving.map(({ body }) => body);
    for (const { body, cursor, stroke } of positions) {
      for (const each of bodies) {
        const places = skeleton(pen, each, cursor).map((place) => pen.at(place));
        if (places.length > 1) pen.line(places, each === body ? pen.colour("error") : pen.colour("muted"), each === body ? 2.4 : 1.2, [5, 4]);
      }
      const pose = motion.pose(body, cursor);
      const own = positions.filter((other) => other.body === body), number = own.findIndex((other) => other.cursor === cursor) + 1, crank = crankAngle(motion, cursor), back = own[2 - number]?.stroke;
      const ratio = own.length === 2 && number === 1 && stroke > 0 && back > 0 ? `, times 1 : ${Number((back / stroke).toPrecision(3))}` : "";
      if (pose) pen.text(`${number}. ${body.name} ${degrees(pose.a)}${crank ? `, ${crank.name} ${degrees(crank.angle - 2 * Math.PI * Math.floor(crank.angle / (2 * Math.PI)))}` : ""}${ratio}`, pen.at([pose.x, pose.y]), pen.colour("error"));
    }
  } },
  { name: "swept", title: "Swept area", key: "7", note: "Area over which the body under the pointer, or the selected one, moves", draw(pen) {
    const { motion, target } = pen, body = target?.body ?? motion.bodies.find((/** @type {any} */ item) => pen.selected.has(item.name)) ?? null;
    if (!body) return;
    const { ctx } = pen, shown = sweptOf(motion, body), path = new Path2D();
    for (const polygon of shown.polygons) {
      polygon.forEach((place, k) => (k ? path.lineTo(...pen.at(place)) : path.moveTo(...pen.at(place))));
      path.closePath();
    }
    [ctx.fillStyle, ctx.globalAlpha] = [pen.colour("accent"), 0.18];
    ctx.fill(path, "nonzero");
    ctx.globalAlpha = 1;
    const at = target?.place ?? [motion.pose(body)?.x ?? 0, motion.pose(body)?.y ?? 0];
    pen.text(`${body.name} sweeps ${Number(shown.area.toPrecision(3))} m²`, [pen.at(/** @type {Vector} */ (at))[0] + 14, pen.at(/** @type {Vector} */ (at))[1] + 22], pen.colour("accent"));
  } },
  { name: "transmission", title: "Transmission angle", key: "6", note: "Angle between coupler and follower, with its minimum over the motion", draw(pen) {
    for (const { body, place, arms: [along, arm], angle } of transmissions(pen.motion)) {
      const [x, y] = pen.at(place), from = Math.atan2(-along[1], along[0]);
      let to = Math.atan2(-arm[1], arm[0]);
      if (Math.abs(Math.atan2(Math.sin(to - from), Math.cos(to - from))) > Math.PI / 2) to += Math.PI;
      const sweep = Math.atan2(Math.sin(to - from), Math.cos(to - from)), colour = pen.colour(angle < (40 * Math.PI) / 180 ? "error" : "accent"), { ctx } = pen;
      ctx.beginPath();
      ctx.arc(x, y, 30, from, from + sweep, sweep < 0);
      [ctx.strokeStyle, ctx.lineWidth] = [colour, 2.4];
      ctx.stroke();
      pen.text(`${degrees(angle)}, minimum ${degrees(leastTransmission(pen.motion, body.name))}`, [x + 36 * Math.cos(from + sweep / 2), y + 36 * Math.sin(from + sweep / 2)], colour);
    }
  } },
];

/** @param {CanvasRenderingContext2D} ctx @param {Page} page @param {Set<string>} shown @param {Vector | null} pointer @param {Set<string>} selected */
export function drawOverlays(ctx, page, shown, pointer, selected) {
  ctx.save();
  const pen = new Pen(ctx, page, pointer, selected);
  for (const { name, draw } of OVERLAYS) if (shown.has(name)) draw(pen);
  ctx.restore();
}
