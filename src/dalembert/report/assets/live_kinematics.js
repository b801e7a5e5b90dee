// Driven motion of a mechanism in a live page: Newton's method from instant to instant. All mechanics is in the module.

/** @import { LiveData } from "./types.d.ts" */

import { LiveInstants } from "./live_instants.js";
import { RunFailure } from "./live_run.js";

const STRETCH = 200;

/** Motions of one driven mechanism, one after the other. */
export class LiveKinematics extends LiveInstants {
  /** Positions, speeds, accelerations and multipliers at all instants of the path. @param {Float64Array} p @returns address of the columns */
  travelled(p) {
    const { engine, size, data } = this, path = Float64Array.from(data.path ?? []), y = this.assembled(p), columns = engine.room(size * path.length);
    const h = path.slice(1).map((t, k) => t - path[k]), [ts, hs, ps] = [path, h, p].map((values) => engine.put(values));
    const start = new Float64Array(size), { regular = 0 } = data.limits ?? {};
    start.set(y);
    const [first] = engine.evaluate("step", start, [path[0]], [0], p) ?? [];
    if (!first || !first.every(Number.isFinite) || first[size - 3] < regular * 1e-3)
      throw new RunFailure(`at t = ${path[0]} s the mechanism stands in a singular position and velocities are not determined`, undefined, undefined, "singular position");
    engine.view(columns, size).set(first);
    for (let k = 0; k < h.length; ) {
      const mark = engine.top, count = Math.min(STRETCH, h.length - k);
      const { done, to: [, moved] } = engine.call("step", count, [columns + 8 * size * k, ts + 8 * (k + 1), hs + 8 * k, ps], new Set([3]), true);
      const largest = engine.view(moved, count).slice();
      let good = 0;
      while (good < done && this.trusted(engine.view(columns + 8 * size * (k + good + 1), size), largest[good], h[k + good], path)) good++;
      engine.top = mark;
      k += good;
      if (good === count) continue;
      const column = this.bridged(engine.view(columns + 8 * size * k, size).slice(), path[k], path[k + 1], p, path);
      engine.view(columns + 8 * size * ++k, size).set(column);
    }
    return columns;
  }

  /** Whether a step leads to the continuation of the motion. @param {Float64Array} column @param {number} moved @param {number} h @param {Float64Array} path */
  trusted(column, moved, h, path) {
    const { regular, tolerance, turn, small: [always, share] } = /** @type {NonNullable<LiveData["limits"]>} */ (this.data.limits);
    const [pivots, residual, change] = column.subarray(column.length - 3), small = Math.max(always, (share * Math.abs(h)) / (path[path.length - 1] - path[0]));
    return column.every(Number.isFinite) && residual < tolerance && pivots > regular && change <= Math.max(turn * moved, small);
  }

  /** Column at the end of a difficult interval, by substeps. @param {Float64Array} last @param {number} low @param {number} high @param {Float64Array} p @param {Float64Array} path */
  bridged(last, low, high, p, path) {
    const { fraction } = /** @type {NonNullable<LiveData["limits"]>} */ (this.data.limits), shortest = fraction * (high - low);
    let [now, h] = [low, (high - low) / 2];
    while (now < high) {
      const target = now + h >= high - shortest ? high : now + h, [column, moved] = this.engine.evaluate("step", last, [target], [target - now], p) ?? [];
      if (column && this.trusted(column, moved[0], target - now, path)) { [last, now, h] = [column, target, 2 * h]; continue; }
      if ((h /= 2) < shortest) throw new RunFailure(`no continuous position was found after t = ${now} s`, undefined, undefined, "locked: no position satisfies the drivers");
    }
    return last;
  }

  /** Motion with outputs. @override @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, data, size, times } = this, p = Float64Array.from(parameters), n = times.length;
    engine.top = this.base;
    const columns = this.travelled(p), [t, ps, x] = [engine.put(times), engine.put(p), engine.room(size * n)];
    (data.places ?? []).forEach((k, i) => engine.view(x + 8 * size * i, size).set(engine.view(columns + 8 * size * k, size)));
    return this.sampled(t, x, ps);
  }
}
