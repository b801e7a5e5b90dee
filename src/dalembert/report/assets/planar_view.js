// View of a planar scene: position and scale, moved by a pointer.

/** @import { Point } from "./types.d.ts" */
/** @import { Pixel } from "./scene_types.d.ts" */

import { clamp, extent } from "./numbers.js";

/** Upper limit of the part of the canvas that is left free around the drawing, for small canvases. */
const MARGINS = 0.6;

export class PlanarView {
  hint = "Wheel zooms, drag pans.";
  /** @type {Record<string, () => void>} */
  keys = {};

  /** @param {HTMLCanvasElement} canvas @param {() => void} onChange */
  constructor(canvas, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
    /** Centre of the view, and pixels per metre. */
    this.x = 0;
    this.y = 0;
    this.s = 1;
    /** Scale of the fitted view. */
    this.home = 1;
    this.fitted = true;
    this.bindPointer();
  }

  enclose() {}

  /** @param {Point[]} cloud @param {{ side: number, top: number, bottom: number, left: number }} margins [px] */
  fit(cloud, { side, top, bottom, left }) {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const [[x0, x1], [y0, y1]] = [0, 1].map((axis) => extent([cloud.map((p) => p[axis])]) ?? [0, 1]);
    const share = Math.min(1, (MARGINS * h) / (top + bottom || 1)), [over, under] = [top * share, bottom * share], room = Math.max((1 - MARGINS) * w, w - left - 2 * side);
    const least = 0.1 * Math.max(x1 - x0, y1 - y0) || 1, [width, height] = [Math.max(x1 - x0, least), Math.max(y1 - y0, least)];
    this.s = Math.max(1e-9, Math.min(room / width, (h - over - under) / height));
    this.x = (x0 + x1 - left / this.s) / 2;
    this.y = (y0 + y1 - (under - over) / this.s) / 2;
    this.home = this.s;
    this.fitted = true;
    this.onChange();
  }

  /** @param {number} factor @param {Pixel} at */
  zoom(factor, at = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2]) {
    const before = this.world(at);
    this.s = clamp(this.s * factor, this.home / 20, this.home * 200);
    const after = this.world(at);
    this.carry([before[0] - after[0], before[1] - after[1]]);
    this.fitted = false;
    this.onChange();
  }

  /** @param {number[]} shift [m] */
  carry([dx, dy]) {
    this.x += dx;
    this.y += dy;
  }

  /** @param {number} dx @param {number} dy [px] */
  pan(dx, dy) {
    this.carry([-dx / this.s, dy / this.s]);
    this.fitted = false;
    this.onChange();
  }

  /** @param {Point} place @returns {Pixel} */
  screen([x, y]) {
    return [this.canvas.clientWidth / 2 + (x - this.x) * this.s, this.canvas.clientHeight / 2 - (y - this.y) * this.s];
  }

  /** @param {Pixel} pixel @returns {[number, number]} */
  world([px, py]) {
    return [this.x + (px - this.canvas.clientWidth / 2) / this.s, this.y - (py - this.canvas.clientHeight / 2) / this.s];
  }

  /** @param {Float64Array} places */
  project(places) {
    const { clientWidth: w, clientHeight: h } = this.canvas, { x, y, s } = this;
    return places.map((v, k) => (k % 3 === 0 ? w / 2 + (v - x) * s : k % 3 === 1 ? h / 2 - (v - y) * s : 0));
  }

  scaleAt() { return this.s; }

  /** @param {number[]} vector @returns {[number, number, number]} */
  direction([x, y]) { return [x, -y, 0]; }

  /** Wheel and pinch zoom, drag pans, a double click fits. */
  bindPointer() {
    const { canvas } = this;
    /** @type {Map<number, Pixel>} */
    const down = new Map();
    const pixel = (/** @type {MouseEvent} */ e) => { const { left, top } = canvas.getBoundingClientRect(); return /** @type {Pixel} */ ([e.clientX - left, e.clientY - top]); };
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoom(Math.exp(-clamp(e.deltaY * (e.deltaMode ? 30 : 1), -300, 300) * 0.0016), pixel(e));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (e) => {
      down.set(e.pointerId, pixel(e));
      canvas.setPointerCapture(e.pointerId);
    });
    canvas.addEventListener("pointermove", (e) => {
      const now = pixel(e), before = down.get(e.pointerId);
      if (!before) return;
      const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
      if (other) {
        const apart = (/** @type {Pixel} */ p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        this.zoom(apart(now) / Math.max(1, apart(before)), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
      } else this.pan(now[0] - before[0], now[1] - before[1]);
      down.set(e.pointerId, now);
      canvas.classList.add("grabbing");
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => {
      down.delete(/** @type {PointerEvent} */ (e).pointerId);
      if (!down.size) canvas.classList.remove("grabbing");
    });
  }
}
