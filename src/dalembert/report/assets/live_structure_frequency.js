// Frequency response of a small structure in a live page: superposition of all of its modes, which is exact with proportional damping.

/** @import { Vector } from "./live_complex.js" */
/** @import { Matrix } from "./live_matrix.js" */
/** @import { LiveGrid } from "./types.d.ts" */

import { TURN_ANGLE } from "./live_grid.js";
import { LiveHarmonic } from "./live_harmonic.js";
import { general } from "./live_limits.js";
import { cholesky, dot, matrixOf, times } from "./live_matrix.js";
import { RunFailure } from "./live_run.js";
import { MOVES, vibrationModes } from "./live_structures.js";

/** Product of complex numbers. @param {[number, number]} a @param {[number, number]} b @returns {[number, number]} */
const multiplied = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];

/** Quotient of complex numbers. @param {[number, number]} a @param {[number, number]} b @returns {[number, number]} */
function divided([a, b], [c, d]) {
  const size = c * c + d * d;
  return [(a * c + b * d) / size, (b * c - a * d) / size];
}

/** Combination of columns with complex factors. @param {Matrix} columns @param {[number, number][]} factors @param {number} n @returns {Vector} */
const combined = (columns, factors, n) => /** @type {Vector} */ ([0, 1].map((part) => Float64Array.from({ length: n }, (_, i) => columns.reduce((sum, column, k) => sum + column[i] * factors[k][part], 0))));

/** Columns of a matrix that is stored by columns. @param {Float64Array} table @param {number} rows @param {number} count @returns {Matrix} */
const columnsIn = (table, rows, count) => Array.from({ length: count }, (_, k) => table.slice(rows * k, rows * (k + 1)));

/** Linear system of one design. */
class StructureSystem {
  /** @param {LiveStructureFrequency} run @param {Float64Array} p */
  constructor({ engine, data }, p) {
    const parts = engine.evaluate("system", p), { free_numbers: free = [], held_numbers: held = [], mix = [], measures = 0 } = data, inputs = mix.length;
    if (!parts || !parts.every((part) => part.every(Number.isFinite))) throw new RunFailure(MOVES, undefined, undefined, "singular position");
    const [stiffness, mass, forces, supports, [alpha, beta], byMotion, byForce, direct] = parts, n = Math.round(Math.sqrt(stiffness.length));
    this.data = data;
    this.p = p;
    this.n = n;
    this.free = free;
    this.stiffness = matrixOf(stiffness, n);
    this.mass = matrixOf(mass, n);
    this.alpha = alpha;
    this.beta = beta;
    const inner = (/** @type {Matrix} */ matrix) => free.map((i) => Float64Array.from(free, (j) => matrix[i][j])), factor = cholesky(inner(this.stiffness));
    if (!factor) throw new RunFailure(MOVES, undefined, undefined, "singular position");
    const { values, bases, order } = vibrationModes(factor, inner(this.mass)), chosen = order;
    /** Reciprocal squares of the angular frequencies, and modes of all displacements. */
    this.values = chosen.map((k) => values[k]);
    this.modes = chosen.map((k) => { const mode = new Float64Array(n); free.forEach((i, j) => { mode[i] = bases[k][j]; }); return mode; });
    this.byMotion = columnsIn(byMotion, n, measures);
    this.byForce = columnsIn(byForce, n, measures);
    const sides = columnsIn(forces, n, inputs), moved = columnsIn(supports, held.length, inputs), straight = columnsIn(direct, inputs, measures);
    this.columns = (mix[0] ?? []).map((_, c) => {
      const factors = mix.map((row) => row[c]), force = combined(sides, factors, n), place = combined(moved, factors, held.length);
      const motion = /** @type {Vector} */ (place.map((part) => { const whole = new Float64Array(n); held.forEach((i, k) => { whole[i] = part[k]; }); return whole; }));
      const projected = (/** @type {Vector} */ vector) => this.modes.map((mode) => /** @type {[number, number]} */ ([dot(mode, vector[0]), dot(mode, vector[1])]));
      const [elastic, inertial] = [this.stiffness, this.mass].map((matrix) => /** @type {Vector} */ (motion.map((part) => times(matrix, part))));
      const own = straight.map((row) => /** @type {[number, number]} */ ([0, 1].map((part) => factors.reduce((sum, pair, k) => sum + row[k] * pair[part], 0))));
      return { factors, motion, force: projected(force), elastic: projected(elastic), inertial: projected(inertial), direct: own };
    });
    this.poles = this.lowestPoles();
  }

