// Symbols of planar scenes that follow the motion: drivers, rotational springs, belts, travels, limits, supports.

/** @import { Item, Pixel } from "./scene_types.d.ts" */
/** @import { PlanarPainter } from "./planar_painter.js" */

import { arrow, momentArc } from "./arrows.js";
import { circle, stroke, trace } from "./canvas.js";
import { TAU, clamp } from "./numbers.js";
import { hatch, hatchedLine } from "./planar_symbols.js";
import { Theme, mix } from "./theme.js";

/** Symbol → its drawing. @type {Record<string, (painter: PlanarPainter, item: Item) => void>} */
export const LOOKS = {
  spiral(painter, item) {
    const { ctx, half, colours } = painter, p = painter.place(item), turn = rotationBetween(painter, item);
    if (!p || turn === null) return;
    const from = painter.angleOf(item.i) ?? 0, to = from + 2.25 * TAU + turn, steps = 90;
    trace(ctx, Array.from({ length: steps + 1 }, (_, k) => {
      const share = k / steps, a = from + share * (to - from), r = (0.8 + 1.9 * share) * half;
      return /** @type {Pixel} */ ([p[0] + r * Math.cos(a), p[1] - r * Math.sin(a)]);
    }));
    ctx.lineJoin = ctx.lineCap = "round";
    stroke(ctx, colours.surface, 3.6);
    stroke(ctx, colours.spring, 1.6);
    ctx.lineCap = "butt";
  },

  brake(painter, item) {
    const { ctx, half, colours } = painter, p = painter.place(item), a = painter.angleOf(item.j);
    if (!p || a === null) return;
    circle(ctx, p, 3.1 * half);
    stroke(ctx, colours.ink, 1.3);
    for (const side of [0, Math.PI]) {
      ctx.beginPath();
      ctx.arc(p[0], p[1], 2.75 * half, side - a - 0.6, side - a + 0.6);
      stroke(ctx, colours.actuator, 0.6 * half);
    }
  },

  motor(painter, item) {
    const { ctx, half, colours } = painter, p = painter.place(item), r = 1.75 * half;
    if (!p) return;
    circle(ctx, p, r);
    ctx.fillStyle = colours.actuator;
    ctx.fill();
    stroke(ctx, colours.ink, 1.4);
    momentArc(ctx, p, 1.6 * r, 0.62 * TAU, colours.ink, colours.surface, 1.4);
  },

  travel(painter, item) {
    const { ctx, half, colours } = painter, p = painter.place(item), pose = painter.poses.get(item.on ?? painter.motion.ground), { axis } = item;
    if (!p || !pose || !axis) return;
    const size = Math.hypot(...axis) || 1, [x, y] = axis.map((v) => v / size);
    const [u, v] = [pose.c * x - pose.s * y, -(pose.s * x + pose.c * y)], reach = 4 * half + 6;
    for (const sign of [1, -1]) arrow(ctx, [p[0] + 2.6 * half * v, p[1] - 2.6 * half * u], [sign * reach * u, sign * reach * v], colours.drive, colours.surface, Math.max(2, 0.4 * half));
  },

  limit(painter, item) {
    const { ctx, half, colours, motion, scene } = painter, place = motion.placeOf(item), normal = motion.vectorOf(item.normal);
    if (!place || !normal?.every(Number.isFinite)) return;
    const p = scene.screen(place), r = 2.4 * half + 3, [u, v] = normal;
    if (p) hatchedLine(ctx, [p[0] - r * v, p[1] - r * u], [p[0] + r * v, p[1] + r * u], 1.4 * half, colours, 2);
  },

  support(painter, item) {
    const { ctx, colours, motion, scene } = painter, { mesh } = motion, [u, v] = item.axis ?? [0, -1];
    if (!mesh || !scene.show.supports) return;
    const size = motion.symbols.reduce((sum, { nodes }) => sum + nodes.length, 0) <= 12 ? 13 : 7;
    for (const node of item.nodes) {
      const p = scene.screen(mesh.placeOf(node, 2, scene.show.rest ? mesh.rest : mesh.places));
      const at = (/** @type {number} */ along, /** @type {number} */ across) => /** @type {Pixel} */ (p && [p[0] + size * (along * u + across * v), p[1] + size * (across * u - along * v)]);
      const ground = (/** @type {number} */ along, /** @type {number} */ wide) => {
        trace(ctx, [at(along, -wide), at(along, wide)]);
        stroke(ctx, colours.ink, 1.4);
        hatch(ctx, at(along, -wide), at(along, wide), colours.ink, 0.3 * size, 0.3 * size);
      };
      if (item.clamp) { ground(0, 0.9); continue; }
      trace(ctx, [at(0, 0), at(1, -0.6), at(1, 0.6)], true);
      ctx.fillStyle = colours.surface;
      ctx.fill();
      ctx.lineJoin = "round";
      stroke(ctx, colours.ink, 1.3);
      for (const across of item.roller ? [-0.35, 0.35] : []) { circle(ctx, at(1.17, across), 0.17 * size); stroke(ctx, colours.ink, 1.1); }
      ground(item.roller ? 1.34 : 1, 0.85);
    }
  },
};

