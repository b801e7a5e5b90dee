// Statics and vibration of a small structure in a live page: matrices in the module, factors here.

/** @import { Matrix } from "./live_matrix.js" */

import { backward, cholesky, dot, forward, matrixOf, symmetricEigenpairs } from "./live_matrix.js";
import { LiveRun, RunFailure, largest } from "./live_run.js";

/** Message about a singular stiffness. */
export const MOVES = "the structure can move without strain";
const COINCIDE = 1e-8;

/** Analyses with the matrices of a structure. */
class LiveStructure extends LiveRun {
  /** Factor of the stiffness, and the second result of `system`. @param {Float64Array} p @returns {[Matrix, Float64Array, Matrix]} */
  factored(p) {
    const [k, more] = this.engine.evaluate("system", p) ?? [], stiffness = matrixOf(k ?? [], this.data.free ?? 0), factor = k && cholesky(stiffness);
    if (!factor) throw new RunFailure(MOVES, undefined, undefined, "singular position");
    return [factor, more, stiffness];
  }

  /** Outputs of states, one for each load case or mode. @param {Float64Array} p @param {Float64Array[]} states */
  tabled(p, states) {
    const [rows] = this.engine.named("outputs").outputs, n = this.times.length, table = new Float64Array(rows * n).fill(NaN);
    states.forEach((state, k) => this.engine.evaluate("outputs", [this.times[k]], state, p)?.[0].forEach((value, r) => { table[n * r + k] = value; }));
    return { times: this.times, rows, table };
  }

  /** Weights of states and parameters from those of the outputs; calls `pull` for each state that has some.
   * @param {any} run @param {Map<number, Float64Array>} weights @param {(state: Float64Array, k: number) => Float64Array | null} pull */
  pulledBack(run, weights, pull) {
    const { p, states } = run, weighted = this.engine.named("outputs_adjoint").inputs.at(-1), total = new Float64Array(p.length);
    for (let k = 0; k < states.length; k++) {
      const bars = Float64Array.from({ length: weighted ?? 0 }, (_, r) => weights.get(r)?.[k] ?? 0);
      if (!bars.some((value) => value !== 0)) continue;
      const [state, own] = this.engine.evaluate("outputs_adjoint", [this.times[k]], states[k], p, bars) ?? [], more = state && pull(state, k);
      if (!own || !more) return total.fill(NaN);
      for (let i = 0; i < p.length; i++) total[i] += own[i] + more[i];
    }
    return total;
  }
}

/** Linear statics under load cases. */
export class LiveStatics extends LiveStructure {
  /** @override @param {ArrayLike<number>} parameters @returns {any} */
  run(parameters) {
    const { engine, data } = this, p = this.checked(parameters), n = data.free ?? 0;
    engine.top = this.base;
    const [factor, sides, stiffness] = this.factored(p), right = this.times.length ? Array.from(this.times, (_, k) => sides.subarray(n * k, n * (k + 1))) : [];
    const states = right.map((side) => backward(factor, forward(factor, side))), scale = Math.max(largest(sides), Number.MIN_VALUE);
    const residual = Math.max(0, ...states.flatMap((u, k) => stiffness.map((row, i) => Math.abs(dot(row, u) - right[k][i])))) / scale;
    const status = { outcome: "completed", message: data.message ?? "", time: 0, residual, success: true };
    return { ...this.tabled(p, states), status, p, states, factor };
  }

  /** @override @param {any} run @param {Map<number, Float64Array>} weights */
  gradient(run, weights) {
    const { p, states, factor } = run;
    return this.pulledBack(run, weights, (bar, k) => this.engine.evaluate("residual_adjoint", [this.times[k]], states[k], p, backward(factor, forward(factor, bar)))?.[0] ?? null);
  }
}

/** Modes `x` with `xᵀ K x = 1` and `xᵀ M x = 1/λ`, from the factor of `K`, and their order by frequency. @param {Matrix} factor @param {Matrix} mass */
export function vibrationModes(factor, mass) {
  const half = mass.map((row) => forward(factor, row)), reduced = matrixOf(Float64Array.from(half.flatMap((row) => Array.from(row))), mass.length), whole = reduced.map((row) => forward(factor, row));
  const { values, vectors } = symmetricEigenpairs(whole), order = [...values.keys()].sort((a, b) => values[b] - values[a]);
  return { values, bases: vectors.map((vector) => backward(factor, vector)), order };
}

/** Natural vibration: `K φ = λ M φ` by the eigenvalues `1/λ` of `L⁻¹ M L⁻ᵀ` with `K = L Lᵀ`. */
export class LiveVibration extends LiveStructure {
  /** @override @param {ArrayLike<number>} parameters @returns {any} */
  run(parameters) {
    const { engine, data } = this, p = this.checked(parameters), n = data.free ?? 0;
    engine.top = this.base;
    const [factor, masses] = this.factored(p), { values, bases, order } = vibrationModes(factor, matrixOf(masses, n)), wanted = order.slice(0, this.times.length).filter((k) => values[k] > 0);
    const states = wanted.map((k) => {
      const shape = bases[k].map((value) => value / Math.sqrt(values[k])), peak = shape.reduce((a, b) => (Math.abs(b) > Math.abs(a) * (1 + 1e-9) ? b : a), 0);
      return Float64Array.of(1 / values[k], ...shape.map((value) => (peak < 0 ? -value : value)));
    });
    const status = { outcome: "completed", message: `${data.name}: ${states.length} mode(s)`, time: 0, residual: 0, success: true };
    return { ...this.tabled(p, states), status, p, states, values, bases, wanted };
  }

  /** @override @param {any} run @param {Map<number, Float64Array>} weights */
  gradient(run, weights) {
    const { p, states, values, bases, wanted } = run;
    return this.pulledBack(run, weights, (bar, k) => {
      const [value, ...rest] = states[k], shape = Float64Array.from(rest), shape_bar = bar.subarray(1), left = shape.map((entry) => bar[0] * entry), moved = shape_bar.some((entry) => entry !== 0);
      for (let j = 0; j < values.length; j++) {
        const gap = 1 - value * values[j];
        if (j === wanted[k]) continue;
        if (Math.abs(gap) < COINCIDE) return null;
        if (moved) { const share = dot(bases[j], shape_bar) / gap; for (let i = 0; i < left.length; i++) left[i] -= share * bases[j][i]; }
      }
      return this.engine.evaluate("pencil_adjoint", left, shape, [value, -dot(shape_bar, shape) / 2], p)?.[0] ?? null;
    });
  }
}
