// Sequential quadratic programming with bounds and limits, in a trust region, on exact gradients.

import { dot } from "./live_matrix.js";

/** Objective and limits `c ≤ 0` at a point, with their gradients.
 * @typedef {{ f: number, df: number[], c: number[], dc: number[][] }} Evaluated */
/** Iterate of an optimisation. @typedef {{ x: number[], at: Evaluated }} Iterate */
/** @typedef {"converged" | "no progress" | "failed designs" | "infeasible" | "stopped" | "iterations"} Outcome */

const ITERATIONS = 100, SWEEPS = 3000;
/** First and largest radius of the trust region, and the one below which nothing is gained; variables lie in [0, 1]. */
const FIRST = 0.1, WIDEST = 0.4, NARROWEST = 1e-7;
/** Predicted decrease below which a point is optimal, and largest violation of a satisfied limit, in scaled units. */
const GAIN = 1e-9, SATISFIED = 1e-6;
/** First and largest penalty of violated limits. */
const PENALTY = 10, HEAVIEST = 1e7;

const violation = (/** @type {number[]} */ c) => c.reduce((sum, v) => sum + Math.max(0, v), 0);
const span = (/** @type {number[]} */ d) => d.reduce((most, v) => Math.max(most, Math.abs(v)), 0);

/** Inverse of a symmetric positive definite matrix. @param {number[][]} matrix */
function inverse(matrix) {
  const n = matrix.length, rows = matrix.map((row, i) => [...row, ...row.map((_, k) => Number(k === i))]);
  for (let i = 0; i < n; i++) {
    const pivot = rows[i][i];
    for (let k = 0; k < 2 * n; k++) rows[i][k] /= pivot;
    for (let j = 0; j < n; j++) {
      const factor = rows[j][i];
      if (j !== i && factor) for (let k = 0; k < 2 * n; k++) rows[j][k] -= factor * rows[i][k];
    }
  }
  return rows.map((row) => row.slice(n));
}

/** Minimum of gᵀd + dᵀBd/2 + ρ Σ max(0, c + J d) for lower ≤ d ≤ upper, by ascent in the multipliers (Hildreth).
 * @param {number[][]} hessian @param {Evaluated} at @param {number[]} lower @param {number[]} upper @param {number} penalty */
export function quadraticStep(hessian, { df, c, dc }, lower, upper, penalty) {
  const n = df.length, h = inverse(hessian), times = (/** @type {number[]} */ v) => h.map((row) => dot(row, v));
  const d = times(df).map((v) => -v), bounds = new Float64Array(n), prices = new Float64Array(c.length);
  const ways = dc.map(times), sizes = dc.map((row, j) => dot(row, ways[j]));
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    let moved = 0;
    for (let k = 0; k < n; k++) {  // multiplier of both bounds: positive at the upper one
      const free = d[k] + bounds[k] * h[k][k], price = free > upper[k] ? (free - upper[k]) / h[k][k] : free < lower[k] ? (free - lower[k]) / h[k][k] : 0, change = price - bounds[k];
      if (!change) continue;
      bounds[k] = price;
      for (let i = 0; i < n; i++) d[i] -= change * h[i][k];
      moved = Math.max(moved, Math.abs(change) * h[k][k]);
    }
    for (let j = 0; j < c.length; j++) {
      if (!(sizes[j] > 0)) continue;
      const price = Math.min(penalty, Math.max(0, prices[j] + (c[j] + dot(dc[j], d)) / sizes[j])), change = price - prices[j];
      if (!change) continue;
      prices[j] = price;
      for (let i = 0; i < n; i++) d[i] -= change * ways[j][i];
      moved = Math.max(moved, Math.abs(change) * Math.sqrt(sizes[j]));
    }
    if (moved < 1e-14) break;
  }
  return { d: d.map((v, k) => Math.min(upper[k], Math.max(lower[k], v))), prices: [...prices] };
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
    const next = x.map((v, k) => Math.min(1, Math.max(0, v + d[k]))), answer = await evaluate(next);
    if (stopped()) return ends("stopped");
    if (!answer) {
      failures++;
      narrowed = "failed designs";
      radius = 0.3 * span(d);
      if (radius < NARROWEST) return ends("failed designs");
      continue;
    }
    const trial = scaled(answer), decrease = at.f - trial.f + penalty * (violation(at.c) - violation(trial.c));
    const lagrangian = (/** @type {Evaluated} */ { df, dc }) => df.map((v, k) => v + dc.reduce((sum, row, j) => sum + prices[j] * row[k], 0));
    const [before, after] = [lagrangian(at), lagrangian(trial)];
    if (n) hessian = updated(hessian, d, after.map((v, k) => v - before[k]));
    if (decrease > 1e-4 * gain) {
      [x, raw, at] = [next, answer, trial];
      iterations++;
      if (decrease > 0.7 * gain && span(d) > 0.99 * radius) radius = Math.min(WIDEST, 2 * radius);
      await onIterate({ x, at: raw });
    } else {
      narrowed = "no progress";
      radius = 0.4 * span(d);
      if (radius < NARROWEST) return ends(violation(at.c) > SATISFIED ? "infeasible" : "no progress");
    }
  }
  return ends("iterations");
}
