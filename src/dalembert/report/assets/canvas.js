// Lines on a canvas.

/** @import { Context } from "./types.d.ts" */

import { TAU } from "./numbers.js";

export const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

/** @param {HTMLCanvasElement} canvas */
export const contextOf = (canvas) => /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));

/** Clear a canvas of the resolution of the screen; the context draws in CSS pixels.
 * @param {HTMLCanvasElement} canvas */
export function fitCanvas(canvas, ratio = window.devicePixelRatio || 1) {
  const { clientWidth: w, clientHeight: h } = canvas;
  const [pw, ph] = [Math.max(1, Math.round(w * ratio)), Math.max(1, Math.round(h * ratio))];
  if (canvas.width !== pw || canvas.height !== ph) [canvas.width, canvas.height] = [pw, ph];
  const ctx = contextOf(canvas);
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, w, h);
  return { ctx, w, h };
}

/** @param {Context} ctx @param {string} colour @param {number[]} dash */
export function stroke(ctx, colour, width = 1.25, dash = []) {
  ctx.strokeStyle = colour;
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.stroke();
  if (dash.length) ctx.setLineDash([]);
}

/** @param {Context} ctx @param {[number, number][]} points */
export function trace(ctx, points, closed = false) {
  ctx.beginPath();
  points.forEach(([x, y], k) => (k ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
  if (closed) ctx.closePath();
}

/** @param {Context} ctx @param {[number, number]} centre @param {number} r */
export function circle(ctx, [x, y], r) {
  ctx.beginPath();
  ctx.arc(x, y, Math.max(0, r), 0, TAU);
}
