// Run of a mechanism in a live page: assembly, march, outputs, gradients. All mechanics is in the module.

/** @import { LiveData } from "./types.d.ts" */

import { Engine } from "./live_engine.js";
import { invalid } from "./live_limits.js";

const ITERATIONS = 25, CONVERGED = 1e-13, ACCEPTED = 1e-9, SHORTEST = 1e-3, CHUNK = 500, ATTEMPTS = 64, SMALLEST_STEP = 1e-13, GROWTH = 4;

/** Largest magnitude, infinite where a value is no number. @param {ArrayLike<number>} values */
export function largest(values) {
  let most = 0;
  for (let k = 0; k < values.length; k++) { const size = Math.abs(values[k]); if (!(size <= most)) most = size === size ? size : Infinity; }
  return most;
}

/** Ends of prescribed steps, the start included, and whether the steps are corrected. @param {LiveData} data */
function prescribed({ start, steps }) {
  if (!steps) return { ends: new Float64Array(0), flags: new Float64Array(0) };
  const { length = 0, count = 0, end = start } = steps, equal = () => [...Array.from({ length: count }, (_, k) => start + length * k), end];
  const ends = Float64Array.from(steps.ends ?? equal()), flags = new Float64Array(ends.length - 1).fill(1);
  for (const k of steps.uncorrected) flags[k] = 0;
  return { ends, flags };
}

/** March that stopped: its reason, the last state, and the length of the step from there.
 * @typedef {{ reason: string, end: number, length: number, x: Float64Array, p: Float64Array }} BrokenMarch */

/** Failure of a run; `outcome` as in Python. */
export class RunFailure extends Error {
  /** @param {string} message @param {number} [residual] @param {string} [loop] joint that remains open @param {string} [outcome] @param {BrokenMarch} [march] */
  constructor(message, residual, loop, outcome = "cannot be assembled", march) {
    super(message);
    this.residual = residual;
    this.loop = loop;
    this.outcome = outcome;
    this.march = march;
  }
}

/** Rows one after the other from columns of outputs, with their roots and relative to the start. @param {Float64Array} values @param {number} rows @param {LiveData} data */
export function tabulated(values, rows, { roots, relative }) {
  const n = values.length / rows, table = new Float64Array(rows * n);
  for (let i = 0; i < n; i++) for (let r = 0; r < rows; r++) table[r * n + i] = values[rows * i + r];
  for (const r of roots) for (let i = 0; i < n; i++) table[r * n + i] = Math.sqrt(table[r * n + i]);
  for (const r of relative) for (let i = n - 1; i >= 0; i--) table[r * n + i] -= table[r * n];
  return table;
}

/** Weights of the columns of outputs; a root has none at zero.
 * @param {{ table: Float64Array, times: Float64Array }} run @param {Map<number, Float64Array>} weights @param {LiveData} data */
export function smoothWeights({ table, times: { length: n } }, weights, { roots }) {
  return new Map([...weights].map(([r, values]) => [r, roots.includes(r) ? values.map((w, i) => (w && table[r * n + i] ? w / (2 * table[r * n + i]) : 0)) : values]));
}

/** States of a run at the ends of its steps.
 * @typedef {{ count: number, t: Float64Array, h: Float64Array, flags: Float64Array, states: number, p: Float64Array, y: Float64Array, values: number }} March */

/** Runs of one mechanism, one after the other. */
export class LiveRun {
  /** @param {WebAssembly.Module} module @param {LiveData} data */
  constructor(module, data) {
    this.data = data;
    this.engine = new Engine(module, data);
    this.base = this.engine.top;
    /** Nominal position with its parameters, the start of continuation as in Python. */
    this.anchor = { p: Float64Array.from(data.anchor.p), y: Float64Array.from(data.anchor.y) };
    this.size = this.engine.functions.get("step")?.inputs[0] ?? data.anchor.y.length;
    this.grid = prescribed(data);
    /** Number of Newton's iterations of the last start. */
    this.iterations = 0;
    this.times = Float64Array.from(data.times ?? this.grid.ends);
  }

  /** Failure where Newton's method has no solution. @param {number} residual */
  failure(residual) {
    const { unsolved } = this.data;
    return unsolved ? new RunFailure(unsolved, residual, undefined, "not converged") : new RunFailure("the mechanism cannot be assembled", residual);
  }

