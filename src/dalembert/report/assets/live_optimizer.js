// Sequential quadratic programming with bounds and limits, in a trust region, on exact gradients.

import { dot, solved } from "./live_matrix.js";

/** Objective and limits `c ≤ 0` at a point, with their gradients.
 * @typedef {{ f: number, df: number[], c: number[], dc: number[][] }} Evaluated */
/** Iterate of an optimisation. @typedef {{ x: number[], at: Evaluated }} Iterate */
/** @typedef {"converged" | "no progress" | "failed designs" | "infeasible" | "stopped" | "iterations"} Outcome */

const ITERATIONS = 100;
/** Steps of the interior-point method, reduction of its gap, and share of the way to the nearest end. */
const STEPS_INSIDE = 80, CENTRING = 0.1, NEAR_END = 0.99;
/** First and largest radius of the trust region, and the one below which nothing is gained; variables lie in [0, 1]. */
const FIRST = 0.1, WIDEST = 0.4, NARROWEST = 1e-7;
/** Predicted decrease below which a point is optimal, below which round-off explains that it is missed, and largest violation of a satisfied limit; in scaled units. */
const GAIN = 1e-11, ROUNDED = 1e-8, SATISFIED = 1e-6;
/** First and largest penalty of violated limits. */
const PENALTY = 2, HEAVIEST = 1e7;

const violation = (/** @type {number[]} */ c) => c.reduce((sum, v) => sum + Math.max(0, v), 0);
const span = (/** @type {number[]} */ d) => d.reduce((most, v) => Math.max(most, Math.abs(v)), 0);

/** Minimum of gᵀd + dᵀBd/2 + ρ Σ max(0, c + J d) for lower ≤ d ≤ upper, by a primal-dual interior-point method: t ≥ c + J d, t ≥ 0.
 * @param {number[][]} hessian @param {Evaluated} at @param {number[]} lower @param {number[]} upper @param {number} penalty
 * @returns {{ d: number[], prices: number[] }} step and multipliers of the limits */
export function quadraticStep(hessian, { df, c, dc }, lower, upper, penalty) {
  const n = df.length, m = c.length, size = n + m, unit = (/** @type {number} */ k, /** @type {number} */ sign) => Array.from({ length: size }, (_, i) => (i === k ? sign : 0));
  const g = [...df, ...c.map(() => penalty)], b = Array.from({ length: size }, (_, i) => Array.from({ length: size }, (__, k) => (i < n && k < n ? hessian[i][k] : 0)));
  /** Rows of A z ≤ h: limits, upper and lower ends, t ≥ 0. */
  const rows = [...dc.map((row, j) => [...row, ...unit(n + j, -1).slice(n)]), ...df.map((_, k) => unit(k, 1)), ...df.map((_, k) => unit(k, -1)), ...c.map((_, j) => unit(n + j, -1))];
  const h = [...c.map((v) => -v), ...upper, ...lower.map((v) => -v), ...c.map(() => 0)], count = rows.length;
  const middle = lower.map((v, k) => (v + upper[k]) / 2), z = [...middle, ...c.map((v, j) => Math.max(0, v + dot(dc[j], middle)) + 1)];
  const slack = rows.map((row, i) => h[i] - dot(row, z)), prices = slack.map(() => 1);
  for (let k = 0; k < STEPS_INSIDE; k++) {
    const gap = dot(slack, prices) / count, open = z.map((_, i) => dot(b[i], z) + g[i] + rows.reduce((sum, row, j) => sum + row[i] * prices[j], 0));
    if (gap < 1e-17 && span(open) < 1e-10) break;
    const excess = slack.map((s, j) => prices[j] - (CENTRING * gap) / s), weights = slack.map((s, j) => prices[j] / s), matrix = b.map((row) => Float64Array.from(row));
    rows.forEach((row, j) => row.forEach((v, i) => { if (v) for (let l = 0; l < size; l++) matrix[i][l] += weights[j] * v * row[l]; }));
    const change = solved(matrix, z.map((_, i) => Float64Array.of(rows.reduce((sum, row, j) => sum + row[i] * excess[j], -open[i])))).map(([v]) => v);
    const slackChange = rows.map((row) => -dot(row, change)), priceChange = slack.map((_, j) => -excess[j] - weights[j] * slackChange[j]);
    let length = 1;
    for (let j = 0; j < count; j++) {
      if (slackChange[j] < 0) length = Math.min(length, (-NEAR_END * slack[j]) / slackChange[j]);
      if (priceChange[j] < 0) length = Math.min(length, (-NEAR_END * prices[j]) / priceChange[j]);
    }
    if (!(length > 1e-12) || !change.every(Number.isFinite)) break;
    change.forEach((v, i) => { z[i] += length * v; });
    for (let j = 0; j < count; j++) { slack[j] += length * slackChange[j]; prices[j] += length * priceChange[j]; }
  }
  return { d: z.slice(0, n).map((v, k) => Math.min(upper[k], Math.max(lower[k], v))), prices: prices.slice(0, m) };
}

