// Modes of a mechanism in a live page: linearisation in the module, eigenvalues here.

/** @import { Matrix } from "./live_matrix.js" */

import { eigenvalues, eigenvector } from "./live_eigenvalues.js";
import { smallMotions } from "./live_linear.js";
import { dot, product, solved, times, transposed } from "./live_matrix.js";
import { LiveRun, RunFailure } from "./live_run.js";
import { swingPicture } from "./live_swing.js";

const CONJUGATE = 1e-12, SETTLED = 1e-6, COINCIDE = 1e-8, EQUAL = 1e-6;
/** Modes of one mechanism at one design after the other; outputs have the numbers of modes instead of times. */
export class LiveModes extends LiveRun {
  /** Modes with outputs: `table` holds the rows one after the other. @override @param {ArrayLike<number>} parameters @returns {any} */
  run(parameters) {
    const { engine, data } = this, p = this.checked(parameters);
    engine.top = this.base;
    const near = this.assembled(p), { x, j, g, basis, bound, a } = smallMotions(this, near, p);
    const values = eigenvalues(a);
    if (!values) throw new RunFailure("the eigenvalues do not converge", undefined, undefined, "not converged");
    const wanted = ordered(values).slice(0, data.count ?? values.length), n = wanted.length, vectors = eigenvectors(a, wanted), [shown] = engine.named("outputs").outputs;
    const outputs = wanted.map((value, k) => [...engine.evaluate("outputs", [k + 1], value, p)?.[0] ?? [], ...this.picture(x, p, g, basis, vectors[k])]);
    const rows = outputs[0]?.length ?? shown, table = Float64Array.from({ length: rows * n }, (_, k) => outputs[k % n][Math.floor(k / n)]);
    const size = Math.max(...a.map((row) => Math.max(...row.map(Math.abs))), Number.MIN_VALUE);
    const left = Math.max(0, ...wanted.map((value, k) => open(a, value, vectors[k]) / size));
    const success = left < SETTLED, message = success ? `${data.name}: ${n} mode(s)` : `residual ${left.toExponential(2)}`;
    const status = { outcome: success ? "completed" : "not converged", message, time: data.start, residual: left, success };
    return { times: Float64Array.from(wanted, (_, k) => k + 1), table, rows, status, modes: { p, near, x, j, g, basis, bound, a, wanted, values, vectors, shown } };
  }

  /** Rows of the picture of a mode. @param {Float64Array} x @param {Float64Array} p @param {Matrix} g @param {Matrix} basis @param {[Float64Array, Float64Array]} vector */
  picture(x, p, g, basis, vector) {
    const { states = [] } = this.data.sizes ?? {}, [re, im] = vector.map((part) => times(basis, part).map((value, i) => value * (states[i] ?? 1)).subarray(0, this.data.coordinates ?? 0));
    return swingPicture(this, x, p, g, re, im);
  }

  /** Gradient of a response by the parameters; NaN where eigenvalues coincide.
   * @override @param {any} run the last run @param {Map<number, Float64Array>} weights row → weights of the modes */
  gradient(run, weights) {
    const { engine, data } = this, { states, rows: levels } = /** @type {{ states: number[], rows: number[] }} */ (data.sizes), { times: { length: n }, modes: { p, near, x, j, g, basis, bound, a, wanted, values, vectors, shown } } = run;
    const total = new Float64Array(p.length), state = new Float64Array(x.length);
    for (let k = 0; k < n; k++) {
      const bars = Float64Array.from({ length: shown }, (_, r) => weights.get(r)?.[k] ?? 0);
      if (!bars.some((value) => value !== 0)) continue;
      if (coincides(wanted[k], values)) return total.fill(NaN);
      const [slope, own] = engine.evaluate("outputs_adjoint", [k + 1], wanted[k], p, bars) ?? [[NaN, NaN], total];
      own.forEach((value, i) => { total[i] += value; });
      for (const [q, top, bottom] of probes(a, wanted[k], vectors[k], slope, j, g, basis, bound)) {
        const [x_bar, p_bar] = engine.evaluate("tangent_adjoint", [data.start], x, p, q.map((value, i) => value * states[i]), top.map((value, i) => value / states[i]), bottom.map((value, i) => value / levels[i])) ?? [state.map(() => NaN), total];
        x_bar.forEach((value, i) => { state[i] += value; });
        p_bar.forEach((value, i) => { total[i] += value; });
      }
    }
    engine.evaluate("state_adjoint", [data.start], near, p, state)?.[0].forEach((value, i) => { total[i] += value; });
    return total;
  }
}

