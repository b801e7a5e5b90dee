// Frequency responses in a live page: frequencies, peaks, outputs and gradients of any linear system.

/** @import { LiveGrid } from "./types.d.ts" */

import { defaultFrequencies, distinct, localMaxima, refinedMaximum, TURN_ANGLE, undampedPoles } from "./live_grid.js";
import { general } from "./live_limits.js";
import { LiveRun } from "./live_run.js";

/** Upper limit of the frequencies with a drawing. */
const SHAPES = 61;

/** Amplitudes at a frequency. @typedef {{ f: number, omega: number, h: Float64Array }} Harmonic */
/** Linear system of a design. @typedef {{ poles: [number, number][], span?: [number, number], at(f: number): Harmonic, rate(sample: any): Float64Array }} System */

/** Frequency responses; times are frequencies [Hz]. A subclass has the linear system. */
export class LiveHarmonic extends LiveRun {
  /** @param {Float64Array} p @returns {System} */
  system(p) { throw new Error(`no system of ${p.length} parameters`); }

  /** Rows of the picture at a frequency. @param {any} system @param {any} sample @returns {ArrayLike<number>} */
  picture(system, sample) { return []; }

  /** Weights of the parameters from those of the amplitudes. @param {any} system @param {{ f: number, bars: Float64Array }[]} samples @returns {Float64Array} */
  parameterWeights(system, samples) { throw new Error(`no weights of ${samples.length} samples`); }

  /** Rows of outputs at a frequency. @param {Harmonic} sample @param {Float64Array} p */
  row({ f, h }, p) { return this.engine.evaluate("outputs", [f], h, p)?.[0] ?? new Float64Array(); }

  /** Derivatives of rows by amplitudes, parameters and the frequency: columns of each row, one after the other. @param {Harmonic} sample @param {Float64Array} p */
  slopes({ f, h }, p) { return this.engine.evaluate("slopes", [f], h, p) ?? []; }

  /** Response with outputs: `table` holds the rows one after the other. @override @param {ArrayLike<number>} parameters @returns {any} */
  run(parameters) {
    const { data, engine } = this, grid = /** @type {LiveGrid} */ (data.grid), p = this.checked(parameters);
    engine.top = this.base;
    const system = this.system(p), follows = grid.default && data.steady !== false && system.poles.length > 0;
    const base = follows ? defaultFrequencies(system.poles, { ...grid, span: system.span ?? grid.span }) : Array.from(this.times), columns = new Map(base.map((f) => { const sample = system.at(f); return [f, { sample, row: this.row(sample, p) }]; }));
    const { found, infinite } = this.peaks(system, base, (f) => /** @type {any} */ (columns.get(f)).row, p);
    const peaks = new Set((data.amplitudes ?? []).flatMap((row) => found.get(`${row} 1`) ?? [])), all = distinct([...base, ...data.requested ?? [], ...[...found.values()].flat()]), numbers = new Map(all.map((f, k) => [f, k])), n = all.length;
    for (const f of all) if (!columns.has(f)) { const sample = system.at(f); columns.set(f, { sample, row: this.row(sample, p) }); }
    const even = Math.max(2, SHAPES - peaks.size), places = all.map((f, k) => ({ f, k })).filter(({ f }) => peaks.has(f)).slice(0, SHAPES).map(({ k }) => k);
    const inside = /** @type {[number, number]} */ ([all.indexOf(base[0]), all.indexOf(/** @type {number} */ (base.at(-1))) + 1]), last = inside[1] - 1 - inside[0];
    const drawn = distinct([...places, ...Array.from({ length: even }, (_, i) => inside[0] + Math.round((i * last) / (even - 1)))]);
    const pictures = new Map(drawn.map((k) => [k, this.picture(system, /** @type {any} */ (columns.get(all[k])).sample)])), shown = engine.named("outputs").outputs[0], rows = shown + (pictures.get(drawn[0])?.length ?? 0);
    const table = new Float64Array(rows * n).fill(NaN);
    all.forEach((f, k) => {
      const { row } = /** @type {any} */ (columns.get(f)), picture = pictures.get(k) ?? [];
      for (let r = 0; r < shown; r++) table[n * r + k] = row[r];
      for (let r = 0; r < picture.length; r++) table[n * (shown + r) + k] = picture[r];
    });
    for (const [row, f] of infinite) table[n * row + all.indexOf(f)] = Infinity;
    const status = { outcome: "completed", message: `${data.name} at ${n} frequencies`, time: data.start, residual: 0, success: true, warning: this.warning(system, grid, infinite) };
    return { times: Float64Array.from(all), table, rows, status, inside, located: new Map([...found].map(([key, places]) => [key, places.map((f) => numbers.get(f) ?? 0).sort((a, b) => a - b)])), drawn: Int32Array.from(drawn), peaks: drawn.map((k) => peaks.has(all[k])), response: { system, p } };
  }

