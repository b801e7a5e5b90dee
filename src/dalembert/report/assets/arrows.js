// Arrows, arcs of moments and texts on a canvas. All lengths are in pixels, y points down.

/** @import { Context } from "./types.d.ts" */
/** @import { Pixel } from "./scene_types.d.ts" */

import { stroke, trace } from "./canvas.js";

/** Arrow with one head, or with two for a moment. @param {Context} ctx @param {Pixel} from @param {Pixel} way @param {string} colour @param {string} surface colour of the halo; "" for none */
export function arrow(ctx, [x, y], [u, v], colour, surface, width = 2.4, heads = 1) {
  const length = Math.hypot(u, v);
  if (length < 1.5) return;
  const head = Math.min(11, 6 * width, (0.6 * length) / heads), [tx, ty] = [u / length, v / length], wide = 0.42 * head;
  const at = (/** @type {number} */ back) => /** @type {Pixel} */ ([x + u - tx * back, y + v - ty * back]);
  ctx.lineCap = "round";
  trace(ctx, [[x, y], at(head)]);
  if (surface) stroke(ctx, surface, width + 2.5);
  stroke(ctx, colour, width);
  ctx.lineCap = "butt";
  for (let k = 0; k < heads; k++) {
    const tip = at(0.8 * k * head), neck = at((0.8 * k + 1) * head);
    trace(ctx, [tip, [neck[0] - ty * wide, neck[1] + tx * wide], [neck[0] + ty * wide, neck[1] - tx * wide]], true);
    ctx.lineJoin = "round";
    if (surface) stroke(ctx, surface, 2);
    ctx.fillStyle = colour;
    ctx.fill();
  }
}

/** Arc with an arrow head; a positive `sweep` turns counter-clockwise. @param {Context} ctx @param {Pixel} centre @param {number} r @param {number} sweep @param {string} colour @param {string} surface */
export function momentArc(ctx, [x, y], r, sweep, colour, surface, width = 2.2) {
  if (Math.abs(sweep) * r < 3) return;
  const from = -Math.PI / 2, to = from - sweep, back = sweep > 0;
  ctx.beginPath();
  ctx.arc(x, y, r, from, to, back);
  stroke(ctx, surface, width + 2.3);
  stroke(ctx, colour, width);
  const size = Math.min(8, r, Math.abs(sweep) * r), side = back ? -1 : 1;
  const [ex, ey] = [x + r * Math.cos(to), y + r * Math.sin(to)], [tx, ty] = [-size * side * Math.sin(to), size * side * Math.cos(to)];
  trace(ctx, [[ex + 0.6 * tx, ey + 0.6 * ty], [ex - 0.5 * (tx + ty), ey - 0.5 * (ty - tx)], [ex - 0.5 * (tx - ty), ey - 0.5 * (ty + tx)]], true);
  ctx.fillStyle = colour;
  ctx.fill();
}

/** Text with a halo. @param {Context} ctx @param {string} text @param {Pixel} place @param {string} colour @param {string} surface @param {CanvasTextAlign} align */
export function label(ctx, text, [x, y], colour, surface, align = "center") {
  Object.assign(ctx, { textAlign: align, textBaseline: "middle", lineJoin: "round", strokeStyle: surface, lineWidth: 4, fillStyle: colour });
  ctx.strokeText(text, x, y);
  ctx.fillText(text, x, y);
}
