// Paths of a live page: arrows show how a point moves with each parameter, and a dragged point changes them.

/** @import { LiveData, LiveSlopes, TracedPoint } from "./types.d.ts" */
/** @import { Paper, Pixel } from "./scene_types.d.ts" */
/** @import { Design } from "./live_design.js" */
/** @import { Motion } from "./motion.js" */
/** @import { Player } from "./player.js" */
/** @import { Scene } from "./scene.js" */

import { arrow, label } from "./arrows.js";
import { circle, stroke } from "./canvas.js";
import { toggleButton } from "./dom.js";
import { clamp } from "./numbers.js";
import { Signal, Theme } from "./theme.js";

/** Distance from a path at which the pointer takes hold of it, and length of the longest arrow [px]. */
const REACH = 9, LONGEST = 64;
/** Damping of a step, relative to the largest slope; longest step of a parameter, relative to its range. */
const DAMPING = 1e-3, STRIDE = 0.2;
/** Distance from the target after a successful step, relative to that before; smallest share of a step that is tried. */
const NEARER = 0.999, SMALLEST = 1 / 64;

/** Point of a path at an instant, with the numbers of the rows of its coordinates.
 * @typedef {{ point: TracedPoint, instant: number, rows: number[] }} Hold */
/** Design of a drag, with the miss of the target and its derivatives.
 * @typedef {{ values: number[], miss: number[], jacobian: ArrayLike<number>[] }} Approach */

/** Changes of parameters that bring a point nearer to a target, in the metric of their ranges (Levenberg and Marquardt).
 * @param {ArrayLike<number>[]} jacobian rows by coordinate @param {number[]} miss @param {number[]} ranges zero for parameters that are kept */
export function stepToward(jacobian, miss, ranges) {
  const scaled = jacobian.map((row) => ranges.map((range, k) => row[k] * range)), n = miss.length;
  const matrix = scaled.map((a) => scaled.map((b) => a.reduce((sum, v, k) => sum + v * b[k], 0))), most = Math.max(...matrix.map((row, i) => row[i]), 0);
  if (!(most > 0)) return ranges.map(() => 0);
  for (let i = 0; i < n; i++) matrix[i][i] += DAMPING * most;
  const right = [...miss];
  for (let i = 0; i < n; i++) for (let j = i + 1; j < n; j++) {  // positive definite, so without pivots
    const factor = matrix[j][i] / matrix[i][i];
    for (let k = i; k < n; k++) matrix[j][k] -= factor * matrix[i][k];
    right[j] -= factor * right[i];
  }
  for (let i = n - 1; i >= 0; i--) right[i] = (right[i] - matrix[i].reduce((sum, v, k) => (k > i ? sum + v * right[k] : sum), 0)) / matrix[i][i];
  const change = ranges.map((range, k) => range * scaled.reduce((sum, row, i) => sum + row[k] * right[i], 0));
  const longest = Math.max(...change.map((v, k) => (ranges[k] ? Math.abs(v) / ranges[k] : 0)));
  return longest > STRIDE ? change.map((v) => (v * STRIDE) / longest) : change;
}

