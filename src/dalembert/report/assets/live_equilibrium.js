// Equilibrium of a mechanism in a live page, followed from that of the result. All mechanics is in the module.

import { eigenvalues } from "./live_eigenvalues.js";
import { LiveInstants } from "./live_instants.js";
import { matrixOf, product, spaces, transposed } from "./live_matrix.js";
import { general } from "./live_limits.js";

/** Equilibria of one mechanism, one after the other. */
export class LiveEquilibrium extends LiveInstants {
  /** Equilibrium with outputs. @override @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, times } = this, p = this.checked(parameters);
    engine.top = this.base;
    const x = this.assembled(p), message = this.message(x, p);
    return { ...this.sampled(engine.put(times), engine.put(x), engine.put(p)), message };
  }

  /** Residual and stability, as in Python. @param {Float64Array} x @param {Float64Array} p */
  message(x, p) {
    const { engine, data } = this, { curved, skew, rows, columns, force, unit } = /** @type {NonNullable<typeof data.stable>} */ (data.stable);
    const [c, k] = engine.evaluate("stiffness", [data.start], x, p) ?? [], [open] = engine.evaluate("violation", [data.start], x, p) ?? [];
    const residual = Math.max(0, ...open.subarray(0, columns).map(Math.abs)) * force, iterations = `${this.iterations} iteration${this.iterations === 1 ? "" : "s"}`;
    const free = spaces(matrixOf(c, rows), columns).free, across = free[0]?.length ?? 0, stiffness = product(transposed(free, across), product(matrixOf(k, columns), free));
    const parts = (eigenvalues(stiffness) ?? [[NaN]]).map(([real]) => real), largest = Math.max(0, ...stiffness.map((row) => Math.max(...row.map(Math.abs))));
    const conservative = stiffness.every((row, i) => row.every((value, j) => Math.abs(value - stiffness[j][i]) <= skew * largest));
    const stable = parts.every((value) => value > (conservative ? 0 : curved * largest));
    const kind = !stable ? "not a stable position" : conservative ? "stable" : "statically stable (loads without potential: check flutter by linearize)";
    return `residual ${general(residual, 3)} ${unit} after ${iterations}, ${kind}`;
  }
}
