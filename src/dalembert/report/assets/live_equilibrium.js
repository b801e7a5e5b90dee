// Equilibrium of a mechanism in a live page, followed from that of the result. All mechanics is in the module.

import { eigenvalues } from "./live_eigenvalues.js";
import { growthRates } from "./live_growth.js";
import { LiveInstants } from "./live_instants.js";
import { matrixOf, product, spaces, transposed } from "./live_matrix.js";
import { general } from "./live_limits.js";

/** @param {number} count @param {string} noun */
const counted = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/** Equilibria of one mechanism, one after the other. */
export class LiveEquilibrium extends LiveInstants {
  /** Equilibrium with outputs. @override @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, times } = this, p = this.checked(parameters);
    engine.top = this.base;
    const x = this.assembled(p), texts = this.texts(x, p);
    return { ...this.sampled(engine.put(times), engine.put(x), engine.put(p)), ...texts };
  }

  /** Residual and stability, as in Python. @param {Float64Array} x @param {Float64Array} p @returns {{ message: string, warning: string }} */
  texts(x, p) {
    const { engine, data } = this, { columns, force, unit } = /** @type {NonNullable<typeof data.stable>} */ (data.stable), [open] = engine.evaluate("violation", [data.start], x, p) ?? [];
    const residual = Math.max(0, ...open.subarray(0, columns).map(Math.abs)) * force, { kind, leaves } = data.sizes ? this.growth(x, p) : this.stiffness(x, p);
    return { message: `residual ${general(residual, 3)} ${unit} after ${counted(this.iterations, "iteration")}, ${leaves ? "not a stable position" : kind}`, warning: leaves && `The equilibrium is not stable: ${leaves}` };
  }

  /** Stability by the eigenvalues of motions of bodies and states. @param {Float64Array} x @param {Float64Array} p */
  growth(x, p) {
    const rates = growthRates(this, x, p), most = rates.reduce((a, b) => Math.max(a, b), 0);
    return { kind: "stable", leaves: rates.length ? `${counted(rates.length, "motion")} of the bodies and states grow with rates up to ${general(most, 3)} 1/s` : "" };
  }

  /** Stability by the stiffness along the free directions. @param {Float64Array} x @param {Float64Array} p */
  stiffness(x, p) {
    const { engine, data } = this, { curved, skew, rows, columns } = /** @type {NonNullable<typeof data.stable>} */ (data.stable), [c, k] = engine.evaluate("stiffness", [data.start], x, p) ?? [];
    const free = spaces(matrixOf(c, rows), columns).free, across = free[0]?.length ?? 0, stiffness = product(transposed(free, across), product(matrixOf(k, columns), free));
    const parts = (eigenvalues(stiffness) ?? [[NaN]]).map(([real]) => real), largest = Math.max(0, ...stiffness.map((row) => Math.max(...row.map(Math.abs))));
    const conservative = stiffness.every((row, i) => row.every((value, j) => Math.abs(value - stiffness[j][i]) <= skew * largest));
    const stable = parts.every((value) => value > (conservative ? 0 : curved * largest));
    return { kind: conservative ? "stable" : "statically stable (loads without potential: check flutter by linearize)", leaves: stable ? "" : "the mechanism leaves it" };
  }
}