  /** Parameters of a run. @param {ArrayLike<number>} parameters @throws {RunFailure} a quantity is outside its limits */
  checked(parameters) {
    const p = Float64Array.from(parameters), { quantities = [] } = this.data;
    this.engine.top = this.base;
    const numbers = quantities.length ? this.engine.evaluate("quantities", p)?.[0] : [], wrong = invalid(quantities, numbers ?? []);
    if (wrong) throw new RunFailure(wrong, undefined, undefined, "invalid value");
    return p;
  }

  /** Newton's method for the assembled position. @param {Float64Array} y @param {Float64Array} p @param {string} [name] function of a step */
  closed(y, p, name = "closing") {
    let position = y, smallest = Infinity, last = Infinity;
    for (let k = 0; k <= ITERATIONS; k++) {
      this.iterations++;
      const step = this.engine.evaluate(name, [this.data.start], position, p);
      if (!step) return { y: position, residual: last, accepted: false };
      const [next, open] = step, size = largest(open);
      if (size <= CONVERGED || (last <= ACCEPTED && size > last / 2)) return { y: size <= last ? next : position, residual: Math.min(size, last), accepted: true };
      if (!(size <= GROWTH * smallest) || !Number.isFinite(largest(next))) return { y: position, residual: size, accepted: false };
      smallest = Math.min(smallest, size);
      [position, last] = [next, size];
    }
    return { y: position, residual: last, accepted: false };
  }

  /** Assembled position for parameters, by continuation from the nominal one. @param {Float64Array} p */
  assembled(p) {
    const { p: p0 } = this.anchor;
    /** @type {[Float64Array, number, number]} */
    let [y, reached, step] = [this.anchor.y, 0, 1];
    this.iterations = 0;
    while (reached < 1) {
      const target = Math.min(1, reached + step), between = p0.map((value, k) => value + target * (p[k] - value));
      const solution = this.closed(y, target === 1 ? p : between);
      if (solution.accepted) { [y, reached, step] = [solution.y, target, 2 * step]; continue; }
      if ((step /= 2) < SHORTEST) throw this.failure(solution.residual);
    }
    const [open] = this.engine.evaluate("violation", [this.data.start], y, p) ?? [[Infinity]], residual = largest(open);
    if (!(residual <= ACCEPTED)) throw this.failure(residual);
    return y;
  }

  /** State at the start. @param {Float64Array} p @param {Float64Array} y assembled position */
  initial(p, y) {
    const [x0] = this.engine.evaluate("start", [this.data.start], y, p) ?? [];
    if (!x0 || !Number.isFinite(largest(x0))) throw new RunFailure("the initial speeds are not determined", undefined, undefined, "singular position");
    return x0;
  }

  /** Outputs of the first instant alone; null for analyses other than motions from their start.
   * @param {ArrayLike<number>} parameters @returns {{ times: Float64Array, table: Float64Array, rows: number } | null} */
  first(parameters) {
    const { engine, data } = this, times = this.times.slice(0, 1);
    if (!["dynamics", "kinematics"].includes(data.kind) || times[0] !== data.start) return null;
    const p = this.checked(parameters), state = this.initial(p, this.assembled(p)), [values] = engine.evaluate("outputs", times, state.subarray(0, engine.named("outputs").inputs[1]), p) ?? [];
    if (!values) throw new RunFailure(`the outputs cannot be computed at t = ${times[0]} s`);
    const table = tabulated(values, values.length, data);
    for (const row of data.undetermined ?? []) table[row] = NaN;
    return { times, table, rows: values.length };
  }

  /** States of a run. @param {Float64Array} p @returns {March} */
  march(p) {
    const { engine, data } = this;
    engine.top = this.base;
    const y = this.assembled(p), x0 = this.initial(p, y);
    const [q] = engine.evaluate("values", p) ?? [], values = engine.put(q ?? []);
    return data.steps ? this.fixed(p, y, x0, values) : this.adaptive(p, y, x0, values);
  }

