// What is drawn over a spatial picture: grid of the working plane, places, lines, triads.

/** @import { Page } from "./pictures.js" */
/** @import { Pose } from "./space_poses.js" */
/** @import { WorkingPlane } from "./space_places.js" */
/** @import { Vec } from "./space_math.js" */

import { axisColour } from "./space_gizmo.js";
import { planeFrame } from "./space_shapes.js";
import { AXES, plus, times, turned } from "./space_math.js";

/** Lines of the grid on each side of the pointer. */
const LINES = 10;
/** Width of the buttons of the view at the right edge, which cover texts [px]. */
const TOOLS = 52;

export class Sketch {
  /** @param {CanvasRenderingContext2D} ctx @param {Page} page */
  constructor(ctx, { scene }) {
    this.ctx = ctx;
    this.view = scene.view;
    const style = getComputedStyle(document.documentElement);
    this.accent = style.getPropertyValue("--accent").trim();
    this.ink = style.getPropertyValue("--ink").trim();
    this.surface = style.getPropertyValue("--surface").trim();
    [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth, ctx.font] = [this.accent, this.accent, 2, "12px system-ui, sans-serif"];
  }

  /** @param {Vec[]} places */
  line(places) {
    const { ctx, view } = this;
    ctx.beginPath();
    for (const place of places) {
      const pixel = view.screen(place);
      if (pixel) ctx.lineTo(pixel[0], pixel[1]);
    }
    ctx.stroke();
  }

  /** @param {Vec} place @param {number} radius [px] @param {boolean} [filled] */
  mark(place, radius, filled = false) {
    const { ctx, view } = this, pixel = view.screen(place);
    if (!pixel) return;
    ctx.beginPath();
    ctx.arc(pixel[0], pixel[1], radius, 0, 2 * Math.PI);
    if (filled) ctx.fill(); else ctx.stroke();
  }

  /** Text beside a place. @param {Vec} place @param {string} text */
  text(place, text) {
    const { ctx, view } = this, pixel = view.screen(place);
    if (!pixel) return;
    ctx.save();
    [ctx.strokeStyle, ctx.lineWidth, ctx.lineJoin] = [this.surface, 4, "round"];
    const { width } = ctx.measureText(text), free = view.canvas.clientWidth - TOOLS - width;
    const at = /** @type {const} */ ([pixel[0] + 14 < free ? pixel[0] + 14 : Math.max(4, Math.min(free, pixel[0] - 14 - width)), pixel[1] - 12]);
    ctx.strokeText(text, ...at);
    ctx.fillText(text, ...at);
    ctx.restore();
  }

  /** Grid of the working plane about a place; it fades away from it. @param {WorkingPlane} plane @param {Vec} place @param {number} step */
  grid({ normal, axis }, place, step) {
    const { ctx } = this, [u, v] = planeFrame(normal), k = "xyz".indexOf(axis), centre = place.map((c, i) => (i === k ? c : Math.round(c / step) * step));
    ctx.save();
    ctx.strokeStyle = this.accent;
    ctx.lineWidth = 1;
    for (let i = -LINES; i <= LINES; i++) for (let j = -LINES; j < LINES; j++) {
      ctx.globalAlpha = 0.42 * Math.max(0, 1 - Math.hypot(i, j + 0.5) / LINES);
      if (ctx.globalAlpha < 0.01) continue;
      const at = (/** @type {number} */ a, /** @type {number} */ b) => plus(centre, plus(times(u, a * step), times(v, b * step)));
      this.line([at(i, j), at(i, j + 1)]);
      this.line([at(j, i), at(j + 1, i)]);
    }
    ctx.restore();
  }

  /** Axes of a frame. @param {Pose} pose @param {number} length [px] */
  triad({ p, q }, length) {
    const { ctx, view } = this, px = 1 / view.scaleAt(p);
    ctx.save();
    ctx.lineWidth = 2;
    for (const [name, axis] of Object.entries(AXES)) {
      ctx.strokeStyle = axisColour(name);
      this.line([p, plus(p, times(turned(q, axis), length * px))]);
    }
    ctx.restore();
  }
}