/** Damped update of a Hessian (Powell). @param {number[][]} hessian @param {number[]} s step @param {number[]} y change of the gradient */
function updated(hessian, s, y) {
  const bs = hessian.map((row) => dot(row, s)), sbs = dot(s, bs), sy = dot(s, y);
  if (!(sbs > 0)) return hessian;
  const share = sy >= 0.2 * sbs ? 1 : (0.8 * sbs) / (sbs - sy), r = y.map((v, k) => share * v + (1 - share) * bs[k]), sr = dot(s, r);
  return hessian.map((row, i) => row.map((v, k) => v - (bs[i] * bs[k]) / sbs + (r[i] * r[k]) / sr));
}

/** Minimise f subject to c ≤ 0 and 0 ≤ x ≤ 1. Designs that fail narrow the trust region.
 * @param {number[]} start
 * @param {(x: number[]) => Promise<Evaluated | null>} evaluate null where the design fails
 * @param {(iterate: Iterate) => Promise<void>} onIterate
 * @param {() => boolean} stopped
 * @returns {Promise<{ outcome: Outcome, iterations: number, failures: number }>} */
export async function minimised(start, evaluate, onIterate, stopped) {
  const n = start.length, first = await evaluate(start);
  let iterations = 0, failures = 0, radius = FIRST, penalty = PENALTY;
  /** Cause of the last narrowing. @type {Outcome} */
  let narrowed = "no progress";
  const ends = (/** @type {Outcome} */ outcome) => ({ outcome, iterations, failures });
  if (!first) return ends(stopped() ? "stopped" : "failed designs");
  const unit = 1 / (span(first.df) || 1), units = first.c.map((v, j) => 1 / (span(first.dc[j]) || Math.abs(v) || 1));
  const scaled = (/** @type {Evaluated} */ { f, df, c, dc }) => ({ f: unit * f, df: df.map((v) => unit * v), c: c.map((v, j) => units[j] * v), dc: dc.map((row, j) => row.map((v) => units[j] * v)) });
  let x = start, raw = first, at = scaled(first), hessian = start.map((_, i) => start.map((__, k) => Number(i === k)));
  await onIterate({ x, at: raw });
  while (iterations < ITERATIONS) {
    if (stopped()) return ends("stopped");
    const lower = x.map((v) => Math.max(-v, -radius)), upper = x.map((v) => Math.min(1 - v, radius));
    const { d, prices } = quadraticStep(hessian, at, lower, upper, penalty), model = at.c.map((v, j) => v + dot(at.dc[j], d));
    const curved = dot(d, hessian.map((row) => dot(row, d))), gain = -dot(at.df, d) - curved / 2 + penalty * (violation(at.c) - violation(model));
    if (violation(model) > SATISFIED && penalty < HEAVIEST && violation(at.c) - violation(model) <= 0.5 * violation(at.c)) { penalty *= 10; continue; }
    if (!(gain > GAIN)) return ends(violation(at.c) > SATISFIED ? "infeasible" : span(d) >= 0.99 * radius || (narrowed === "failed designs" && radius < FIRST * 1e-2) ? narrowed : "converged");
    const shifted = (/** @type {number[]} */ step) => x.map((v, k) => Math.min(1, Math.max(0, v + step[k]))), merit = (/** @type {Evaluated} */ { f, c }) => f + penalty * violation(c);
    let next = shifted(d), answer = await evaluate(next);
    if (stopped()) return ends("stopped");
    if (!answer) {
      failures++;
      narrowed = "failed designs";
      radius = 0.3 * span(d);
      if (radius < NARROWEST) return ends("failed designs");
      continue;
    }
    let trial = scaled(answer), decrease = merit(at) - merit(trial);
    const lagrangian = (/** @type {Evaluated} */ { df, dc }) => df.map((v, k) => v + dc.reduce((sum, row, j) => sum + prices[j] * row[k], 0));
    const [before, after] = [lagrangian(at), lagrangian(trial)];
    if (n) hessian = updated(hessian, d, after.map((v, k) => v - before[k]));
    if (!(decrease > 0.5 * gain) && violation(trial.c) > violation(model) + SATISFIED * span(d)) {  // curved limits: step to them from the trial (Maratos)
      const corrected = quadraticStep(hessian, { ...at, c: trial.c.map((v, j) => v - dot(at.dc[j], d)) }, lower, upper, penalty).d, second = await evaluate(shifted(corrected));
      if (stopped()) return ends("stopped");
      if (second && merit(scaled(second)) < merit(trial)) [next, answer, trial, decrease] = [shifted(corrected), second, scaled(second), merit(at) - merit(scaled(second))];
    }
    if (decrease > 1e-4 * gain) {
      [x, raw, at] = [next, answer, trial];
      iterations++;
      if (decrease > 0.7 * gain && span(d) > 0.99 * radius) radius = Math.min(WIDEST, 2 * radius);
      await onIterate({ x, at: raw });
    } else {
      if (gain < ROUNDED && span(d) < 0.99 * radius && violation(at.c) <= SATISFIED) return ends("converged");
      narrowed = "no progress";
      radius = 0.4 * span(d);
      if (radius < NARROWEST) return ends(violation(at.c) > SATISFIED ? "infeasible" : "no progress");
    }
  }
  return ends("iterations");
}
