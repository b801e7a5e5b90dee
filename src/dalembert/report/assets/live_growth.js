// Growth of small motions about an equilibrium with states, sampled ones included: as `growth_rates` of Python.

/** @import { Matrix } from "./live_matrix.js" */
/** @import { LiveRun } from "./live_run.js" */

import { eigenvalues } from "./live_eigenvalues.js";
import { columnsOf, smallMotions } from "./live_linear.js";
import { product, solved, transposed } from "./live_matrix.js";

/** Coefficients of the rational approximation of degree six of the exponential function (Padé), and the largest norm for which it is exact to rounding. */
const PADE = [1, 1 / 2, 5 / 44, 1 / 66, 1 / 792, 1 / 15840, 1 / 665280], SMALL = 0.25;

/** @param {number} n @returns {Matrix} */
const identity = (n) => Array.from({ length: n }, (_, i) => Float64Array.from({ length: n }, (__, k) => Number(i === k)));

/** Exponential of a matrix, by scaling and squaring. @param {Matrix} matrix @param {number} time factor @returns {Matrix} */
function exponential(matrix, time) {
  const n = matrix.length, norm = Math.max(0, ...matrix.map((row) => row.reduce((sum, value) => sum + Math.abs(value * time), 0)));
  const halvings = Math.max(0, Math.ceil(Math.log2(norm / SMALL))), a = matrix.map((row) => row.map((value) => (value * time) / 2 ** halvings));
  const [above, below] = [identity(n), identity(n)];
  let power = identity(n);
  for (let k = 1; k < PADE.length; k++) {
    power = product(power, a);
    power.forEach((row, i) => row.forEach((value, j) => { above[i][j] += PADE[k] * value; below[i][j] += (k % 2 ? -1 : 1) * PADE[k] * value; }));
  }
  let result = solved(below, above);
  for (let k = 0; k < halvings; k++) result = product(result, result);
  return result;
}

/** Rates of the small motions about a state that grow [1/s]. @param {LiveRun} run @param {Float64Array} near @param {Float64Array} p */
export function growthRates(run, near, p) {
  const { growing = 0, natural = 1, instants = null } = run.data, { x, basis, a } = smallMotions(run, near, p);
  if (!instants) {
    const values = eigenvalues(a) ?? [[Infinity, 0]], largest = Math.max(0, ...values.map(([re, im]) => Math.hypot(re, im)));
    return values.map(([re]) => re).filter((re) => !(re <= growing * largest));
  }
  const { states } = /** @type {{ states: number[] }} */ (run.data.sizes), count = run.engine.named("samples").outputs[0] / x.length;
  const [stacked] = columnsOf(run, "samples", x, p, [Float64Array.from({ length: count * x.length }, (_, k) => states[k % x.length])]) ?? [null];
  if (!stacked) return [Infinity];
  const back = transposed(basis, basis[0]?.length ?? 0), samples = Array.from({ length: count }, (_, k) => product(back, product(stacked.slice(k * x.length, (k + 1) * x.length), basis)));
  /** @type {Map<number, Matrix>} */
  const flows = new Map();
  let whole = identity(a.length), period = 0;
  for (const [wait, k] of instants) {
    const flow = flows.get(wait) ?? exponential(a, wait);
    flows.set(wait, flow);
    whole = product(flow, product(samples[k], whole));
    period += wait;
  }
  return (eigenvalues(whole) ?? [[Infinity, 0]]).map(([re, im]) => Math.log(Math.hypot(re, im)) / period).filter((rate) => !(rate <= growing / natural));
}
