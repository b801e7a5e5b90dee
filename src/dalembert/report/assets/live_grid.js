// Frequencies that resolve resonances, and exact maxima between them: as `frequency_grid` of Python.

/** @import { LiveGrid } from "./types.d.ts" */

/** Radians of a turn. */
export const TURN_ANGLE = 2 * Math.PI;

/** Evenly spaced numbers. @param {number} from @param {number} to @param {number} count */
const even = (from, to, count) => Array.from({ length: count }, (_, k) => from + ((to - from) * k) / (count - 1));

/** Increasing distinct numbers. @param {number[]} values */
export const distinct = (values) => Array.from(new Set(values)).sort((a, b) => a - b);

/** Eigenvalues of oscillations without damping. @param {[number, number][]} poles @param {LiveGrid} grid */
export function undampedPoles(poles, { undamped, rounding }) {
  const largest = Math.max(0, ...poles.map(([re, im]) => Math.hypot(re, im)));
  return poles.filter(([re, im]) => im > 0 && Math.abs(re) <= undamped * Math.hypot(re, im) + rounding * largest);
}

/** Frequencies [Hz], denser at resonances; undamped ones are left out. @param {[number, number][]} poles @param {LiveGrid} grid */
export function defaultFrequencies(poles, grid) {
  const sizes = (/** @type {[number, number][]} */ values) => values.map(([re, im]) => Math.hypot(re, im)).filter((size) => size > 0).sort((a, b) => a - b);
  const oscillating = poles.filter(([, im]) => im > 0), natural = oscillating.length ? sizes(oscillating) : sizes(poles);
  const lowest = natural[0] ?? 1, highest = natural[Math.min(natural.length, grid.many) - 1] ?? 1;
  const [low, high] = grid.span ?? [lowest / grid.margin / TURN_ANGLE, (highest * grid.margin) / TURN_ANGLE], first = low > 0 ? low : high * 1e-3;
  const count = Math.max(2, Math.ceil(grid.decade * Math.log10(high / first)) + 1), ratio = Math.log(high / first);
  const values = [low, ...even(0, 1, count).slice(1, -1).map((share) => first * Math.exp(share * ratio)), first, high], free = undampedPoles(poles, grid);
  for (const pole of oscillating) {
    const [re, im] = pole, centre = im / TURN_ANGLE, size = Math.hypot(re, im) / TURN_ANGLE, half = Math.max(Math.abs(re) / TURN_ANGLE, grid.narrowest * size);
    if (!(half < size / 3)) continue;
    const reach = Math.asinh(Math.min(grid.widest, Math.max(1, size / (3 * half))));
    even(0, reach, grid.across + 1).forEach((x, k) => {
      const offset = half * Math.sinh(x);
      if (k) values.push(centre - offset, centre + offset); else if (!free.includes(pole)) values.push(centre);
    });
  }
  const clear = distinct(values).filter((f) => f >= low && f <= high && free.every(([, im]) => Math.abs(f - im / TURN_ANGLE) > (grid.gap * im) / TURN_ANGLE));
  return clear.filter((f, k) => k === 0 || f - clear[k - 1] > 1e-12 * high);
}

/** Numbers of the samples that are local maxima, without the ends. @param {ArrayLike<number>} values */
export function localMaxima(values) {
  return Array.from(values, (_, k) => k).filter((k) => k > 0 && k < values.length - 1 && values[k] > values[k - 1] && values[k] >= values[k + 1]);
}

/** Vertex of the parabola through `1/y²` of three points, within the bracket. @param {number[]} x @param {number[]} y */
function vertex(x, y) {
  const inverse = y.every((v) => v > 0) ? y.map((v) => 1 / v ** 2) : y.map((v) => -v), left = x[1] - x[0], right = x[2] - x[1];
  const rise = inverse[0] - inverse[1], fall = inverse[2] - inverse[1], bend = rise * right + fall * left;
  const shift = bend > 0 ? (rise * right ** 2 - fall * left ** 2) / (2 * bend) : 0;
  return x[1] + Math.min(0.9 * right, Math.max(-0.9 * left, shift));
}

/** Frequency of a local maximum between three samples.
 * @param {number[]} x @param {number[]} y @param {(f: number) => number} value @param {(f: number) => number} slope @param {LiveGrid} grid */
export function refinedMaximum(x, y, value, slope, { close, reach, rounds, steps }) {
  const near = close * (x[2] - x[0]);
  let start = x[1];
  for (let k = 0; k < steps; k++) {
    const trial = vertex(x, y), found = Math.abs(trial - x[1]) <= near;
    start = found ? trial : x[1];
    if (found) break;
    const pairs = [...x.map((v, i) => [v, y[i]]), [trial, value(trial)]].sort((a, b) => a[0] - b[0]), top = pairs.reduce((best, [, v], i) => (v > pairs[best][1] ? i : best), 0), middle = Math.min(2, Math.max(1, top));
    [x, y] = [0, 1].map((part) => pairs.slice(middle - 1, middle + 2).map((pair) => pair[part]));
    start = x[1];
  }
  let now = start, other = start + near / 10, last = slope(other);
  for (let k = 0; k < rounds; k++) {
    const rise = slope(now), change = last - rise, step = change ? (-rise * (other - now)) / change : 0;
    [other, last] = [now, rise];
    now += Math.min(start + reach * near - now, Math.max(start - reach * near - now, step));
  }
  return now;
}