/** Two wheels and the strands between them; a gearbox where both rotate about one axis. @param {PlanarPainter} painter @param {Item} item */
export function drawBelt(painter, { wheels, crossed }) {
  const { ctx, colours, half, view } = painter, centres = wheels.map((wheel) => painter.place(wheel)), [p, q] = centres;
  if (!p || !q) return;
  const [dx, dy] = [q[0] - p[0], q[1] - p[1]], d = Math.hypot(dx, dy), [r, s] = wheels.map(({ radius }) => radius * view.s);
  if (d < 2 * half) return gearbox(painter, p);
  wheels.forEach(({ body }, k) => {
    const c = k ? q : p, a = painter.angleOf(body) ?? 0, radius = k ? s : r;
    circle(ctx, c, radius);
    ctx.fillStyle = mix(Theme.surface, Theme.ink, 0.06);
    ctx.globalAlpha = 0.8;
    ctx.fill();
    ctx.globalAlpha = 1;
    stroke(ctx, colours.ink, 1.2);
    trace(ctx, [c, [c[0] + radius * Math.cos(a), c[1] - radius * Math.sin(a)]]);
    stroke(ctx, colours.ink, 1.2);
  });
  const signed = crossed ? -s : s, way = Math.atan2(dy, dx), open = Math.acos(clamp((r - signed) / d, -1, 1));
  for (const side of [-open, open]) {
    const u = [Math.cos(way + side), Math.sin(way + side)];
    trace(ctx, [[p[0] + r * u[0], p[1] + r * u[1]], [q[0] + signed * u[0], q[1] + signed * u[1]]]);
    stroke(ctx, colours.ink, 2.4);
  }
}

/** Fixed ratio between two shafts on one axis. @param {PlanarPainter} painter @param {Pixel} centre */
function gearbox({ ctx, half: h, colours }, [x, y]) {
  ctx.beginPath();
  ctx.roundRect(x - 2.4 * h, y - 1.8 * h, 4.8 * h, 3.6 * h, 0.5 * h);
  ctx.fillStyle = colours.actuator;
  ctx.fill();
  stroke(ctx, colours.ink, 1.4);
  for (const [k, r] of [[-0.75, 0.8], [0.85, 1.1]]) { circle(ctx, [x + k * h, y], r * h); stroke(ctx, colours.ink, 1.1); }
}

/** Relative rotation of the second body since the start. @param {PlanarPainter} painter @param {Item} item */
function rotationBetween(painter, { i, j }) {
  const [a, b] = [painter.angleOf(i), painter.angleOf(j)];
  if (a === null || b === null) return null;
  const [from, to] = [i, j].map((body) => painter.motion.pose(body, { i: 0, f: 0 })?.a ?? 0);
  return b - a - (to - from);
}
