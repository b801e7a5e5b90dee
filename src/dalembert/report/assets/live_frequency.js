// Frequency response of a mechanism in a live page: matrices in the module, complex solutions here.

/** @import { Vector } from "./live_complex.js" */
/** @import { Matrix } from "./live_matrix.js" */
/** @import { LiveGrid } from "./types.d.ts" */

import { ComplexFactors } from "./live_complex.js";
import { eigenvalues } from "./live_eigenvalues.js";
import { TURN_ANGLE } from "./live_grid.js";
import { general } from "./live_limits.js";
import { smallMotions } from "./live_linear.js";
import { matrixOf, times } from "./live_matrix.js";
import { LiveHarmonic } from "./live_harmonic.js";
import { RunFailure } from "./live_run.js";
import { swingPicture } from "./live_swing.js";

/** Sum of products of a real row, which begins at a place, and a complex vector. @param {Float64Array} row @param {number} from @param {Vector} x @returns {[number, number]} */
function along(row, from, [x, y]) {
  let a = 0, b = 0;
  for (let k = 0; k < x.length; k++) { const c = row[from + k]; if (c) { a += c * x[k]; b += c * y[k]; } }
  return [a, b];
}

/** Matrix from rows one after the other. @param {Float64Array} table @param {number} columns @returns {Matrix} */
const matrixOfRows = (table, columns) => Array.from({ length: table.length / columns }, (_, i) => table.slice(columns * i, columns * (i + 1)));

/** Linear system of one design: unknowns and equations in natural sizes. */
class LinearSystem {
  /** @param {LiveFrequency} run @param {Float64Array} p */
  constructor(run, p) {
    const { engine, data } = run, near = run.assembled(p), [z] = engine.evaluate("point", [data.start], near, p) ?? [], parts = z && engine.evaluate("system", [data.start], z, p);
    if (!z || !parts || !parts.every((part) => part.every(Number.isFinite))) throw new RunFailure("the mechanism cannot be linearised", undefined, undefined, "singular position");
    const [static_, rates, pushes, weights, rateWeights, direct] = parts, n = /** @type {number[]} */ (data.unknowns).length;
    this.data = data;
    this.near = near;
    this.p = p;
    this.z = z;
    this.n = n;
    this.static = static_;
    this.rates = rates;
    this.weights = weights;
    this.rateWeights = rateWeights;
    this.motions = smallMotions(run, near, p);
    /** Eigenvalues [1/s]. @type {[number, number][]} */
    this.poles = eigenvalues(this.motions.a) ?? [];
    const split = (/** @type {Float64Array} */ table, /** @type {[number, number][]} */ change) => /** @type {Vector} */ ([0, 1].map((part) => times(matrixOfRows(table, p.length), change.map((pair) => pair[part]))));
    this.inputs = /** @type {[number, number][][]} */ (data.columns_of).map((change) => ({ change, right: split(pushes, change).map((part) => part.map((v) => -v)), direct: split(direct, change) }));
  }

  /** Factors of the matrix at an angular frequency. @param {number} omega */
  factors(omega) { return new ComplexFactors(this.static.slice(), this.rates.map((value) => omega * value), this.n); }

  /** Harmonic motions at a frequency [Hz] by all inputs, and the amplitudes of the measures. @param {number} f */
  at(f) {
    const omega = TURN_ANGLE * f, factors = this.factors(omega), motions = this.inputs.map(({ right }) => factors.solve(/** @type {Vector} */ (right)));
    if (motions.some((motion, k) => this.resonates(omega, motion, /** @type {Vector} */ (this.inputs[k].right)))) throw this.refusal(f, motions);
    const count = this.data.measures ?? 0, h = new Float64Array(Math.max(2 * this.inputs.length * count, 2 * this.inputs.length));
    for (let m = 0; m < count; m++) motions.forEach((motion, c) => {
      const [a, b] = along(this.weights, m * this.n, motion), [d, e] = along(this.rateWeights, m * this.n, motion), { direct } = this.inputs[c], k = 2 * (m * motions.length + c);
      h[k] = a - omega * e + direct[0][m];
      h[k + 1] = b + omega * d + direct[1][m];
    });
    return { f, omega, factors, motions, h };
  }

  /** Whether a right-hand side vanishes against the terms of its rows. @param {number} omega @param {Vector} motion @param {Vector} right */
  resonates(omega, [x, y], [b, c]) {
    const { n, static: k, rates, data: { grid } } = this, sizes = x.map((value, i) => Math.hypot(value, y[i]));
    if (!sizes.every(Number.isFinite)) return true;
    let most = 0, active = false;
    for (let i = 0; i < n; i++) {
      const side = Math.hypot(b[i], c[i]);
      if (!side) continue;
      active = true;
      let terms = 0;
      for (let j = 0; j < n; j++) terms += Math.hypot(k[n * i + j], omega * rates[n * i + j]) * sizes[j];
      most = Math.max(most, side / terms);
    }
    return active && most < /** @type {LiveGrid} */ (grid).resonant;
  }

