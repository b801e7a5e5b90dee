// Results at instants that do not depend on each other: outputs and gradients.

import { LiveRun, RunFailure, smoothWeights, tabulated } from "./live_run.js";

/** Analyses whose instants have their own adjoints. */
export class LiveInstants extends LiveRun {
  /** Result from states at the times of the outputs: `table` holds the rows one after the other.
   * @param {number} t address of the times @param {number} x of the states @param {number} p of the parameters
   * @returns {any} */
  sampled(t, x, p) {
    const { engine, data, times } = this, n = times.length, [rows] = engine.named("outputs").outputs;
    const { done, to: [result] } = engine.call("outputs", n, [t, x, p], new Set([2]));
    if (done < n) throw new RunFailure(`the outputs cannot be computed at t = ${times[done]} s`);
    const table = tabulated(engine.view(result, rows * n), rows, data);
    for (const r of data.undetermined ?? []) table.fill(NaN, r * n, (r + 1) * n);
    return { times, table, rows, states: { t, x, p } };
  }

  /** Gradient of a response by the parameters, each instant by its own adjoint.
   * @override @param {any} run the last run @param {Map<number, Float64Array>} samples row → weights of its samples */
  gradient(run, samples) {
    const { engine, data } = this, { times, rows, states: { t, x, p } } = run, n = times.length, mark = engine.top, w = engine.room(rows * n);
    const weights = engine.view(w, rows * n), [count] = engine.named("outputs_adjoint").outputs, total = new Float64Array(count);
    weights.fill(0);
    for (const [r, values] of smoothWeights(run, samples, data)) {
      for (let i = 0; i < n; i++) weights[rows * i + r] = values[i];
      if (data.relative.includes(r)) weights[r] -= values.reduce((a, b) => a + b, 0);
      if (data.undetermined?.includes(r)) total.fill(NaN);
    }
    const active = Array.from({ length: n }, (_, i) => i).filter((i) => weights.subarray(rows * i, rows * (i + 1)).some((value) => value !== 0));
    for (const i of active) {
      const { done, to: [slope] } = engine.call("outputs_adjoint", 1, [t + 8 * i, x + 8 * this.size * i, p, w + 8 * rows * i]);
      const part = engine.view(slope, count);
      for (let k = 0; k < count; k++) total[k] += done ? part[k] : NaN;
    }
    engine.top = mark;
    return total;
  }
}
