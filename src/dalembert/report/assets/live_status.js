// Status of a run in a live page: the checks of Python with the same limits and wording.

/** @import { LiveCheck, LiveData, LiveStatus } from "./types.d.ts" */

import { general } from "./live_limits.js";
import { RunFailure, largest } from "./live_run.js";

const ROUNDING = [1e-9, 1e-6], LEVELS = ["", "/s", "/s²"];

/** Percentage without decimals, halves to even as in Python. @param {number} x */
function percent(x) {
  const value = 100 * x, below = Math.floor(value);
  return Number.isFinite(value) ? `${value - below === 0.5 ? below + (below % 2) : Math.round(value)}%` : "inf%";
}

/** Samples of a run as functions of the module see them: addresses of times, states and parameters.
 * @typedef {{ engine: import("./live_engine.js").Engine, data: LiveData }} Live
 * @typedef {{ times: Float64Array, states: { t: number, x: number, p: number }, status?: LiveStatus, message?: string, warning?: string }} Sampled */

/** Residuals of the equations of a model at instants. */
class Residuals {
  /** @param {Live} live @param {LiveCheck} check @param {Sampled} run */
  constructor(live, check, run) {
    const { engine } = live, { times, states: { t, x, p } } = run, n = times.length;
    const { inputs: [, width], outputs } = engine.named("residuals");
    this.check = check;
    /** @param {number[]} columns */
    const at = (columns) => {
      const mark = engine.top, count = columns.length, from = [engine.room(count), engine.room(width * count)];
      columns.forEach((k, i) => {
        engine.view(from[0], count)[i] = engine.view(t, n)[k];
        engine.view(from[1] + 8 * width * i, width).set(engine.view(x + 8 * width * k, width));
      });
      const { done, to } = engine.call("residuals", count, [...from, p], new Set([2]));
      const tables = to.map((address, k) => engine.view(address, outputs[k] * count).slice());
      engine.top = mark;
      if (done < count) throw new RunFailure(`the residuals cannot be computed at t = ${general(times[columns[done]], 9)} s`);
      return tables;
    };
    const [sums, rates] = at(Array.from(times, (_, k) => k));
    /** @param {number} row */
    const series = (row) => Float64Array.from(times, (_, k) => sums[5 * k + row]);
    this.times = times;
    this.violations = series(0);
    this.energies = [series(1), series(2)];
    this.work = [series(3), series(4)].map((values) => values.map((value) => value - values[0]));
    this.rates = rates;
    this.width = outputs[1];
    const most = Math.min(n, check.checked), chosen = new Set(Array.from({ length: most }, (_, k) => (most > 1 ? Math.floor((k * (n - 1)) / (most - 1)) : 0)));
    let worst = 0;
    this.violations.forEach((value, k) => { if (!(value <= this.violations[worst])) worst = k; });
    this.columns = [...chosen.add(worst)].sort((a, b) => a - b);
    const [, , rows, terms] = at(this.columns);
    this.rows = rows;
    this.terms = terms;
  }

  /** Largest residual of some rows relative to their sizes. @param {number} first @param {number} count @param {(row: number, term: number) => number} size */
  worst(first, count, size) {
    const height = this.rows.length / this.columns.length;
    let worst = { row: 0, share: -1, value: 0, time: 0 };
    for (let row = 0; row < count; row++)
      this.columns.forEach((column, k) => {
        const at = height * k + first + row, value = Math.abs(this.rows[at]), ratio = value / size(row, this.terms[at]), share = Number.isFinite(ratio) ? ratio : Infinity;
        if (share > worst.share) worst = { row, share, value, time: this.times[column] };
      });
    return worst;
  }

  /** Largest violation of a constraint at a level. @param {number} level @param {boolean} drifts */
  level(level, drifts) {
    const { rows, units, sizes, time, still } = this.check, m = rows.length, natural = time ** -level;
    if (!m) return { share: 0, text: "" };
    let most = still * natural;
    if (drifts && level > 0) {
      const height = this.rows.length / this.columns.length;
      for (let k = 0; k < this.columns.length; k++) for (let row = 0; row < m; row++) most = Math.max(most, this.terms[height * k + m * level + row] / sizes[row]);
    }
    const { row, share, value, time: instant } = this.worst(level * m, m, (row, term) => (drifts && level > 0 ? sizes[row] * most : term + sizes[row] * natural));
    return { share, text: `${rows[row]} is violated by ${general(value, 3)} ${units[row]}${LEVELS[level]} at t = ${general(instant, 9)} s` };
  }

  /** Largest violation of an equation of motion. */
  motion() {
    const { rows, speeds, efforts, effort_units } = this.check;
    if (!speeds.length) return { share: 0, text: "" };
    const { row, share, value, time } = this.worst(3 * rows.length, speeds.length, (row, term) => term + efforts[row]);
    return { share, text: `the equation of motion of ${speeds[row]} is open by ${general(value, 3)} ${effort_units[row]} at t = ${general(time, 9)} s` };
  }

  /** First instant whose accelerations or multipliers are not finite, if there is one. */
  undetermined() {
    const k = this.rates.findIndex((value) => !Number.isFinite(value));
    return k < 0 ? null : this.times[Math.floor(k / this.width)];
  }