  /** @param {number} f @param {Vector[]} motions */
  refusal(f, motions) {
    const sizes = motions.map(([x, y]) => x.map((value, i) => Math.hypot(value, y[i]))).find((part) => part.every(Number.isFinite)), leading = sizes ? ` of ${this.data.names?.[sizes.indexOf(Math.max(...sizes))]}` : "";
    return new RunFailure(f ? `no finite response at ${general(f, 9)} Hz: an undamped motion${leading} resonates; add damping` : `no static response: a motion${leading} is free`, undefined, undefined, "singular position");
  }

  /** Derivatives of the amplitudes by the frequency [1/Hz]. @param {ReturnType<LinearSystem["at"]>} sample */
  rate({ omega, factors, motions }) {
    const { n, rates } = this, h = new Float64Array(2 * motions.length * (this.data.measures ?? 0));
    motions.forEach((motion, c) => {
      const right = /** @type {Vector} */ ([new Float64Array(n), new Float64Array(n)]);
      for (let i = 0; i < n; i++) { const [a, b] = along(rates, n * i, motion); right[0][i] = b; right[1][i] = -a; }
      const change = factors.solve(right);
      for (let m = 0; m < (this.data.measures ?? 0); m++) {
        const [a, b] = along(this.weights, m * n, change), [d, e] = along(this.rateWeights, m * n, change), [u, v] = along(this.rateWeights, m * n, motion), k = 2 * (m * motions.length + c);
        h[k] = TURN_ANGLE * (a - omega * e - v);
        h[k + 1] = TURN_ANGLE * (b + omega * d + u);
      }
    });
    return h;
  }
}

/** Frequency responses of one mechanism, one after the other. */
export class LiveFrequency extends LiveHarmonic {
  /** @override @param {Float64Array} p */
  system(p) { return new LinearSystem(this, p); }

  /** Rows of the picture at a frequency. @override @param {LinearSystem} system @param {ReturnType<LinearSystem["at"]>} sample */
  picture({ motions: { x, g }, p }, { motions: [[re, im]] }) {
    const { data, engine } = this, count = data.coordinates ?? 0, moved = data.moved ?? 0, { unknowns = [] } = data;
    const [basis = new Float64Array()] = engine.evaluate("basis", x.subarray(0, count)) ?? [], matrix = matrixOf(basis, count);
    const [real, imag] = [re, im].map((part) => times(matrix, part.subarray(0, moved).map((value, k) => value * unknowns[k])));
    return swingPicture(this, x, p, g, real, imag);
  }

  /** Weights of the parameters from those of the amplitudes at frequencies: adjoint solutions.
   * @override @param {LinearSystem} system @param {{ f: number, bars: Float64Array }[]} samples */
  parameterWeights(system, samples) {
    const { engine, data } = this, { n, p, z, near } = system, { unknowns = [], equations = [], rates = 0, measures = 0 } = data, state = new Float64Array(z.length), total = new Float64Array(p.length);
    for (const { f, bars } of samples) {
      const { omega, factors, motions } = system.at(f);
      motions.forEach((motion, c) => {
        const seeds = Array.from({ length: measures }, (_, m) => { const k = 2 * (m * motions.length + c); return [bars[k], -bars[k + 1]]; });
        if (seeds.every(([a, b]) => !a && !b)) return;
        const right = /** @type {Vector} */ ([new Float64Array(n), new Float64Array(n)]);
        seeds.forEach(([s, t], m) => {
          for (let i = 0; i < n; i++) {
            const a = system.weights[m * n + i], b = omega * system.rateWeights[m * n + i];
            right[0][i] -= s * a - t * b;
            right[1][i] -= t * a + s * b;
          }
        });
        const adjoint = factors.solveTransposed(right), [w, v] = motion.map((part) => part.map((value, i) => value * unknowns[i]));
        const { change } = system.inputs[c], changes = [[...w, ...v.subarray(0, rates).map((value) => -omega * value)], [...v, ...w.subarray(0, rates).map((value) => omega * value)]];
        changes.forEach((moved, part) => {
          const weights = [...seeds.map((pair) => pair[part]), ...adjoint[part].map((value, i) => value / equations[i])].map((value) => (part ? -value : value));
          const [own, by] = engine.evaluate("pull", [data.start], z, p, [...moved, ...change.map((pair) => pair[part])], weights) ?? [state.map(() => NaN), total];
          own.forEach((value, i) => { state[i] += value; });
          by.forEach((value, i) => { total[i] += value; });
        });
      });
    }
    engine.evaluate("point_adjoint", [data.start], near, p, state)?.[0].forEach((value, i) => { total[i] += value; });
    return total;
  }
}
