// Small motions of a mechanism in its modes: amplitudes, and columns at a phase of the oscillation.

/** @import { Cursor, Point } from "./types.d.ts" */
/** @import { BodyData, States } from "./scene_types.d.ts" */
/** @import { Motion } from "./motion.js" */

import { TAU, list, number } from "./numbers.js";
import { diagonal } from "./timeline.js";
import { prefixed } from "./units.js";

/** Largest movement of a point, relative to the mechanism, and largest rotation of a body [rad], at the automatic amplitude. */
const SHARE = 0.1, TURN = 0.3;
/** Threshold of movements of round-off, relative to the rotation times the size. */
const STILL = 1e-9;
/** Largest displacement of a coordinate by which amplitudes are measured. */
const PROBE = 1e-5;
/** Phases that show the real and the imaginary part of a mode. */
const QUARTERS = [0.25, 0];
/** Phases of an oscillation. */
const PHASES = [0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/** Threshold of round-off of damping ratios and of eigenvalues, relative to the largest. */
export const UNDAMPED = 1e-9;

/** Blocks of a column: the value at rest, the real and imaginary part of its change, and three numbers of second order,
 * which keep joints closed; see `symbolic/formulas/oscillation.py`. */
const BLOCKS = 6;

/** Oscillation in one of the modes. The share `f` of a cursor is the phase, of which a quarter shows the real part. */
export class Swing {
  /** Names of modes: frequency and damping ratio. @param {States | undefined} states */
  static names({ kind, numbers, values, damping, unit = "" } = { kind: "", names: [] }) {
    const largest = Math.max(0, ...Array.from(list(values), Number).filter(Number.isFinite));
    return Array.from(list(values), (value, k) => {
      const { factor, unit: shown } = prefixed(Number(value), unit), ratio = Number(damping?.[k]), name = `${kind} ${numbers?.[k]}`;
      if (kind === "frequency") return `${+(Number(value) / factor).toPrecision(5)} ${shown}`;
      if (Number(value) <= UNDAMPED * largest) return `${name}: free motion`;
      const text = Math.abs(ratio) > 1 - UNDAMPED ? (ratio < 0 ? ", diverges" : ", decays") : Math.abs(ratio) < UNDAMPED ? "" : `, ζ ${number(ratio, 3)}${ratio < 0 ? ", unstable" : ""}`;
      return `${name}: ${+(Number(value) / factor).toPrecision(5)} ${shown}${text}`;
    });
  }

  /** @param {Motion} motion */
  constructor(motion) {
    /** Factor of the automatic amplitude. */
    this.factor = 1;
    this.motion = motion;
    /** Amplitude of each mode. @type {number[]} */
    this.amplitudes = Array(motion.n).fill(0);
    /** Largest movement of a point in each mode, at the automatic amplitude [m]. @type {number[]} */
    this.movements = [...this.amplitudes];
    this.relative = true;
    motion.requested = [];  // points have no paths
  }

  /** Largest movement of the chosen mode [m]: automatic, and present. */
  get automatic() { return this.movements[this.motion.chosen] ?? 0; }
  get scale() { return this.factor * this.automatic; }

  /** Column without displacements. @param {Float64Array} column */
  still(column) { return column.map((value, k) => (k < column.length / BLOCKS ? value : 0)); }

  /** Value of a column at a phase of a mode. @param {Float64Array} column @param {Cursor} cursor */
  sample(column, { i, f }) {
    const n = column.length / BLOCKS, k = Math.min(i, n - 1), angle = TAU * f, amplitude = this.factor * this.amplitudes[i], s = amplitude * Math.sin(angle), c = amplitude * Math.cos(angle);
    return column[k] + s * (column[n + k] + s * column[3 * n + k] + 2 * c * column[4 * n + k]) + c * (column[2 * n + k] + c * column[5 * n + k]);
  }

  /** Phases of some modes. @param {number} limit @returns {Cursor[]} */
  frames(limit) {
    const modes = Array.from({ length: Math.min(this.motion.n, Math.ceil(limit / PHASES.length)) }, (_, i) => i);
    return modes.flatMap((i) => PHASES.map((f) => ({ i, f })));
  }

  /** Oscillate about the bodies at rest. @param {BodyData[]} bodies @param {Float64Array[]} columns of all poses */
  begin(bodies, columns) {
    const { motion } = this;
    motion.resting = bodies.map((body) => motion.readBody(body, (values) => this.still(motion.column(values))));
    this.measure(columns);
  }

  /** Continue the oscillation of another design. @param {Swing} before @param {Motion} motion */
  adopt(before, motion) { Object.assign(this, { motion, factor: before.factor }); }

  /** Determine the automatic amplitudes. @param {Float64Array[]} columns of all poses */
  measure(columns) {
    const { motion } = this, still = motion.cloud([{ i: 0, f: 0 }]), size = diagonal(motion.cloud());
    for (let k = 0; k < motion.n; k++) {
      const largest = columns.reduce((most, column) => Math.max(most, Math.hypot(column[motion.n + k], column[2 * motion.n + k])), 0);
      if (!(largest > 0)) continue;
      const probe = PROBE / largest, rest = motion.bodies.map((body) => motion.pose(body, { i: k, f: 0 }));
      this.amplitudes[k] = probe;
      let [moved, turned] = [0, 0];
      const [real, imag] = QUARTERS.map((f) => motion.cloud([{ i: k, f }]));
      still.forEach((place, j) => { moved = Math.max(moved, semiAxis(real[j], imag[j], place) / probe); });
      motion.bodies.forEach((body, j) => {
        const [first, second] = QUARTERS.map((f) => motion.pose(body, { i: k, f }));
        if (first && second && rest[j]) turned = Math.max(turned, Math.hypot(angleBetween(first, rest[j]), angleBetween(second, rest[j])) / probe);
      });
      this.amplitudes[k] = Math.min(moved > 0 ? (SHARE * size) / moved : Infinity, turned > 0 ? TURN / turned : Infinity);
      if (!Number.isFinite(this.amplitudes[k])) this.amplitudes[k] = 0;
      this.movements[k] = moved > STILL * turned * size ? this.amplitudes[k] * moved : 0;
    }
  }
}

/** Larger semi-axis of the ellipse on which a point moves about its place. @param {Point} p @param {Point} q places after a quarter of a period @param {Point} place */
function semiAxis(p, q, place) {
  let [a, b, c] = [0, 0, 0];
  place.forEach((v, k) => { const x = p[k] - v, y = q[k] - v; a += x * x; b += y * y; c += x * y; });
  return Math.sqrt((a + b) / 2 + Math.hypot((a - b) / 2, c));
}

/** Angle of the rotation between two planar or spatial poses. @param {any} pose @param {any} other */
function angleBetween({ a, q }, { a: b, q: r }) {
  return q ? 4 * Math.asin(Math.min(1, Math.hypot(q.x - r.x, q.y - r.y, q.z - r.z, q.w - r.w) / 2)) : Math.abs(a - b);
}
