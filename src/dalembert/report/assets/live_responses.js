// Responses of live pages: reductions of the samples of rows, and their derivatives.

/** @import { LiveResponse, LiveTerm } from "./types.d.ts" */

import { dot } from "./live_matrix.js";

/** Threshold for joining the last interval to the one before, relative to its length. */
const SHORT_INTERVAL = 1e-3;
/** Spread of samples that is round-off, relative to the largest one; squared range of a uniform distribution divided by its variance. */
const ALIKE = 1e-10, UNIFORM = 12;

/** Integrals over [0, h] of the parabola through nodes 0, h and b: weights of the values there. @param {number} h @param {number} b */
function parabola(h, b) {
  return [h / 2 - (h * h) / (6 * b), h / 2 + (h * h) / (6 * (b - h)), (-h * h * h) / (6 * b * (b - h))];
}

/** Weights for instants that were used before. @type {WeakMap<ArrayLike<number>, Float64Array>} */
const rules = new WeakMap();

/** Weights of an integral over the samples: on each interval the mean of the parabolas through it and a neighbour.
 * @param {ArrayLike<number>} times */
function integralWeights(times) {
  const before = rules.get(times);
  if (before) return before;
  const weights = new Float64Array(times.length), nodes = Array.from(times, (_, k) => k), end = times.length - 1;
  if (end > 1 && times[end] - times[end - 1] < SHORT_INTERVAL * (times[end - 1] - times[end - 2])) nodes.splice(end - 1, 1);
  const last = nodes.length - 1;
  for (let k = 0; k < last; k++) {
    const [p, q] = [nodes[k], nodes[k + 1]], h = times[q] - times[p];
    const third = [nodes[k - 1], nodes[k + 2]].filter((node) => node !== undefined);
    if (!third.length) { weights[p] += h / 2; weights[q] += h / 2; }
    for (const node of third) parabola(h, times[node] - times[p]).forEach((w, i) => { weights[[p, q, node][i]] += w / third.length; });
  }
  rules.set(times, weights);
  return weights;
}

/** Weights of a mean over time. @param {ArrayLike<number>} times */
function meanWeights(times) {
  const span = times[times.length - 1] - times[0];
  return times.length > 1 ? integralWeights(times).map((w) => w / span) : new Float64Array(1).fill(1);
}

/** Index of the largest of `sign` times the samples. @param {ArrayLike<number>} samples @param {number} sign */
function peak(samples, sign) {
  let most = 0;
  for (let i = 1; i < samples.length; i++) if (sign * samples[i] > sign * samples[most]) most = i;
  return most;
}

/** Value and derivatives by the samples of the function of Kreisselmeier and Steinhauser, as `SmoothExtreme`.
 * @param {LiveTerm} term @param {Float64Array} samples @returns {[number, Float64Array]} */
function smoothExtreme({ sign = 1, smooth = 0, relative = false }, samples) {
  const n = samples.length, m = samples.map((v) => sign * v), top = m.reduce((a, b) => Math.max(a, b)), mean = m.reduce((a, b) => a + b, 0) / n;
  const share = smooth * Math.sqrt(UNIFORM), spread = share * Math.sqrt(m.reduce((sum, v) => sum + (v - mean) ** 2, 0) / n);
  const width = !relative ? smooth : spread > ALIKE * m.reduce((most, v) => Math.max(most, Math.abs(v)), 0) ? spread : 0;
  if (!width) return [sign * top, new Float64Array(n).fill(1 / n)];
  const exponents = m.map((v) => (v - top) / width), powers = exponents.map((e) => Math.exp(e) / n), total = powers.reduce((a, b) => a + b, 0);
  const shares = powers.map((power) => power / total), byWidth = Math.log(total) - dot(shares, exponents);
  return [sign * (top + width * Math.log(total)), shares.map((s, k) => s + (relative ? (byWidth * share ** 2 * (m[k] - mean)) / (n * width) : 0))];
}

