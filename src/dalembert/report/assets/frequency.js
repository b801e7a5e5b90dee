// Charts over the frequency: Bode plot, Nyquist plot and spectral densities, with a cursor at the drawn state.

/** @import { ResponseCurve, ResponseLine, ResponseView } from "./types.d.ts" */
/** @import { Box, Map1 } from "./charts.js" */
/** @import { Motion } from "./motion.js" */

import { Chart, Scale, chartKinds, hint, pathOf, stateCharts } from "./charts.js";
import { el, shape } from "./dom.js";
import { TAU, clamp, isNum, number, tidy } from "./numbers.js";
import { raised } from "./units.js";

/** Degrees of a right angle, between the lines of phases. */
const RIGHT = 90;

/** Values of a line, which has logarithms, so that small values keep their digits. @param {ResponseLine} line @returns {ResponseCurve} */
function curveOf({ name, unit, level, phase }) {
  const y = Array.from(level, (value) => (isNum(value) ? 10 ** value : 0));
  if (!phase) return { name, unit, re: [], im: [], y };
  const angles = Array.from(phase);
  return { name, unit, re: y.map((value, k) => value * Math.cos(angles[k])), im: y.map((value, k) => value * Math.sin(angles[k])) };
}

/** @param {ResponseCurve} line */
const amplitudes = ({ re, im, y }) => y ?? re.map((value, k) => Math.hypot(value, im[k]));

/** Continuous phase [°]. @param {ResponseCurve} line */
function phases({ re, im }) {
  let turns = 0, before = NaN;
  return re.map((value, k) => {
    const angle = Math.atan2(im[k], value);
    if (angle - before > TAU / 2) turns--;
    else if (before - angle > TAU / 2) turns++;
    before = angle;
    return ((angle + turns * TAU) * 360) / TAU;
  });
}

/** Linear axis of phases with marks at right angles. */
class PhaseScale extends Scale {
  /** @override @param {number} count */
  marks(count) {
    const step = RIGHT * Math.max(1, Math.ceil((this.hi - this.lo) / RIGHT / Math.max(count, 2)));
    const first = Math.ceil(this.lo / step), last = Math.floor(this.hi / step);
    return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => (first + k) * step).map((value) => ({ value, text: String(value).replace("-", "−") }));
  }
}

/** Numbers of a view without logarithms. @param {ResponseView} view */
function valuesOf(view) {
  const x = Array.from(view.x, (value) => (view.log ? 10 ** value : value));
  return { ...view, x, states: Array.from(view.states), lines: view.lines.map(curveOf) };
}

/** A chart over the frequency; a click or a drag chooses the state of the drawing. */
class ResponseChart extends Chart {
  /** @param {ResponseView} view @param {number} height */
  constructor(view, height) {
    super(view, height);
    this.source = view;
    this.view = valuesOf(view);
    /** Curves of another design. @type {{ x: number[], lines: ResponseCurve[] } | null} */
    this.other = null;
    /** @type {Motion | null} */
    this.motion = null;
    this.marks = shape("g", { class: "cursor" });
    this.now = el("p", { class: "caption note readout" });
    this.node.append(this.now);
    this.setLegend(view.lines.map(({ name }, k) => ({ name, look: `s${k % 7}` })));
    stateCharts.push(this);
  }

  /** Draw the view after a change. */
  renew() {
    const { other } = this.source;
    this.view = valuesOf(this.source);
    this.other = other ? valuesOf({ ...this.source, ...other }) : null;
    this.redraw();
  }

  /** Follow the state of the drawing. @param {Motion} motion */
  bind(motion) {
    if (motion.states.kind !== "frequency") return;
    this.motion = motion;
    this.svg.style.cursor = "crosshair";
    motion.onState.on(() => this.mark());
    for (const kind of ["pointerdown", "pointermove"]) {
      this.svg.addEventListener(kind, (event) => {
        const { buttons, offsetX, offsetY } = /** @type {PointerEvent} */ (event);
        if (buttons & 1) motion.choose(this.nearest(offsetX, offsetY));
      });
    }
    motion.choose(this.view.first);
  }

