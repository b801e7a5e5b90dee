// Eigenvalues of the modes of a mechanism: a table, and the complex plane where a mode decays or grows.

/** @import { Motion } from "./motion.js" */
/** @import { Row } from "./sorted_table.js" */

import { Chart, Scale, hint } from "./charts.js";
import { el, shape } from "./dom.js";
import { number } from "./numbers.js";
import { panel } from "./panels.js";
import { SortedTable } from "./sorted_table.js";
import { UNDAMPED } from "./swing.js";
import { labelled, prefixed } from "./units.js";

/** An eigenvalue of a pair of conjugate ones [1/s], without round-off.
 * @typedef {{ re: number, im: number, size: number }} Eigenvalue */

/** Eigenvalues of the present design. @param {Motion} motion @returns {Eigenvalue[]} */
function eigenvalues(motion) {
  const [re, im] = ["eigenvalue_real", "eigenvalue_imag"].map((name) => Array.from(motion.seriesByName.get(name)?.values ?? []));
  const sizes = re.map((value, k) => Math.hypot(value, im[k])), largest = Math.max(0, ...sizes.filter(Number.isFinite));
  const clean = (/** @type {number} */ value) => (Math.abs(value) <= UNDAMPED * largest ? 0 : value);
  return re.map((value, k) => ({ re: clean(value), im: clean(im[k]), size: sizes[k] }));
}

/** Kind of the motion of a mode. @param {Eigenvalue} value */
function behaviour({ re, im }) {
  if (im) return re < 0 ? "decaying oscillation" : re > 0 ? "growing oscillation" : "oscillation";
  return re < 0 ? "decay" : re > 0 ? "divergence" : "free motion";
}

/** Eigenvalues in the complex plane; a click chooses a mode. */
class Spectrum extends Chart {
  /** @param {Motion} motion */
  constructor(motion) {
    super({ title: "Eigenvalues in the complex plane" }, 250);
    this.motion = motion;
  }

  /** @override @param {number} w @param {number} h */
  draw(w, h) {
    const { motion } = this, [along, up] = ["1/s", "rad/s"].map((unit) => prefixed(1, unit));
    const values = eigenvalues(motion).map(({ re, im }) => ({ re: re / along.factor, im: im / up.factor }));
    const x = new Scale([0, ...values.map(({ re }) => re)]), y = new Scale(values.flatMap(({ im }) => [im, -im, 0])), box = this.box(w, h, y);
    const { px, py } = this.frame(box, x, y, [labelled("Re s", along.unit), labelled("Im s", up.unit)]);
    const grows = shape("rect", { x: px(0), y: box.top, width: Math.max(0, box.right - px(0)), height: box.bottom - box.top, class: "band" }, hint("Growing motions"));
    grows.style.setProperty("--c", "color-mix(in srgb, var(--error) 50%, transparent)");
    this.svg.append(grows, shape("line", { x1: px(0), x2: px(0), y1: box.top, y2: box.bottom, class: "zero" }), shape("line", { x1: box.left, x2: box.right, y1: py(0), y2: py(0), class: "zero" }));
    const order = [...values.keys()].sort((a, b) => Number(a === motion.chosen) - Number(b === motion.chosen));  // the chosen one above the others
    for (const k of order) {
      const { re, im } = values[k];
      for (const part of im ? [im, -im] : [0]) {
        const look = `dot s0 design${k === motion.chosen ? " chosen" : ""}`, sign = part < 0 ? "−" : "+";
        this.svg.append(shape("circle", { cx: px(re), cy: py(part), r: 5, class: look, onclick: () => motion.choose(k) }, hint(`mode ${k + 1}: ${number(re, 4)} ${sign} ${number(Math.abs(part), 4)} i`)));
      }
    }
  }
}

/** Cards of the eigenvalues, which follow the chosen mode and the design. @param {Motion} motion */
export function spectrumCards(motion) {
  const columns = [{ name: "mode" }, { name: "frequency", unit: "Hz" }, { name: "ω", unit: "rad/s" }, { name: "ζ" }, { name: "τ", unit: "s" }, { name: "motion" }];
  const table = new SortedTable("Eigenvalues", columns, (name) => motion.choose(Number(name) - 1)), chart = new Spectrum(motion);
  const plane = panel("Complex plane", "complex-plane", chart.node, el("p", { class: "caption note" }, "Eigenvalues s of motions exp(s t): those on the left decay, those on the right grow."));
  const refresh = () => {
    const values = eigenvalues(motion);
    table.fill(values.map((value, k) => {
      const { re, im, size } = value, periodic = im !== 0;
      return /** @type {Row} */ ([String(k + 1), periodic ? size / (2 * Math.PI) : null, periodic ? size : null, periodic ? -re / size : null, re ? 1 / Math.abs(re) : null, behaviour(value)]);
    }));
    table.mark(String(motion.chosen + 1));
    plane.hidden = values.every(({ re }) => !re);
    chart.redraw();
  };
  motion.onState.on(refresh);
  refresh();
  const legend = el("p", { class: "caption note" }, "Angular frequency ω = |s|, damping ratio ζ = −Re s/|s|, time constant τ = 1/|Re s|. A click shows a mode.");
  return el("div", { class: "tables" }, panel("Eigenvalues", "eigenvalues", table.node, legend), plane);
}
