// Symbols of engineering drawings. All lengths are in pixels, y points down.

/** @import { Context } from "./types.d.ts" */
/** @import { Item, Pixel, Teeth } from "./scene_types.d.ts" */

import { circle, stroke, trace } from "./canvas.js";
import { TAU, clamp } from "./numbers.js";

/** Colours of a body, and the width of its edges.
 * @typedef {{ fill: string, edge: string, text: string, width: number }} Look */
/** Colours of symbols.
 * @typedef {Record<"ink" | "surface" | "ground" | "spring" | "actuator" | "muted" | "drive", string>} Colours */

/** Bar, or plate with rounded corners: one thick stroke inside another. @param {Context} ctx @param {Pixel[]} points @param {number} half @param {Look} look */
export function plate(ctx, points, half, look) {
  ctx.lineJoin = ctx.lineCap = "round";
  trace(ctx, points, points.length > 2);
  stroke(ctx, look.edge, 2 * half + look.width);
  stroke(ctx, look.fill, 2 * half - look.width);
  if (points.length > 2) {
    ctx.fillStyle = look.fill;
    ctx.fill();
  }
  ctx.lineCap = "butt";
}

/** Fill the path and draw its edge. @param {Context} ctx @param {Look} look */
export function solid(ctx, look) {
  ctx.fillStyle = look.fill;
  ctx.fill();
  ctx.lineJoin = "round";
  stroke(ctx, look.edge, look.width);
}

/** Wheel, with a heavy spoke that shows its rotation; a gear with its pitch circle. @param {Context} ctx @param {Pixel} c @param {number} r @param {number} angle @param {Look} look @param {Teeth} [teeth] */
export function wheel(ctx, c, r, angle, look, teeth) {
  const at = (/** @type {number} */ k, /** @type {number} */ a) => /** @type {Pixel} */ ([c[0] + k * r * Math.cos(a), c[1] - k * r * Math.sin(a)]);
  ctx.lineJoin = "round";
  if (teeth?.ring) {
    circle(ctx, c, 1.09 * r);
    stroke(ctx, look.fill, 0.18 * r);
    circle(ctx, c, 1.18 * r);
    stroke(ctx, look.edge, look.width);
    gearRim(ctx, c, r, angle, teeth);
    stroke(ctx, look.edge, look.width);
    trace(ctx, [at(1.1, angle), at(1.18, angle)]);
    return stroke(ctx, look.edge, clamp(0.08 * r, 1.5, 4));
  }
  if (teeth) gearRim(ctx, c, r, angle, teeth); else circle(ctx, c, Math.max(1, r));
  ctx.globalAlpha = 0.82;
  ctx.fillStyle = look.fill;
  ctx.fill();
  ctx.globalAlpha = 1;
  stroke(ctx, look.edge, look.width);
  if (teeth) {
    circle(ctx, c, r);
    stroke(ctx, look.edge, 0.8, [8, 3, 2, 3]);
  } else if (r > 14) {
    circle(ctx, c, 0.86 * r);
    stroke(ctx, look.edge, 0.6);
  }
  ctx.lineCap = "round";
  trace(ctx, [c, at(teeth ? 0.8 : 0.86, angle)]);
  stroke(ctx, look.edge, clamp(0.08 * r, 1.5, 4));
  ctx.lineCap = "butt";
  for (const k of r > 24 ? [1, 2] : []) {
    trace(ctx, [at(0.2, angle + (k * TAU) / 3), at(teeth ? 0.78 : 0.84, angle + (k * TAU) / 3)]);
    stroke(ctx, look.edge, 0.8);
  }
  circle(ctx, c, clamp(0.18 * r, 2, 16));
  solid(ctx, look);
}

/** Path of schematic teeth about the pitch circle. @param {Context} ctx @param {Pixel} centre @param {number} r @param {number} angle @param {Teeth} teeth */
function gearRim(ctx, [x, y], r, angle, { count, toward, gap, ring }) {
  const pitch = TAU / count, high = Math.min(0.3 * pitch * r, 0.12 * r) * (ring ? -1 : 1), phase = angle + Math.atan2(toward[1], toward[0]) + (gap ? pitch / 2 : 0);
  const corners = Array.from({ length: count }, (_, k) => [[-0.34, -high], [-0.14, high], [0.14, high], [0.34, -high]].map(([share, dr]) => {
    const a = phase + (k + share) * pitch;
    return /** @type {Pixel} */ ([x + (r + dr) * Math.cos(a), y - (r + dr) * Math.sin(a)]);
  })).flat();
  trace(ctx, corners, true);
}