  /** March with prescribed steps. @param {Float64Array} p @param {Float64Array} y @param {Float64Array} x0 @param {number} values */
  fixed(p, y, x0, values) {
    const { engine, size } = this, { ends, flags } = this.grid, count = flags.length, t = ends.subarray(0, count), h = t.map((begin, k) => ends[k + 1] - begin);
    const states = engine.room(size * (count + 1)), [ts, hs, fs] = [t, h, flags].map((column) => engine.put(column));
    engine.view(states, size).set(x0);
    for (let k = 0; k < count; k += CHUNK) {
      const mark = engine.top, length = Math.min(CHUNK, count - k);
      const { done } = engine.call("step", length, [states + 8 * size * k, ts + 8 * k, hs + 8 * k, fs + 8 * k, values], new Set([4]), true);
      engine.top = mark;
      const reached = engine.view(states + 8 * size * (k + done), size);
      if (done === length && Number.isFinite(largest(reached))) continue;
      let last = k;
      while (last < k + done && Number.isFinite(largest(engine.view(states + 8 * size * (last + 1), size)))) last++;
      const reason = last < k + done ? "the state is no longer finite" : "a step failed";
      throw this.broken(reason, t[last], h[last], engine.view(states + 8 * size * last, size).slice(), p);
    }
    return { count, t, h, flags, states, p, y, values };
  }

  /** Failure of a march. @param {string} reason @param {number} end @param {number} length @param {Float64Array} x @param {Float64Array} p */
  broken(reason, end, length, x, p) { return new RunFailure(`${reason} after t = ${end} s`, undefined, undefined, "diverged", { reason, end, length, x, p }); }

  /** March with error control: attempts that accept or reject their step. @param {Float64Array} p @param {Float64Array} y @param {Float64Array} x0 @param {number} values */
  adaptive(p, y, x0, values) {
    const { engine, size, data } = this, { end, first, longest, memory } = /** @type {NonNullable<LiveData["adaptive"]>} */ (data.adaptive);
    const head = 2 + memory.length, width = head + size, record = engine.named("attempt").outputs[1];
    const state = engine.put([data.start, first, ...memory, ...x0]), fixed = engine.put([end, longest, ...p]);
    const chunk = engine.room(width * (ATTEMPTS + 1));
    /** @type {number[]} */ const t = [];
    /** @type {number[]} */ const h = [];
    /** @type {Float64Array[]} */ const accepted = [x0];
    let [now] = engine.view(state, 1);
    engine.view(chunk, width).set(engine.view(state, width));
    while (now < end) {
      const mark = engine.top, { done, to } = engine.call("attempt", ATTEMPTS, [chunk, fixed], new Set([1]), true);
      const records = engine.view(to[1], record * ATTEMPTS), states = engine.view(chunk, width * (ATTEMPTS + 1));
      for (let k = 0; k < done; k++) {
        const [begin, length, , success] = records.subarray(record * k, record * (k + 1));
        if (!(success > 0.5 && length > 0)) continue;
        t.push(begin);
        h.push(length);
        accepted.push(states.slice(width * (k + 1) + head, width * (k + 2)));
      }
      engine.top = mark;
      const last = states.slice(width * done, width * (done + 1));
      now = last[0];
      const reached = h.length ? t[h.length - 1] + h[h.length - 1] : data.start, short = last[1] < SMALLEST_STEP * Math.max(end - data.start, Math.abs(now));
      const reason = !Number.isFinite(largest(last)) ? "the state is no longer finite" : done < ATTEMPTS ? "a step failed" : now < end && short ? `the step length fell below ${last[1].toExponential(1).replace(/-(\d)$/, "-0$1")} s` : "";
      if (reason) throw this.broken(reason, reached, last[1], accepted[accepted.length - 1], p);
      engine.view(chunk, width).set(last);
    }
    const states = engine.room(size * accepted.length);
    accepted.forEach((x, k) => engine.view(states + 8 * size * k, size).set(x));
    return { count: h.length, t: Float64Array.from(t), h: Float64Array.from(h), flags: new Float64Array(h.length).fill(1), states, p, y, values };
  }