export class PathDrag {
  /** @param {{ motion: Motion, scene: Scene, player: Player }} page @param {Design} design @param {LiveData} live */
  constructor({ motion, scene, player }, design, live) {
    this.motion = motion;
    this.scene = scene;
    this.player = player;
    this.design = design;
    const rows = new Map(live.columns.filter(([path]) => path[0] === "series").map(([path, row]) => [motion.series[Number(path[1])]?.name, row]));
    /** Rows of the coordinates of a point. @type {(point: TracedPoint) => number[] | null} */
    this.rowsOf = (point) => {
      const found = motion.axes.map((axis) => point.names.map((name) => rows.get(`${name}.${axis}`)).find((row) => row !== undefined));
      return found.every((row) => row !== undefined) ? /** @type {number[]} */ (found) : null;
    };
    /** Point whose derivatives are shown or followed. @type {Hold | null} */
    this.hold = null;
    /** Derivatives of its coordinates by the parameters. @type {ArrayLike<number>[] | null} */
    this.jacobian = null;
    /** Place to which the point is dragged. @type {number[] | null} */
    this.target = null;
    /** Design nearest to the target, and share of the next step from it. @type {Approach | null} */
    this.nearest = null;
    this.share = 1;
    /** Values of the last design that runs. @type {number[] | null} */
    this.valid = null;
    this.arrows = false;
    /** Emitted where derivatives of another point or instant are required. @type {Signal} */
    this.onHold = new Signal();
    scene.overlays.push((paper) => this.draw(paper));
    const spots = motion.spots.filter((point) => this.rowsOf(point));
    if (!spots.length) return;
    scene.canvas.closest(".stage")?.querySelector("#toolbar .chips")?.append(toggleButton("Derivatives", false, (on) => { this.arrows = on; this.follow(); }, { id: "derivatives", title: "Arrows: a point moves so if a parameter grows" }));
    player.onTime.on(() => { if (!player.playing && !this.target) this.follow(); });
    player.onState.on(() => { if (!this.target) this.follow(); });
    if (motion.dimension === 2) this.bindPointer();
  }

  /** Request of derivatives for the worker. */
  get request() { return this.hold && { instant: this.hold.instant, rows: this.hold.rows }; }

  /** Show the derivatives of the first traced point at the present time. */
  follow() {
    const { motion, player } = this, point = motion.spots.find((spot) => spot.traced && this.rowsOf(spot)), { i, f } = motion.cursor;
    const rows = point && this.rowsOf(point), before = this.hold;
    this.hold = this.arrows && !player.playing && point && rows ? { point, instant: i + (f >= 0.5 ? 1 : 0), rows } : null;
    if (this.hold?.instant !== before?.instant || this.hold?.point.name !== before?.point.name) this.jacobian = null;
    if (this.hold && !this.jacobian) this.onHold.emit();
    this.scene.invalidate();
  }

  /** Position of the held point. */
  get place() {
    const { hold, motion } = this, point = hold && motion.spots.find(({ name }) => name === hold.point.name);
    return point ? motion.at(point.body, point.point, { i: hold.instant, f: 0 }) : null;
  }

  /** Nearest instant of a traced path to a pixel, within reach. @param {Pixel} pixel @returns {Hold | null} */
  under([px, py]) {
    const { motion, scene } = this;
    /** @type {Hold | null} */
    let nearest = null;
    let least = REACH;
    for (const point of motion.spots) {
      const rows = point.traced ? this.rowsOf(point) : null;
      for (let k = 0; rows && k < motion.n; k++) {
        const place = motion.at(point.body, point.point, { i: k, f: 0 }), pixel = place && scene.screen(place);
        const distance = pixel ? Math.hypot(pixel[0] - px, pixel[1] - py) : Infinity;
        if (distance < least) { least = distance; nearest = { point, instant: k, rows }; }
      }
    }
    return nearest;
  }