/** Short strokes to the right of a line. @param {Context} ctx @param {Pixel} a @param {Pixel} b @param {string} colour */
export function hatch(ctx, a, b, colour, gap = 7, size = 7) {
  const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy);
  if (length < 2) return;
  const count = Math.min(400, Math.max(2, Math.round(length / gap)));
  const [tx, ty] = [dx / length, dy / length];
  ctx.beginPath();
  for (let k = 0; k < count; k++) {
    const s = ((k + 0.7) * length) / count;
    const [x, y] = [a[0] + tx * s, a[1] + ty * s];
    ctx.moveTo(x, y);
    ctx.lineTo(x - tx * size * 0.75 - ty * size, y - ty * size * 0.75 + tx * size);
  }
  stroke(ctx, colour, 1);
}

/** Bracket of a pin on hatched ground; `tilt` rotates its foot away from straight below. @param {Context} ctx @param {Pixel} pin @param {number} h @param {Colours} colours */
export function groundPivot(ctx, [x, y], h, colours, tilt = 0) {
  const base = y + 2.5 * h, half = 1.75 * h;
  ctx.save();
  ctx.translate(x, y);
  ctx.rotate(tilt);
  ctx.translate(-x, -y);
  ctx.lineJoin = "round";
  ctx.beginPath();
  ctx.moveTo(x - 0.75 * h, y - 0.1 * h);
  ctx.arc(x, y, 0.8 * h, Math.PI, 0);
  ctx.lineTo(x + half, base);
  ctx.lineTo(x - half, base);
  ctx.closePath();
  ctx.fillStyle = colours.ground;
  ctx.fill();
  stroke(ctx, colours.ink, 1.4);
  hatchedLine(ctx, [x - 2.5 * h, base], [x + 2.5 * h, base], h, colours);
  ctx.restore();
}

/** Line of the ground, hatched to its right. @param {Context} ctx @param {Pixel} a @param {Pixel} b @param {number} h @param {Colours} colours */
export function hatchedLine(ctx, a, b, h, colours, width = 1.8) {
  trace(ctx, [a, b]);
  stroke(ctx, colours.ink, width);
  hatch(ctx, a, b, colours.ink, Math.max(3.5, 0.7 * h), 0.8 * h);
}

/** @param {Context} ctx @param {Pixel} centre @param {number} r @param {Colours} colours */
function pin(ctx, [x, y], r, colours) {
  circle(ctx, [x, y], r);
  ctx.fillStyle = colours.surface;
  ctx.fill();
  stroke(ctx, colours.ink, Math.max(1.2, 0.3 * r));
}

/** @param {Context} ctx @param {Item} joint @param {Pixel} p @param {number} h @param {Colours} colours */
export function jointMark(ctx, joint, p, h, colours) {
  const r = clamp(0.52 * h, 2, 7);
  switch (joint.symbol) {
    case "pin": return pin(ctx, p, r, colours);
    case "slotpin":
      pin(ctx, p, r, colours);
      circle(ctx, p, 0.35 * r);
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    case "contact":
    case "slider":
      circle(ctx, p, Math.max(1.5, 0.3 * r));
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    case "clamp":
      trace(ctx, [[p[0] - r, p[1] - r], [p[0] + r, p[1] + r]]);
      stroke(ctx, colours.ink, 1.8);
      trace(ctx, [[p[0] - r, p[1] + r], [p[0] + r, p[1] - r]]);
      return stroke(ctx, colours.ink, 1.8);
    case "belt": return;
    case "mesh":
      circle(ctx, p, Math.max(1.5, 0.35 * r));
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    default:
      trace(ctx, [[p[0], p[1] - r], [p[0] + r, p[1]], [p[0], p[1] + r], [p[0] - r, p[1]]], true);
      ctx.fillStyle = colours.surface;
      ctx.fill();
      return stroke(ctx, colours.ink, 1.5);
  }
}