  /** Frequencies of the local maxima of rows, and rows that grow without limit, with the highest sample beside.
   * @param {System} system @param {number[]} base @param {(f: number) => Float64Array} at @param {Float64Array} p */
  peaks(system, base, at, p) {
    const grid = /** @type {LiveGrid} */ (this.data.grid), undamped = undampedPoles(system.poles, grid).map(([, im]) => im / TURN_ANGLE);
    /** @type {Map<string, number[]>} */
    const found = new Map();
    /** @type {[number, number][]} */
    const infinite = [];
    for (const [row, sign] of this.data.extremes ?? []) {
      const values = base.map((f) => sign * at(f)[row]), value = (/** @type {number} */ f) => sign * this.row(system.at(f), p)[row];
      const grows = (/** @type {number} */ f) => Math.abs(value(f * (1 + grid.near))) > grid.growth * Math.abs(value(f * (1 + grid.far)));
      const slope = (/** @type {number} */ f) => sign * this.frequencySlope(system, f, row, p), tops = localMaxima(values), places = /** @type {number[]} */ ([]);
      for (const k of tops) {
        const place = undamped.find((f) => base[k - 1] < f && f < base[k + 1]);
        if (place !== undefined && grows(place)) { infinite.push([row, base[k]]); places.push(base[k]); }
        else places.push(refinedMaximum([base[k - 1], base[k], base[k + 1]], [values[k - 1], values[k], values[k + 1]], value, slope, grid));
      }
      found.set(`${row} ${sign}`, places);
    }
    return { found, infinite };
  }

  /** Derivative of a row by the frequency. @param {System} system @param {number} f @param {number} row @param {Float64Array} p */
  frequencySlope(system, f, row, p) {
    const sample = system.at(f), [byAmplitudes, , byFrequency] = this.slopes(sample, p), rate = system.rate(sample), width = sample.h.length;
    return rate.reduce((sum, value, k) => { const slope = byAmplitudes[row * width + k]; return slope ? sum + slope * value : sum; }, byFrequency[row]);
  }

  /** Warning about motions that grow, and about infinite amplitudes. @param {System} system @param {LiveGrid} grid @param {[number, number][]} infinite */
  warning({ poles }, grid, infinite) {
    const growth = Math.max(0, ...poles.map(([re]) => re)), largest = Math.max(0, ...poles.map(([re, im]) => Math.hypot(re, im)));
    if (growth > grid.unstable * largest) return `The operating point is unstable, motions grow with up to ${general(growth, 3)} 1/s: disturbances leave the harmonic response`;
    const [first] = infinite;
    return first ? `No damping acts on the resonance at ${general(first[1], 6)} Hz: amplitudes are infinite there` : "";
  }

  /** Gradient of a response by the parameters. @override @param {any} run the last run @param {Map<number, Float64Array>} weights row → weights of the frequencies */
  gradient(run, weights) {
    const { times, table, response: { system, p } } = run, n = times.length, total = new Float64Array(p.length), samples = [];
    for (let k = 0; k < n; k++) {
      const active = [...weights].filter(([, values]) => values[k] !== 0);
      if (!active.length) continue;
      if (active.some(([row]) => !Number.isFinite(table[n * row + k]))) return total.fill(NaN);
      const sample = system.at(times[k]), [byAmplitudes, byParameters] = this.slopes(sample, p), width = sample.h.length, bars = new Float64Array(width);
      for (const [row, values] of active) {
        for (let i = 0; i < width; i++) bars[i] += values[k] * byAmplitudes[row * width + i];
        for (let i = 0; i < p.length; i++) total[i] += values[k] * byParameters[row * p.length + i];
      }
      if (!bars.every(Number.isFinite)) return total.fill(NaN);
      samples.push({ f: times[k], bars });
    }
    this.parameterWeights(system, samples).forEach((value, i) => { total[i] += value; });
    return total;
  }
}