  /** Times of the outputs, their steps and the states there.
   * @param {March} march @returns {{ times: Float64Array, steps: Int32Array, lengths: Float64Array, x: number }} */
  places(march) {
    const { engine, size, data } = this, { count, t, h } = march, { times } = this, n = times.length;
    const steps = new Int32Array(n), lengths = new Float64Array(n), x = engine.room(size * n), slack = data.instant;
    for (let i = 0, k = 0; i < n; i++) {
      while (k < count - 1 && t[k + 1] <= times[i] + slack) k++;
      steps[i] = k;
      const length = times[i] - t[k];
      lengths[i] = length < slack ? 0 : Math.abs(length - h[k]) < slack ? h[k] : length;
    }
    const all = engine.view(march.states, size * (count + 1)), at = engine.view(x, size * n);
    /** @type {number[]} */ const inside = [];
    for (let i = 0; i < n; i++) {
      const ends = lengths[i] !== 0 && lengths[i] === h[steps[i]];
      if (lengths[i] !== 0 && !ends) inside.push(i);
      const k = steps[i] + (ends ? 1 : 0);
      at.set(all.subarray(size * k, size * (k + 1)), size * i);
    }
    if (inside.length) {
      const m = inside.length, from = engine.room(size * m), begin = engine.view(from, size * m), reached = engine.view(march.states, size * (count + 1));
      inside.forEach((i, j) => begin.set(reached.subarray(size * steps[i], size * (steps[i] + 1)), size * j));
      const arguments_ = [inside.map((i) => t[steps[i]]), inside.map((i) => lengths[i]), inside.map(() => 1)].map((column) => engine.put(column));
      const { to: [result] } = engine.call("step", m, [from, ...arguments_, march.values], new Set([4]));
      const ends = engine.view(result, size * m), target = engine.view(x, size * n);
      inside.forEach((i, j) => target.set(ends.subarray(size * j, size * (j + 1)), size * i));
    }
    return { times, steps, lengths, x };
  }

  /** Run with outputs: `table` holds the rows one after the other.
   * @param {ArrayLike<number>} parameters */
  run(parameters) {
    const { engine, data } = this, p = this.checked(parameters), march = this.march(p), places = this.places(march), n = places.times.length;
    const [rows] = engine.named("outputs").outputs, ps = engine.put(p), ts = engine.put(places.times);
    const x = this.leading(places.x, n), { done, to: [result] } = engine.call("outputs", n, [ts, x, ps], new Set([2]));
    if (done < n) throw new RunFailure(`the outputs cannot be computed at t = ${places.times[done]} s`);
    const table = tabulated(engine.view(result, rows * n), rows, data);
    return { times: places.times, table, rows, states: { t: ts, x, p: ps }, march, places };
  }

  /** The leading part of states, without the memory of multistep methods. @param {number} x @param {number} n */
  leading(x, n) {
    const { engine, size } = this, width = engine.named("outputs").inputs[1];
    if (width === size) return x;
    const part = engine.room(width * n), from = engine.view(x, size * n), to = engine.view(part, width * n);
    for (let i = 0; i < n; i++) to.set(from.subarray(size * i, size * i + width), width * i);
    return part;
  }