  /** Objection to the energy balance, or null. @param {number} limit @param {number} natural */
  balance(limit, natural) {
    const [kinetic, potential] = this.energies, [dissipated, input] = this.work;
    const total = kinetic.map((value, k) => value + potential[k] + dissipated[k] - input[k]);
    const errors = total.map((value) => value - total[0]), change = potential.map((value) => value - potential[0]);
    const moved = largest(kinetic) + largest(change) + largest(dissipated) + largest(input) + ROUNDING[0] * Math.max(largest(kinetic), largest(potential)) + ROUNDING[1] * natural;
    const shares = errors.map((error) => (Number.isFinite(error / moved) ? Math.abs(error) / moved : Infinity));
    let worst = 0;
    shares.forEach((share, k) => { if (share > shares[worst]) worst = k; });
    if (shares[worst] <= limit) return null;
    const verb = errors[worst] > 0 ? "appeared" : "vanished";
    return `${general(Math.abs(errors[worst]), 3)} J ${verb} by t = ${general(this.times[worst], 9)} s, ${percent(shares[worst])} of the ${general(moved, 3)} J that took part in the motion; use a shorter step, or another integrator`;
  }
}

/** Status of a completed run, checked by the model's own equations.
 * @param {Live} live @param {Sampled} run the last run @returns {LiveStatus} */
export function checkedStatus(live, run) {
  const { check } = live.data;
  if (run.status || !check) return run.status ?? { outcome: "completed", message: "", time: 0, residual: 0, success: true };
  const time = run.times[run.times.length - 1];
  const residuals = new Residuals(live, check, run), residual = largest(residuals.violations);
  /** @param {string} outcome @param {string} message */
  const ends = (outcome, message) => ({ outcome, message, time, residual, success: outcome === "completed" });
  const instant = residuals.undetermined();
  if (instant !== null) return ends("singular position", `accelerations have no unique value at t = ${general(instant, 9)} s`);
  if (check.lost !== undefined && residual > check.lost) return ends("not converged", `the projection left a violation of ${general(residual, 3)}; use a shorter step`);
  const violations = check.levels.map(([level, limit, drifts]) => ({ ...residuals.level(level, drifts), limit }));
  if (check.motion !== null) violations.push({ ...residuals.motion(), limit: check.motion });
  for (const { share, text, limit } of violations)
    if (!(share <= limit)) return ends("violates the model's equations", `${text}, ${general(share, 2)} of the size of its terms${check.drift === undefined ? "" : `; use a shorter step${limit === check.drift ? ", or stabilization=Projection()" : ""}`}`);
  const unbalanced = check.balance === undefined ? null : residuals.balance(check.balance, check.energy ?? 0);
  if (unbalanced) return ends("energy not balanced", unbalanced);
  return { ...ends("completed", run.message ?? `reached t = ${general(time, 6)} s`), warning: run.warning };
}

/** Status of a failed run. @param {Live} live @param {RunFailure} failure @returns {LiveStatus} */
export function failedStatus(live, failure) {
  const { engine, data } = live, { check, start } = data, { march } = failure;
  if (!march) return { outcome: failure.outcome, message: failure.message, time: start, residual: failure.residual ?? NaN, success: false };
  const { reason, end, length, x, p } = march, width = engine.named("residuals").inputs[1];
  if (!check) return { outcome: "diverged", message: failure.message, time: end, residual: NaN, success: false };
  const [sums, rates] = engine.evaluate("residuals", [end], x.subarray(0, width), p) ?? [[NaN], []], residual = sums[0];
  /** @param {string} outcome @param {string} message */
  const ends = (outcome, message) => ({ outcome, message, time: end, residual, success: false });
  const singular = "the mechanism may be at a singular position", constrained = check.rows.length > 0;
  const open = engine.functions.has("step_residual") ? engine.evaluate("step_residual", [end], [length], x, p) : null;
  if (open) return ends("not converged", `Newton's method did not converge at t = ${general(end, 9)} s (relative residual ${general(open[0][0], 3)}); use a shorter step${constrained ? ", or look for a singular position there" : ""}`);
  let cause = constrained ? `${singular}, or the step too long` : "the step may be too long";
  if (data.adaptive) cause = fastest(check, rates, constrained ? `, or ${singular}` : "");
  return ends("diverged", `${reason} after t = ${general(end, 9)} s; ${cause}`);
}

/** Speed that changes fastest. @param {LiveCheck} check @param {ArrayLike<number>} rates @param {string} more */
function fastest({ speeds, speed_sizes }, rates, more) {
  const finite = speeds.map((_, k) => k).filter((k) => Number.isFinite(rates[k]));
  if (!finite.length) return "accelerations are not finite there";
  const k = finite.reduce((a, b) => (Math.abs(rates[b]) / speed_sizes[b] > Math.abs(rates[a]) / speed_sizes[a] ? b : a));
  return `${speeds[k]} changes by ${general(rates[k], 3)} per second there, the fastest of all speeds; a force may jump or grow without bound${more}`;
}
