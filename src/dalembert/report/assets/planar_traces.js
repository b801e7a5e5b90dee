// Paths of traced points in the plane.

/** @import { Context, TracedPoint } from "./types.d.ts" */
/** @import { Pixel } from "./scene_types.d.ts" */
/** @import { PlanarPainter } from "./planar_painter.js" */

import { contextOf, stroke } from "./canvas.js";
import { Theme, mix } from "./theme.js";

/** Share of the motion of the strong part of a path. */
const RECENT = 0.15;
/** Distance of the drawn points of a path, and their number in one stroke. */
const SPACING = 0.7, PIECE = 100;

export class PlanarTraces {
  /** @param {PlanarPainter} painter */
  constructor(painter) {
    this.painter = painter;
    /** Whole paths, and the view for which they are drawn. */
    this.layer = document.createElement("canvas");
    this.key = "";
  }

  /** Whole paths of the traced points, faint, with the recent part strong; on paper strong. @param {boolean} paper */
  draw(paper) {
    const { painter: { ctx, motion, scene, view, w, h } } = this, traced = motion.points.filter((point) => point.traced), { canvas } = scene;
    if (!traced.length) return;
    if (paper) {
      for (const point of traced) this.drawPath(ctx, point, -Infinity, Infinity, scene.pointColour(point), 1.6);
      return;
    }
    const key = [canvas.width, canvas.height, view.x, view.y, view.s, Theme.name, traced.map(({ index }) => index)].join(), { layer } = this;
    if (key !== this.key) {
      this.key = key;
      [layer.width, layer.height] = [canvas.width, canvas.height];
      const context = contextOf(layer);
      context.scale(canvas.width / w, canvas.width / w);
      for (const point of traced) this.drawPath(context, point, -Infinity, Infinity, mix(Theme.surface, scene.pointColour(point), 0.5), 1.6);
    }
    /** @type {CanvasRenderingContext2D} */ (ctx).drawImage(layer, 0, 0, w, h);
    for (const point of traced) this.drawPath(ctx, point, motion.now - RECENT * motion.span, motion.now, scene.pointColour(point), 2.4, this.painter.place(point));
  }

  /** Part of a path, in pieces, because long self-intersecting paths are slow to stroke.
   * @param {Context} ctx @param {TracedPoint} point @param {number} from @param {number} to @param {string} colour @param {number} width @param {Pixel | null} end */
  drawPath(ctx, point, from, to, colour, width, end = null) {
    const way = this.thinned(point);
    ctx.lineJoin = ctx.lineCap = "round";
    ctx.beginPath();
    let on = false, count = 0;
    for (let k = firstAfter(way, from); k < way.length && way[k].t <= to; k++) {
      const { p } = way[k];
      if (!p) { on = false; continue; }
      const [x, y] = this.painter.view.screen(p);
      if (on) ctx.lineTo(x, y); else ctx.moveTo(x, y);
      on = true;
      if (++count % PIECE) continue;
      stroke(ctx, colour, width);
      ctx.beginPath();
      ctx.moveTo(x, y);
    }
    if (on && end) ctx.lineTo(end[0], end[1]);
    stroke(ctx, colour, width);
    ctx.lineCap = "butt";
  }

  /** Points of a path that are a pixel apart at this scale; their number does not depend on that of the instants. @param {TracedPoint} point */
  thinned(point) {
    const { s } = this.painter.view, { way, thin } = point;
    if (thin?.s === s && thin.way === way) return thin.points;
    /** @type {any} */
    let last = null;
    const points = way.filter(({ p }, k) => {
      if (p && last && k < way.length - 1 && (Math.abs(p[0] - last[0]) + Math.abs(p[1] - last[1])) * s < SPACING) return false;
      last = p;
      return true;
    });
    point.thin = { s, way, points };
    return points;
  }
}

/** Number of the first instant of a path that is not before a time. @param {TracedPoint["way"]} way @param {number} time */
function firstAfter(way, time) {
  let low = 0, high = way.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (way[middle].t < time) low = middle + 1; else high = middle;
  }
  return low;
}
