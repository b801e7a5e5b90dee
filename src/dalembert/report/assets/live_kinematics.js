// Driven motion of a mechanism in a live page: Newton's method from instant to instant. All mechanics is in the module.

/** @import { LiveData } from "./types.d.ts" */

import { LiveInstants } from "./live_instants.js";
import { simpson } from "./live_quadrature.js";
import { RunFailure } from "./live_run.js";
import { general } from "./live_limits.js";

const STRETCH = 200;

/** Motions of one driven mechanism, one after the other. */
export class LiveKinematics extends LiveInstants {
  /** Column at the start. @override @param {Float64Array} p @param {Float64Array} y */
  initial(p, y) {
    const { data: { limits, path = [] } } = this, start = new Float64Array(this.size), { regular = 0 } = limits ?? {};
    start.set(y);
    const [first] = this.engine.evaluate("step", start, [path[0]], [0], p) ?? [];
    if (!first || !first.every(Number.isFinite) || first[this.size - 3] < regular * 1e-3)
      throw new RunFailure(`at t = ${general(path[0], 6)} s the mechanism stands in a singular position and velocities are not determined`, undefined, undefined, "singular position");
    return first;
  }

  /** Positions, speeds, accelerations and multipliers at all instants of the path. @param {Float64Array} p @returns address of the columns */
  travelled(p) {
    const { engine, size, data } = this, path = Float64Array.from(data.path ?? []), y = this.assembled(p), columns = engine.room(size * path.length);
    const h = path.slice(1).map((t, k) => t - path[k]), [ts, hs, ps] = [path, h, p].map((values) => engine.put(values));
    engine.view(columns, size).set(this.initial(p, y));
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
      if ((h /= 2) < shortest) throw new RunFailure(`no continuous position was found after t = ${general(now, 9)} s`, undefined, undefined, "locked: no position satisfies the drivers");
    }
    return last;
  }

  /** Motion with outputs. @override @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, data, size, times } = this, p = this.checked(parameters), n = times.length;
    engine.top = this.base;
    const columns = this.travelled(p), [t, ps, x] = [engine.put(times), engine.put(p), engine.room(size * n)];
    (data.places ?? []).forEach((k, i) => engine.view(x + 8 * size * i, size).set(engine.view(columns + 8 * size * k, size)));
    const result = { ...this.sampled(t, x, ps), columns };
    this.addWork(result);
    return result;
  }

  /** Add dissipated energy and energy input to the rows that contain them: integrals of the powers along the path. @param {any} result */
  addWork({ table, columns, states }) {
    const { engine, data } = this, { path = [], places = [], work = [] } = data, count = path.length, n = this.times.length;
    if (!work.length) return;
    const { to: [address] } = engine.call("powers", count, [engine.put(path), columns, states.p], new Set([2])), powers = engine.view(address, 2 * count).slice();
    for (const part of [0, 1]) {
      const energy = new Float64Array(count);
      simpson(Float64Array.from(path)).forEach((entries, k) => { energy[k + 1] = entries.reduce((sum, [j, weight]) => sum + weight * powers[2 * j + part], energy[k]); });
      for (const [row, ...factors] of work) for (let i = 0; i < n; i++) table[n * row + i] += factors[part] * (energy[places[i]] - (data.relative.includes(row) ? energy[places[0]] : 0));
    }
  }

  /** Gradient of a response by the parameters. @override @param {any} run the last run @param {Map<number, Float64Array>} samples row → weights of its samples */
  gradient(run, samples) {
    const { engine, data, size } = this, { path = [], places = [], work = [] } = data, total = super.gradient(run, samples), mark = engine.top;
    const bars = path.map(() => [0, 0]);
    for (const [row, ...factors] of work) samples.get(row)?.forEach((weight, i) => {
      for (const part of [0, 1]) {
        bars[places[i]][part] += weight * factors[part];
        if (data.relative.includes(row)) bars[places[0]][part] -= weight * factors[part];
      }
    });
    if (!bars.some((pair) => pair.some(Boolean))) return total;
    const intervals = simpson(Float64Array.from(path)), later = [0, 0], powers = path.map(() => [0, 0]);
    for (let k = intervals.length - 1; k >= 0; k--) for (const part of [0, 1]) {
      later[part] += bars[k + 1][part];
      for (const [j, weight] of intervals[k]) powers[j][part] += weight * later[part];
    }
    const [t, w] = [engine.put(path), engine.put(powers.flat())];
    powers.forEach((pair, j) => {
      if (!pair.some(Boolean)) return;
      const inner = engine.top, { done, to: [slope] } = engine.call("powers_adjoint", 1, [t + 8 * j, run.columns + 8 * size * j, run.states.p, w + 16 * j]), part = engine.view(slope, total.length);
      for (let k = 0; k < total.length; k++) total[k] += done ? part[k] : NaN;
      engine.top = inner;
    });
    engine.top = mark;
    return total;
  }
}