  /** Number of the frequency of the drawn state. */
  get chosen() { return this.motion ? this.view.states[this.motion.chosen] ?? -1 : -1; }

  /** State at a place of the chart. @param {number} x @param {number} y */
  nearest(x, y) { return 0; }

  /** Mark the drawn state. */
  mark() {
    const { view, chosen } = this;
    if (chosen < 0) return;
    const texts = view.lines.map((line) => `${line.name}: ${tidy(amplitudes(line)[chosen], 4)} ${raised(line.unit.replace(/^1 per /, "per "))}${line.y ? "" : ` ∠ ${number((Math.atan2(line.im[chosen], line.re[chosen]) * 360) / TAU, 3)}°`}`);
    this.now.textContent = `${number(view.x[chosen], 5)} Hz — ${texts.join("; ")}`;
  }
}

/** Amplitude over phase, or densities alone. */
class BodeChart extends ResponseChart {
  /** @param {ResponseView} view */
  constructor(view) {
    super(view, view.lines.every(({ phase }) => !phase) ? 250 : 360);
    this.logarithmic = view.log;
    /** @type {{ left: number, right: number, x: Scale } | null} */
    this.span = null;
    /** @type {{ py: Map1, values: number[][], box: Box }[]} */
    this.panes = [];
    /** @type {Map1 | null} */
    this.px = null;
  }

  /** @override @param {number} w @param {number} h */
  draw(w, h) {
    const { view, other } = this, all = view.lines.map(amplitudes), phased = view.lines.filter(({ y }) => !y), others = other?.lines ?? [], before = others.map(amplitudes);
    const x = new Scale([...view.x, ...other?.x ?? []], this.logarithmic, 0.01), top = new Scale([...all, ...before].flat(), true, 0.05);
    const whole = this.box(w, h, top), left = Math.max(58, whole.left), middle = phased.length ? Math.round(h * 0.62) : whole.bottom;
    const upper = { ...whole, left, bottom: phased.length ? middle - 20 : whole.bottom }, lower = { ...whole, left, top: middle + 8 };
    const first = this.frame(upper, x, top, [phased.length ? "" : "frequency [Hz]", raised(view.y)]);
    if (other) this.curves(upper, other.x, before, first.px, first.py, "dashed");
    this.curves(upper, view.x, all, first.px, first.py);
    this.span = { left, right: whole.right, x };
    this.panes = [{ py: first.py, values: all, box: upper }];
    if (phased.length) {
      const angles = phased.map(phases), turned = others.filter(({ y }) => !y).map(phases), scale = new PhaseScale([...angles.flat(), ...turned.flat(), 0], false, 0.05);
      const second = this.frame(lower, x, scale, ["frequency [Hz]", "phase [°]"], 4);
      if (other) this.curves(lower, other.x, turned, second.px, second.py, "dashed");
      this.curves(lower, view.x, angles, second.px, second.py);
      this.panes.push({ py: second.py, values: angles, box: lower });
    }
    this.px = first.px;
    this.svg.append(this.marks);
    this.mark();
  }

  /** @param {Box} box @param {number[]} x @param {number[][]} rows @param {Map1} px @param {Map1} py @param {string} [style] */
  curves(box, x, rows, px, py, style = "") {
    const wide = box.right - box.left, high = box.bottom - box.top;
    const inner = shape("svg", { class: "inner", x: box.left, y: box.top, width: wide, height: high, viewBox: `${box.left} ${box.top} ${wide} ${high}` });
    rows.forEach((values, k) => inner.append(shape("path", { d: pathOf(x, values, px, py), class: `curve ${style} s${k % 7}` }, hint(this.view.lines[k].name))));
    this.svg.append(inner);
  }