  /** A path is dragged instead of the view. */
  bindPointer() {
    const { scene, scene: { canvas }, player } = this, view = /** @type {any} */ (scene.view);
    const pixelOf = (/** @type {PointerEvent} */ { clientX, clientY }) => { const { left, top } = canvas.getBoundingClientRect(); return /** @type {Pixel} */ ([clientX - left, clientY - top]); };
    let dragging = false;
    canvas.addEventListener("pointerdown", (event) => {
      const hold = event.button ? null : this.under(pixelOf(event));
      if (!hold) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      dragging = true;
      player.pause();
      scene.view.fitted = false;  // the drawing stays below the pointer
      this.design.begin();
      Object.assign(this, { hold, jacobian: null, target: view.world(pixelOf(event)), nearest: null, share: 1 });
      player.seek(this.motion.time[hold.instant]);
      this.onHold.emit();
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (dragging) {
        event.stopImmediatePropagation();
        Object.assign(this, { target: view.world(pixelOf(event)), nearest: null, share: 1 });
        this.advance();
      } else if (!event.buttons) canvas.classList.toggle("on-path", this.under(pixelOf(event)) !== null);
    }, { capture: true });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => {
      if (!dragging) return;
      dragging = false;
      this.target = null;
      this.follow();
    });
  }

  /** Derivatives have arrived. @param {LiveSlopes} answer */
  receive({ jacobian }) {
    this.valid = this.design.values;
    if (!jacobian || !this.hold) return;
    this.jacobian = jacobian;
    this.scene.invalidate();
    this.advance();
  }

  /** The design of a step cannot be assembled: return to the one before. */
  retreat() { if (this.target && this.valid) this.design.replace(this.valid, "drag"); }

  /** One step of the parameters toward the target; half of the last one where that did not come nearer. */
  advance() {
    const { design, jacobian, target, place, hold } = this;
    if (!jacobian || !target || !place || !hold) return;
    const present = { values: design.values, miss: target.map((v, axis) => v - place[axis]), jacobian };
    if (Math.hypot(...present.miss) < 0.3 / this.scene.view.scaleAt(place)) return;
    if (this.nearest && !(Math.hypot(...present.miss) < NEARER * Math.hypot(...this.nearest.miss))) this.share /= 2;
    else Object.assign(this, { nearest: present, share: Math.min(1, 2 * this.share) });
    const nearest = this.nearest ?? present, next = this.share < SMALLEST ? nearest.values : this.stepFrom(nearest);
    if (next.every((value, k) => value === design.values[k])) return;  // at bounds, or as near as possible
    this.jacobian = null;
    design.replace(next, "drag");
  }

  /** Design of one step, in which parameters that reach a bound stay there. @param {Approach} from */
  stepFrom({ values, miss, jacobian }) {
    const { design, share } = this, ranges = design.parameters.map((_, k) => { const [low, high] = design.range(k); return design.locked[k] ? 0 : high - low; });
    let next = values;
    for (let pass = 0; pass < 3; pass++) {
      const step = stepToward(jacobian, miss, ranges).map((v) => share * v);
      next = values.map((value, k) => design.bounded(k, value + step[k]));
      const stopped = next.map((value, k) => ranges[k] !== 0 && Math.abs(value - values[k] - step[k]) > 1e-12 * ranges[k]);
      if (!stopped.includes(true)) break;
      stopped.forEach((stop, k) => { if (stop) ranges[k] = 0; });
    }
    return next;
  }

  /** Arrows at the held point: its displacement if a parameter grows, to one scale. @param {Paper} paper */
  draw({ ctx }) {
    const { hold, jacobian, place, design, scene, target } = this, at = hold && place && scene.screen(place);
    if (!at) return;
    if (target) { circle(ctx, at, 7); stroke(ctx, Theme.accent, 2); }
    if (!this.arrows || !jacobian) return;
    const ways = design.parameters.map((_, k) => {
      const [low, high] = design.range(k), [u, v] = scene.view.direction(jacobian.map((row) => row[k] * (high - low)));
      return /** @type {Pixel} */ ([u, v]);
    });
    const most = Math.max(...ways.map(([u, v], k) => (design.parameters[k].drawn ? 0 : Math.hypot(u, v))));
    ctx.font = `12px ${Theme.font}`;
    ways.forEach((way, k) => {
      const length = (LONGEST * Math.hypot(...way)) / most;
      if (!(length > 4) || design.locked[k]) return;
      const [u, v] = way.map((part) => (part * LONGEST) / most), out = clamp((length + 14) / length, 1, 4);
      arrow(ctx, at, [u, v], Theme.colour(k + 1), Theme.surface);
      label(ctx, design.parameters[k].name, [at[0] + out * u, at[1] + out * v], Theme.colour(k + 1), Theme.surface);
    });
  }
}