/** One eigenvalue of each conjugate pair, by increasing size. @param {[number, number][]} values */
function ordered(values) {
  const unit = Math.max(...values.map(([re, im]) => Math.hypot(re, im)), 0) || 1;
  const key = (/** @type {[number, number]} */ [re, im]) => Math.round((Math.hypot(re, im) / unit) * 1e12);
  return values.filter(([, im]) => im >= -CONJUGATE * unit).sort((a, b) => key(a) - key(b) || Math.abs(a[1]) - Math.abs(b[1]) || a[0] - b[0]);
}

/** Whether another eigenvalue is equal but for rounding. @param {[number, number]} value @param {[number, number][]} values */
function coincides(value, values) {
  const unit = Math.max(...values.map(([re, im]) => Math.hypot(re, im)), 0) || 1;
  return values.filter(([re, im]) => Math.hypot(re - value[0], im - value[1]) <= COINCIDE * unit).length > 1;
}

/** Vectors of eigenvalues; those of equal ones differ. @param {Matrix} a @param {[number, number][]} values @returns {[Float64Array, Float64Array][]} */
function eigenvectors(a, values) {
  return values.map((value, k) => eigenvector(a, value, values.slice(0, k).filter((other) => Math.hypot(other[0] - value[0], other[1] - value[1]) <= EQUAL * Math.hypot(...value)).length));
}

/** Residual of an eigenvalue with its vector. @param {Matrix} a @param {[number, number]} value @param {[Float64Array, Float64Array]} vector */
function open(a, [re, im], [x, y]) {
  const [ax, ay] = [times(a, x), times(a, y)];
  return Math.max(0, ...ax.map((value, i) => Math.hypot(value - re * x[i] + im * y[i], ay[i] - re * y[i] - im * x[i])));
}

/** Terms `q, a, b` of the derivative `Σ aᵀ dJ q + bᵀ dG q` of an eigenvalue, weighted by `slope`: see `sensitivity/eigenvalues`.
 * @param {Matrix} a @param {[number, number]} value @param {[Float64Array, Float64Array]} vector @param {ArrayLike<number>} slope @param {Matrix} j @param {Matrix} g @param {Matrix} basis @param {Matrix} bound
 * @returns {[Float64Array, Float64Array, Float64Array][]} */
function probes(a, [re, im], [x, y], slope, j, g, basis, bound) {
  const [u, v] = eigenvector(transposed(a, a.length), [re, -im]);
  // (u + iv)ᴴ (x + iy) = 1, and the weight slope₀ − i slope₁ of the right vector
  const [c, d] = [dot(u, x) + dot(v, y), dot(u, y) - dot(v, x)], size = c * c + d * d, [f, h] = [(slope[0] * c - slope[1] * d) / size, (-slope[1] * c - slope[0] * d) / size];
  const right = [x.map((value, i) => f * value - h * y[i]), x.map((value, i) => f * y[i] + h * value)].map((part) => times(basis, part));
  const left = [u, v].map((part) => times(basis, part)), square = transposed(product(g, bound), g.length), columns = transposed(bound, g.length), back = transposed(j, j.length);
  /** `−G⁺ᵀ x` @param {Float64Array} vector */
  const across = (vector) => (g.length ? Float64Array.from(solved(square, Array.from(times(columns, vector), (value) => Float64Array.of(-value))), ([value]) => value) : new Float64Array(0));
  return [0, 1].flatMap((k) => /** @type {[Float64Array, Float64Array, Float64Array][]} */ ([
    [right[k], left[k], across(times(back, left[k]))],
    [left[k], new Float64Array(left[k].length), across(times(j, right[k]))],
  ]));
}