  /** @override @param {number} x @param {number} _ */
  nearest(x, _) {
    if (!this.span) return 0;
    const { left, right, x: scale } = this.span, value = scale.value(clamp((x - left) / (right - left), 0, 1));
    const distance = (/** @type {number} */ f) => Math.abs(scale.along(f) - scale.along(value));
    const { states } = this.view;
    return states.reduce((best, place, k) => (distance(this.view.x[place]) < distance(this.view.x[states[best]]) ? k : best), 0);
  }

  /** @override */
  mark() {
    super.mark();
    const { chosen, px } = this;
    if (chosen < 0 || !px) return;
    const x = px(this.view.x[chosen]);
    this.marks.replaceChildren(...this.panes.flatMap(({ py, values, box }) => [
      shape("line", { x1: x, x2: x, y1: box.top, y2: box.bottom, class: "level" }),
      ...values.map((row, k) => shape("circle", { cx: x, cy: py(row[chosen]), r: 4, class: `dot s${k % 7}` })),
    ]));
  }
}

/** Complex amplitudes in the plane. */
class NyquistChart extends ResponseChart {
  /** @param {ResponseView} view */
  constructor(view) {
    super(view, 320);
    /** @type {Map1 | null} */
    this.px = null;
    /** @type {Map1 | null} */
    this.py = null;
  }

  /** @override @param {number} w @param {number} h */
  draw(w, h) {
    const { lines } = this.view, others = this.other?.lines ?? [], all = [...lines, ...others], x = new Scale([0, ...all.flatMap(({ re }) => re)]), y = new Scale([0, ...all.flatMap(({ im }) => im)]), box = this.box(w, h, y);
    const unit = Math.max((x.hi - x.lo) / (box.right - box.left), (y.hi - y.lo) / (box.bottom - box.top));
    for (const [scale, size] of /** @type {[Scale, number][]} */ ([[x, box.right - box.left], [y, box.bottom - box.top]])) {
      const middle = (scale.lo + scale.hi) / 2;
      [scale.lo, scale.hi] = [middle - (unit * size) / 2, middle + (unit * size) / 2];
    }
    const { px, py } = this.frame(box, x, y, ["real part", "imaginary part"]);
    this.svg.append(shape("line", { x1: px(0), x2: px(0), y1: box.top, y2: box.bottom, class: "zero" }), shape("line", { x1: box.left, x2: box.right, y1: py(0), y2: py(0), class: "zero" }));
    others.forEach(({ name, re, im }, k) => this.svg.append(shape("path", { d: pathOf(re, im, px, py), class: `curve dashed s${k % 7}` }, hint(name))));
    lines.forEach(({ name, re, im }, k) => this.svg.append(shape("path", { d: pathOf(re, im, px, py), class: `curve s${k % 7}` }, hint(name))));
    [this.px, this.py] = [px, py];
    this.svg.append(this.marks);
    this.mark();
  }

  /** @override @param {number} x @param {number} y */
  nearest(x, y) {
    const { px, py, view: { lines, states } } = this;
    if (!px || !py) return 0;
    const distance = (/** @type {number} */ k) => Math.min(...lines.map(({ re, im }) => Math.hypot(px(re[states[k]]) - x, py(im[states[k]]) - y)));
    return states.reduce((best, _, k) => (distance(k) < distance(best) ? k : best), 0);
  }

  /** @override */
  mark() {
    super.mark();
    const { chosen, px, py } = this;
    if (chosen < 0 || !px || !py) return;
    this.marks.replaceChildren(...this.view.lines.map(({ re, im }, k) => shape("circle", { cx: px(re[chosen]), cy: py(im[chosen]), r: 5, class: `dot s${k % 7} design chosen` })));
  }
}

chartKinds.bode = (view) => new BodeChart(view).node;
chartKinds.nyquist = (view) => new NyquistChart(view).node;