/** Circle with two dark quarters: a centre of mass. @param {Context} ctx @param {Pixel} centre @param {number} r @param {string} ink @param {string} surface */
export function centreMark(ctx, [x, y], r, ink, surface) {
  circle(ctx, [x, y], r);
  ctx.fillStyle = surface;
  ctx.fill();
  ctx.fillStyle = ink;
  for (const a of [0, Math.PI]) {
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.arc(x, y, r, a, a + Math.PI / 2);
    ctx.fill();
  }
  circle(ctx, [x, y], r);
  stroke(ctx, ink, 1.3);
}

/** Primitives between two points; rigid parts keep their share of the mean length `rest`.
 * @type {Record<string, (ctx: Context, L: number, h: number, rest: number, c: Colours) => void>} */
const LINKS = {
  coil(ctx, L, h, rest, c) {
    const lead = Math.min(0.14 * rest, 0.3 * L), wide = 1.15 * h, coils = 8;
    const points = /** @type {Pixel[]} */ ([[0, 0], [lead, 0]]);
    for (let k = 0; k < 2 * coils; k++) {
      points.push([lead + ((k + 0.5) * (L - 2 * lead)) / (2 * coils), k % 2 ? wide : -wide]);
    }
    points.push([L - lead, 0], [L, 0]);
    trace(ctx, points);
    ctx.lineJoin = "round";
    stroke(ctx, c.surface, 4);
    stroke(ctx, c.spring, 1.8);
  },
  dashpot(ctx, L, h, rest, c) {
    const a = 0.28 * rest, b = a + 0.4 * rest, wide = 0.95 * h;
    const head = clamp(L - 0.48 * rest, a + 2, Math.max(a + 2, Math.min(b - 1, L - 1)));
    ctx.beginPath();
    ctx.rect(a, -wide, b - a, 2 * wide);
    ctx.fillStyle = c.ground;
    ctx.fill();
    trace(ctx, [[b, -wide], [a, -wide], [a, wide], [b, wide]]);
    stroke(ctx, c.ink, 1.6);
    trace(ctx, [[0, 0], [a, 0]]);
    stroke(ctx, c.ink, 1.6);
    trace(ctx, [[head, -0.78 * wide], [head, 0.78 * wide]]);
    stroke(ctx, c.ink, 2.6);
    trace(ctx, [[head, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.6);
  },
  cylinder(ctx, L, h, rest, c) {
    const body = Math.min(0.58 * rest, 0.85 * L), wide = 0.9 * h;
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, Math.max(2.5, 0.6 * h));
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.surface, Math.max(1, 0.6 * h - 2));
    ctx.beginPath();
    ctx.roundRect(0.06 * rest, -wide, Math.max(1, body - 0.06 * rest), 2 * wide, 0.3 * h);
    ctx.fillStyle = c.actuator;
    ctx.fill();
    stroke(ctx, c.ink, 1.4);
    trace(ctx, [[body - 0.35 * h, -wide], [body - 0.35 * h, wide]]);
    stroke(ctx, c.ink, 1.1);
  },
  sleeve(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.4);
    for (const [r, fill] of /** @type {[number, string][]} */ ([[1.5 * h, c.actuator], [0.75 * h, c.surface]])) {
      circle(ctx, [L / 2, 0], r);
      ctx.fillStyle = fill;
      ctx.fill();
      stroke(ctx, c.ink, 1.3);
    }
  },
  strand(ctx, L, h, rest, c) {
    ctx.lineCap = "round";
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, Math.min(9, Math.max(3, 0.8 * h)));
    ctx.lineCap = "butt";
  },
  tie(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.4, [9, 3, 2, 3]);
  },
  rod(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 4.5);
    stroke(ctx, c.surface, 1.8);
  },
};

/** @param {Context} ctx @param {string} kind @param {Pixel} p @param {Pixel} q @param {number} h @param {number} rest @param {number} offset @param {Colours} colours */
export function linkSymbol(ctx, kind, p, q, h, rest, offset, colours) {
  const L = Math.hypot(q[0] - p[0], q[1] - p[1]);
  ctx.save();
  ctx.translate(p[0], p[1]);
  ctx.rotate(Math.atan2(q[1] - p[1], q[0] - p[0]));
  if (offset) {
    for (const x of [0, L]) {
      trace(ctx, [[x, 0], [x, offset]]);
      stroke(ctx, colours.ink, 1.4);
    }
    ctx.translate(0, offset);
  }
  (LINKS[kind] || LINKS.rod)(ctx, L, h, rest, colours);
  ctx.restore();
}
