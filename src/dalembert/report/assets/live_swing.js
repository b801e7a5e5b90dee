// Rows of the picture of an oscillation in a live page.

/** @import { Matrix } from "./live_matrix.js" */
/** @import { LiveRun } from "./live_run.js" */

import { dot, solved } from "./live_matrix.js";

/** Share of the largest displacement from which one counts as the largest. */
const LEADING = 1 - 1e-6;

/** Rows of the picture of a complex change of the coordinates; its largest displacement is one.
 * @param {LiveRun} run @param {Float64Array} x state @param {Float64Array} p @param {Matrix} g its constraints @param {Float64Array} re @param {Float64Array} im */
export function swingPicture(run, x, p, g, re, im) {
  const { engine, data } = run, count = data.coordinates ?? 0;
  if (!engine.functions.has("pictures")) return [];
  const sizes = re.map((value, i) => Math.hypot(value, im[i])), most = Math.max(0, ...sizes), peak = sizes.findIndex((size) => size >= LEADING * most), square = most ? sizes[peak] ** 2 : 1;
  const [c, d] = most ? [re[peak] / square, -im[peak] / square] : [1, 0];
  const real = re.map((value, i) => c * value - d * im[i]), imag = re.map((value, i) => c * im[i] + d * value), y = x.subarray(0, count);
  const squares = [[real, real], [real, imag], [imag, imag]].map(([a, b]) => closingMotion(run, y, p, g, a, b));
  return engine.evaluate("pictures", [data.start], y, p, real, imag, ...squares)?.[0] ?? [];
}

/** Smallest displacement of second order that closes the joints. @param {LiveRun} run @param {Float64Array} y @param {Float64Array} p @param {Matrix} g @param {Float64Array} a @param {Float64Array} b */
function closingMotion({ engine, data }, y, p, g, a, b) {
  const { states, rows } = /** @type {{ states: number[], rows: number[] }} */ (data.sizes), [open = new Float64Array()] = engine.evaluate("curvature", [data.start], y, p, a, b) ?? [];
  const level = g.slice(0, open.length).map((row) => row.subarray(0, y.length)), right = Array.from(open, (value, i) => Float64Array.of(-value / rows[i]));
  const weights = open.length ? solved(level.map((row) => Float64Array.from(level, (other) => dot(row, other))), right) : [];
  return y.map((_, k) => states[k] * level.reduce((sum, row, i) => sum + row[k] * weights[i][0], 0));
}