  /** Eigenvalues of the modes that the default frequencies resolve [1/s]. @returns {[number, number][]} */
  lowestPoles() {
    const { alpha, beta, data } = this, { modes = 10, above = 1, span } = /** @type {LiveGrid} */ (data.grid), omegas = this.values.filter((value) => value > 0).map((value) => 1 / Math.sqrt(value));
    const end = span?.[1] ?? (Math.max(...omegas.slice(0, modes)) * above) / TURN_ANGLE;
    let count = modes;
    while (count < omegas.length && !(omegas[count - 1] > TURN_ANGLE * end)) count *= 2;
    return omegas.slice(0, count).map((omega) => {
      const ratio = Math.min(1, (alpha / omega + beta * omega + (data.loss ?? 0)) / 2);
      return [-omega * ratio, omega * Math.sqrt(1 - ratio * ratio)];
    });
  }

  /** Span of the default frequencies [Hz]. @returns {[number, number]} */
  get span() {
    const { modes = 10, above = 1, margin, span } = /** @type {LiveGrid} */ (this.data.grid), sizes = this.poles.slice(0, modes).map(([re, im]) => Math.hypot(re, im) / TURN_ANGLE);
    return span ?? [Math.min(...sizes) / margin, Math.max(...sizes) * above];
  }

  /** Factors of stiffness and mass at an angular frequency, and their derivatives. @param {number} omega @returns {[number, number][]} */
  factors(omega) {
    const { alpha, beta, data: { loss = 0 } } = this;
    return [[1, loss + omega * beta], [-omega * omega, omega * alpha], [0, beta], [-2 * omega, alpha]];
  }

  /** Harmonic motions at a frequency [Hz], and the amplitudes of the measures. @param {number} f */
  at(f) {
    const omega = TURN_ANGLE * f, [kappa, mu] = this.factors(omega), { resonant } = /** @type {LiveGrid} */ (this.data.grid);
    const shares = this.columns.map(({ force, elastic, inertial }) => this.values.map((value, k) => {
      const below = /** @type {[number, number]} */ ([kappa[0] + mu[0] * value, kappa[1] + mu[1] * value]), size = Math.hypot(...kappa) + Math.hypot(...mu) * value;
      const [a, b] = multiplied(kappa, elastic[k]), [c, d] = multiplied(mu, inertial[k]), above = /** @type {[number, number]} */ ([force[k][0] - a - c, force[k][1] - b - d]);
      if (Math.hypot(...below) < resonant * size && Math.hypot(...above)) throw new RunFailure(`no finite response at ${general(f, 9)} Hz: an undamped mode resonates; add damping`, undefined, undefined, "singular position");
      return divided(above, below);
    }));
    const motions = shares.map((share, c) => this.superposed(share, this.columns[c].motion));
    return { f, omega, shares, motions, h: this.measured(motions.map((motion) => ({ motion, force: this.loaded(motion, kappa, mu) })), true) };
  }

  /** Displacements from shares of modes. @param {[number, number][]} shares @param {Vector | null} start @returns {Vector} */
  superposed(shares, start) {
    const motion = /** @type {Vector} */ ([0, 1].map((part) => (start ? start[part].slice() : new Float64Array(this.n))));
    this.modes.forEach((mode, k) => { for (const i of this.free) { motion[0][i] += shares[k][0] * mode[i]; motion[1][i] += shares[k][1] * mode[i]; } });
    return motion;
  }

  /** Whether a measure depends on forces. */
  get needsForces() { return this.byForce.some((row) => row.some(Boolean)); }

  /** Forces `(κ K + μ M) u`, where a measure depends on them. @param {Vector} motion @param {[number, number]} kappa @param {[number, number]} mu @returns {Vector | null} */
  loaded(motion, kappa, mu) {
    if (!this.needsForces) return null;
    const [a, b] = motion.map((part) => times(this.stiffness, part)), [c, d] = motion.map((part) => times(this.mass, part));
    return [a.map((_, i) => kappa[0] * a[i] - kappa[1] * b[i] + mu[0] * c[i] - mu[1] * d[i]), a.map((_, i) => kappa[0] * b[i] + kappa[1] * a[i] + mu[0] * d[i] + mu[1] * c[i])];
  }