  /** Gradient of a response by the parameters: backward march from the weights of its samples.
   * @param {ReturnType<LiveRun["run"]>} run the last run
   * @param {Map<number, Float64Array>} of_samples row → weights of its samples */
  gradient(run, of_samples) {
    const weights = smoothWeights(run, of_samples, this.data);
    const { engine, size, data } = this, { march, places, rows } = run, { count, p } = march, n = places.times.length, mark = engine.top;
    const width = engine.named("outputs").inputs[1], total = new Float64Array(p.length);
    const active = Array.from({ length: n }, (_, i) => i).filter((i) => i === 0 ? [...weights.keys()].some((r) => data.relative.includes(r)) || [...weights.values()].some((w) => w[0] !== 0) : [...weights.values()].some((w) => w[i] !== 0));
    const m = active.length, x = engine.room(width * m), w = engine.room(rows * m), ts = engine.put(active.map((i) => places.times[i])), ps = engine.put(p);
    const all = engine.view(places.x, size * n), at = engine.view(x, width * m), weight = engine.view(w, rows * m);
    weight.fill(0);
    active.forEach((i, j) => {
      at.set(all.subarray(size * i, size * i + width), width * j);
      for (const [r, values] of weights) weight[rows * j + r] = values[i] - (i === 0 && data.relative.includes(r) ? values.reduce((a, b) => a + b, 0) : 0);
    });
    const { to: [xs, more] } = engine.call("outputs_adjoint", m, [ts, x, ps, w], new Set([2]));
    const gradients = engine.view(more, p.length * m);
    for (let j = 0; j < m; j++) for (let k = 0; k < p.length; k++) total[k] += gradients[p.length * j + k];
    const [q] = engine.evaluate("adjoint_values", p) ?? [], [rates] = engine.named("step_adjoint").inputs, qs = engine.put(q ?? []);
    const carried = engine.room(rates * (count + 1)), injected = engine.room(size * (count + 1));
    const ends = engine.view(xs, width * m).slice(), first = new Float64Array(rates), fromInside = this.pulled(run, active, ends, width, qs, first, rates);
    const inject = engine.view(injected, size * (count + 1));
    inject.fill(0);
    engine.view(carried, rates).set(first);
    active.forEach((i, j) => {
      const { steps, lengths } = places, k = steps[i], whole = lengths[i] !== 0 && lengths[i] === march.h[k], state = fromInside.get(j) ?? ends.subarray(width * j, width * (j + 1));
      for (let c = 0; c < state.length; c++) inject[size * (k + (whole ? 1 : 0)) + c] += state[c];
    });
    // columns from the last step to the first
    const [t, h, flags] = [march.t, march.h, march.flags].map((column) => engine.put(column.slice().reverse()));
    const states = engine.room(size * count), back = engine.room(size * count);
    const forward = engine.view(march.states, size * (count + 1)), reversed = engine.view(states, size * count), injections = engine.view(back, size * count), source = engine.view(injected, size * (count + 1)), begin = engine.view(carried, rates);
    for (let k = 0; k < count; k++) {
      reversed.set(forward.subarray(size * (count - 1 - k), size * (count - k)), size * k);
      injections.set(source.subarray(size * (count - 1 - k), size * (count - k)), size * k);
    }
    for (let c = 0; c < size; c++) begin[c] += source[size * count + c];
    const { done } = engine.call("step_adjoint", count, [carried, t, h, flags, states, back, qs], new Set([6]), true);
    const last = engine.view(carried + 8 * rates * done, rates).slice();
    const parts = [engine.evaluate("values_adjoint", p, last.subarray(size))?.[0], engine.evaluate("start_adjoint", [data.start], march.y, p, last.subarray(0, size))?.[0]];
    for (const part of parts) part?.forEach((value, k) => { total[k] += value; });
    engine.top = mark;
    return done === count ? total : total.fill(NaN);
  }

  /** Weights of states at the beginnings of steps from those of outputs inside; weights of parameters are added to `carried`.
   * @param {ReturnType<LiveRun["run"]>} run @param {number[]} active @param {Float64Array} ends @param {number} width @param {number} qs @param {Float64Array} carried @param {number} rates
   * @returns {Map<number, Float64Array>} */
  pulled(run, active, ends, width, qs, carried, rates) {
    const { engine, size } = this, { march, places } = run, inside = active.map((i, j) => [i, j]).filter(([i]) => places.lengths[i] !== 0 && places.lengths[i] !== march.h[places.steps[i]]);
    /** @type {Map<number, Float64Array>} */ const result = new Map();
    if (!inside.length) return result;
    const m = inside.length, weights = inside.map(([, j]) => ends.slice(width * j, width * (j + 1)));
    const from = engine.room(rates * m), states = engine.room(size * m), none = engine.room(size * m);
    const columns = [inside.map(([i]) => march.t[places.steps[i]]), inside.map(([i]) => places.lengths[i]), inside.map(() => 1)].map((column) => engine.put(column));
    const start = engine.view(from, rates * m), at = engine.view(states, size * m), all = engine.view(march.states, size * (march.count + 1));
    start.fill(0);
    engine.view(none, size * m).fill(0);
    inside.forEach(([i], c) => {
      start.set(weights[c], rates * c);
      at.set(all.subarray(size * places.steps[i], size * (places.steps[i] + 1)), size * c);
    });
    const { to: [back] } = engine.call("step_adjoint", m, [from, ...columns, states, none, qs], new Set([6]));
    const pulled = engine.view(back, rates * m);
    inside.forEach(([, j], c) => {
      result.set(j, pulled.slice(rates * c, rates * c + size));
      for (let k = size; k < rates; k++) carried[k] += pulled[rates * c + k];
    });
    return result;
  }
}