/** Numbers of the highest samples, in their order; the last one is repeated where there are fewer. @param {Float64Array} samples @param {number} count */
function highest(samples, count) {
  const tops = Array.from(samples, (_, k) => k).sort((a, b) => samples[b] - samples[a]).slice(0, count).sort((a, b) => a - b);
  return Array.from({ length: count }, (_, k) => tops[Math.min(k, tops.length - 1)]);
}

/** Value of a term and its derivatives by the samples. @param {LiveTerm} term @param {ArrayLike<number>} times @param {Float64Array} samples
 * @returns {[number, Float64Array]} */
function reduced(term, times, samples) {
  const n = samples.length, { kind } = term;
  const single = (/** @type {number} */ k) => { const weights = new Float64Array(n); if (k < n) weights[k] = 1; else weights.fill(NaN); return /** @type {[number, Float64Array]} */ ([samples[k] ?? NaN, weights]); };
  const linear = (/** @type {Float64Array} */ weights) => /** @type {[number, Float64Array]} */ ([dot(weights, samples), weights]);
  switch (kind) {
    case "maximum": return single(peak(samples, 1));
    case "minimum": return single(peak(samples, -1));
    case "final": return single(n - 1);
    case "at": { const exact = Array.prototype.indexOf.call(times, term.time); return single(exact >= 0 ? exact : term.instant ?? 0); }
    case "top": return single(highest(samples, term.count ?? 1)[(term.number ?? 1) - 1]);
    case "peak": return single((term.number ?? 1) - 1);
    case "sum": return linear(new Float64Array(n).fill(1));
    case "integral": return linear(integralWeights(times));
    case "mean": return linear(meanWeights(times));
    case "smooth": return smoothExtreme(term, samples);
    case "rms": {
      const weights = meanWeights(times), value = Math.sqrt(Math.max(dot(weights, samples.map((v) => v * v)), 0));
      return [value, value ? weights.map((w, k) => (w * samples[k]) / value) : new Float64Array(n)];
    }
  }
}

/** Numbers of the samples that a term reduces; null for all of them.
 * @param {LiveTerm} term @param {number} count @param {[number, number]} inside @param {number[] | undefined} places @returns {number[] | null} */
function chosenSamples({ kind }, count, [from, to], places) {
  if (kind === "at") return null;
  if (kind === "peak") return places ?? [];
  if (places && (kind === "maximum" || kind === "minimum" || kind === "top")) return Array.from(new Set([from, ...places, to - 1])).sort((a, b) => a - b);
  return from || to < count ? Array.from({ length: to - from }, (_, k) => from + k) : null;
}

/** Weights of all samples from those of some. @param {Float64Array} weights @param {number[]} chosen @param {number} count */
function spread(weights, chosen, count) {
  const all = new Float64Array(count);
  chosen.forEach((k, i) => { all[k] = weights[i]; });
  if (weights.some(Number.isNaN)) all.fill(NaN);
  return all;
}

/** Value of a response, and the derivatives by the samples of each row.
 * @param {LiveResponse} response @param {ArrayLike<number>} times @param {(row: number) => Float64Array} samplesOf @param {[number, number]} inside range of the samples that are no single values @param {Map<string, number[]>} places numbers of the located extremes of a row with a sign
 * @returns {{ value: number, weights: Map<number, Float64Array> }} */
export function responseOf({ terms, constant = 0 }, times, samplesOf, inside = /** @type {[number, number]} */ ([0, times.length]), places = /** @type {Map<string, number[]>} */ (new Map())) {
  /** @type {Map<number, Float64Array>} */
  const weights = new Map();
  let value = constant;
  for (const term of terms) {
    const samples = samplesOf(term.row), chosen = chosenSamples(term, times.length, inside, places.get(`${term.row} ${term.kind === "minimum" ? -1 : 1}`));
    const [part, shares] = chosen ? reduced(term, chosen.map((k) => times[k]), Float64Array.from(chosen, (k) => samples[k])) : reduced(term, times, samples), slopes = chosen ? spread(shares, chosen, times.length) : shares, before = weights.get(term.row);
    value += term.weight * part;
    weights.set(term.row, slopes.map((slope, k) => term.weight * slope + (before?.[k] ?? 0)));
  }
  return { value, weights };
}
