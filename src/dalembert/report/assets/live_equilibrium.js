// Equilibrium of a mechanism in a live page, followed from that of the result. All mechanics is in the module.

import { LiveInstants } from "./live_instants.js";

/** Equilibria of one mechanism, one after the other. */
export class LiveEquilibrium extends LiveInstants {
  /** @override */
  get unsolved() { return "no equilibrium was found"; }

  /** Equilibrium with outputs. @override @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, times } = this, p = Float64Array.from(parameters);
    engine.top = this.base;
    const x = this.assembled(p);
    return this.sampled(engine.put(times), engine.put(x), engine.put(p));
  }
}