  /** Amplitudes of the measures. @param {{ motion: Vector, force: Vector | null }[]} states one for each input @param {boolean} whole whether the inputs act directly */
  measured(states, whole) {
    const count = this.byMotion.length, h = new Float64Array(2 * states.length * Math.max(1, count));
    for (let m = 0; m < count; m++) states.forEach(({ motion, force }, c) => {
      for (const part of [0, 1]) h[2 * (m * states.length + c) + part] = dot(this.byMotion[m], motion[part]) + (force ? dot(this.byForce[m], force[part]) : 0) + (whole ? this.columns[c].direct[m][part] : 0);
    });
    return h;
  }

  /** Derivatives of the amplitudes by the frequency [1/Hz]. @param {ReturnType<StructureSystem["at"]>} sample */
  rate({ omega, shares, motions }) {
    const [kappa, mu, kappaRate, muRate] = this.factors(omega);
    const states = shares.map((share, c) => {
      const { elastic, inertial } = this.columns[c], changes = share.map((amplitude, k) => {
        const value = this.values[k], [a, b] = multiplied(kappaRate, elastic[k]), [d, e] = multiplied(muRate, inertial[k]), [u, v] = multiplied(amplitude, [kappaRate[0] + muRate[0] * value, kappaRate[1] + muRate[1] * value]);
        return divided([-a - d - u, -b - e - v], [kappa[0] + mu[0] * value, kappa[1] + mu[1] * value]);
      });
      const motion = this.superposed(changes, null), force = this.loaded(motion, kappa, mu), more = this.loaded(motions[c], kappaRate, muRate);
      return { motion, force: force && more && /** @type {Vector} */ (force.map((part, i) => part.map((value, k) => value + more[i][k]))) };
    });
    return this.measured(states, false).map((value) => TURN_ANGLE * value);
  }
}

/** Frequency responses of one structure, one after the other. */
export class LiveStructureFrequency extends LiveHarmonic {
  /** @override @param {Float64Array} p */
  system(p) { return new StructureSystem(this, p); }

  /** Displacements at the phase of their largest amplitude. @override @param {StructureSystem} system @param {ReturnType<StructureSystem["at"]>} sample */
  picture({ p }, { omega, motions: [[re, im]] }) {
    if (!this.engine.functions.has("pictures")) return [];
    const half = -0.5 * Math.atan2(2 * dot(re, im), dot(re, re) - dot(im, im)), [c, s] = [Math.cos(half), Math.sin(half)];
    return this.engine.evaluate("pictures", [1], [omega * omega], re.map((value, i) => c * value - s * im[i]), p)?.[0] ?? [];
  }

  /** Weights of the parameters from those of the amplitudes at frequencies: adjoint solutions.
   * @override @param {StructureSystem} system @param {{ f: number, bars: Float64Array }[]} samples */
  parameterWeights(system, samples) {
    const { engine } = this, { p, n, values, modes } = system, total = new Float64Array(p.length), measures = system.byMotion.length;
    for (const { f, bars } of samples) {
      const { omega, shares } = system.at(f), [kappa, mu] = system.factors(omega);
      shares.forEach((share, c) => {
        const seeds = Array.from({ length: measures }, (_, m) => { const k = 2 * (m * shares.length + c); return [bars[k], -bars[k + 1]]; });
        if (seeds.every(([a, b]) => !a && !b)) return;
        const side = /** @type {Vector} */ ([0, 1].map((part) => Float64Array.from({ length: n }, (_, i) => seeds.reduce((sum, seed, m) => sum + seed[part] * system.byMotion[m][i], 0))));
        const onForces = /** @type {Vector} */ ([0, 1].map((part) => Float64Array.from({ length: n }, (_, i) => seeds.reduce((sum, seed, m) => sum + seed[part] * system.byForce[m][i], 0)))), more = system.loaded(onForces, kappa, mu);
        if (more) side.forEach((part, k) => part.forEach((_, i) => { part[i] += more[k][i]; }));
        const adjoint = system.superposed(modes.map((mode, k) => divided([dot(mode, side[0]), dot(mode, side[1])], [kappa[0] + mu[0] * values[k], kappa[1] + mu[1] * values[k]])), null);
        const motion = system.superposed(share, null), { factors } = system.columns[c], pair = (/** @type {number[][]} */ rows) => [0, 1].map((part) => rows.map((row) => row[part]));
        const [slope] = engine.evaluate("pull", p, [omega], ...pair(factors), ...motion, ...adjoint, ...pair(seeds)) ?? [total.map(() => NaN)];
        for (const i of total.keys()) total[i] += slope[i];
      });
    }
    return total;
  }
}
