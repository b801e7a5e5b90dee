// Planar scenes on a canvas: grid, ground, bodies, mesh, traces, links and symbols.

/** @import { Context, TracedPoint } from "./types.d.ts" */
/** @import { End, Hit, Item, Label, Link, Paper, Part, Pixel, Shape } from "./scene_types.d.ts" */
/** @import { Colours, Look } from "./planar_symbols.js" */
/** @import { MeshPainter } from "./mesh_painter.js" */
/** @import { PlanarMotion, PlanarPose } from "./planar_motion.js" */
/** @import { PlanarView } from "./planar_view.js" */
/** @import { Scene } from "./scene.js" */

import { circle, contextOf, fitCanvas, stroke, trace } from "./canvas.js";
import { clamp, extent, niceAbove } from "./numbers.js";
import { LOOKS, drawBelt } from "./planar_looks.js";
import { corners, local } from "./planar_motion.js";
import { centreMark, groundPivot, hatch, hatchedLine, jointMark, linkSymbol, plate, solid, wheel } from "./planar_symbols.js";
import { cross, distanceToSegment, inside } from "./polygons.js";
import { Theme, mix } from "./theme.js";

/** Layers of the shapes of bodies, from the back. */
const LAYERS = [["disc", "curve"], ["block", "polygon"], ["bar", "line", "particle"]];
/** Order in which shapes are found under the pointer. */
const PICKED = ["bar", "line", "particle", "block", "polygon", "curve", "disc"];
/** Share of the motion of the strong part of a trace. */
const RECENT = 0.15;

export class PlanarPainter {
  /** @param {Scene} scene */
  constructor(scene) {
    this.scene = scene;
    this.motion = /** @type {PlanarMotion} */ (scene.motion);
    this.view = /** @type {PlanarView} */ (scene.view);
    /** @type {Context} */
    this.ctx = contextOf(scene.canvas);
    this.w = 0;
    this.h = 0;
    /** Half the width of a bar [px]. */
    this.half = 1;
    /** @type {Map<Part, PlanarPose | null>} */
    this.poses = new Map();
    /** @type {Part | Item | object | null} */
    this.highlighted = null;
    /** Guides of ground lines, and half the distance of their rails. @type {{ from: Pixel, to: Pixel, half: number }[]} */
    this.guides = [];
    /** Picture of a mesh. @type {MeshPainter | null} */
    this.mesh = null;
    /** Paths of traces, and the view for which they are drawn. */
    this.traces = { key: "", canvas: document.createElement("canvas") };
    this.restyle();
  }

  build() {
    const { motion: { mesh, otherMesh }, scene: { structure } } = this;
    this.mesh = structure && mesh ? new structure.Picture(this, mesh, otherMesh) : null;
    this.guides = this.findGuides();
    this.traces.key = "";
  }

  restyle() {
    const { ink, surface, muted, name } = Theme;
    /** @type {Colours} */
    this.colours = {
      ink: mix(ink, surface, 0.12), surface, ground: mix(surface, ink, 0.1), spring: Theme.colour(2),
      actuator: mix(surface, Theme.colour(4), 0.45), muted, drive: mix(Theme.colour(4), ink, 0.2),
    };
    /** @type {Look[]} */
    this.looks = this.motion.bodies.map((_, k) => Theme.colour(k)).map((colour) => ({
      fill: mix(surface, colour, name === "dark" ? 0.42 : 0.34), edge: name === "dark" ? colour : mix(colour, ink, 0.25), text: mix(colour, ink, 0.35), width: 1.6,
    }));
    /** @type {Look} */
    this.groundLook = { fill: mix(surface, ink, 0.13), edge: mix(surface, ink, 0.62), width: 1.5, text: muted };
  }

  /** @param {object | null} part */
  highlight(part) { this.highlighted = part; }

  // Positions ------------------------------------------------------------------------------------

  /** Pixel of a point of a body. @param {Pick<End, "body" | "point">} end */
  place({ body, point }) {
    const pose = this.poses.get(body);
    return pose ? this.view.screen(this.motion.placed(pose, point)) : null;
  }

  /** @param {Part} body */
  angleOf(body) { return this.poses.get(body)?.a ?? null; }

  /** Rotation of the ground away from straight below, by gravity. */
  get tilt() {
    const { gravity } = this.motion;
    return gravity ? -Math.atan2(-gravity[0], -gravity[1]) : 0;
  }

  /** Ground lines as guides; one through the middle of a block has two rails. */
  findGuides() {
    const { motion } = this, frames = motion.frames(24);
    return motion.ground.shapes.filter(({ kind }) => kind === "line").map((line) => {
      const [from, to] = /** @type {Pixel[]} */ ([line.from, line.to]), angle = Math.atan2(to[1] - from[1], to[0] - from[0]), length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      const guided = motion.bodies.flatMap((body) => body.shapes.filter((block) => block.kind === "block" && frames.length && frames.every((cursor) => {
        const pose = motion.pose(body, cursor);
        return pose && Math.abs(Math.sin(pose.a + block.angle - angle)) < 0.05 && Math.abs(cross(from, to, motion.placed(pose, block.center))) < 0.15 * block.height * length;
      })));
      return { from, to, half: Math.max(0, ...guided.map(({ height }) => height / 2)) };
    });
  }

  // Painting -------------------------------------------------------------------------------------

  /** @param {Paper | null} paper @returns {Paper} */
  paint(paper) {
    const { motion, scene, view } = this, sheet = paper ?? fitCanvas(scene.canvas, scene.ratio), { ctx } = sheet;
    Object.assign(this, sheet);
    this.half = clamp(scene.unit * view.s, 2.2, 13);
    this.poses = new Map([motion.ground, ...motion.bodies].map((body) => [body, motion.pose(body)]));
    if (scene.show.grid) this.drawGrid();
    this.drawGround();
    this.drawGhosts();
    this.mesh?.draw();
    this.drawBodies();
    this.drawTraces(paper !== null);
    for (const link of motion.links) this.drawLink(link);
    for (const item of [...motion.symbols, ...motion.joints]) if (item.wheels.length === 2) drawBelt(this, item);
    for (const item of motion.symbols) LOOKS[item.symbol]?.(this, item);
    for (const joint of motion.joints) {
      const p = this.place(joint);
      if (!p) continue;
      if (this.highlighted === joint) { circle(ctx, p, this.half + 5); stroke(ctx, Theme.accent, 2); }
      jointMark(ctx, joint, p, this.half, this.colours);
    }
    this.drawPoints();
    return sheet;
  }

  drawGrid() {
    const { ctx, view, w, h } = this, step = niceAbove(70 / view.s), [a, b] = [view.world([0, h]), view.world([w, 0])];
    for (const [size, colour] of /** @type {[number, string][]} */ ([[step / 5, mix(Theme.surface, Theme.grid, 0.4)], [step, Theme.grid]])) {
      ctx.beginPath();
      for (let k = Math.ceil(a[0] / size); k * size <= b[0]; k++) {
        const x = Math.round(view.screen([k * size, 0])[0]) + 0.5;
        ctx.moveTo(x, 0);
        ctx.lineTo(x, h);
      }
      for (let k = Math.ceil(a[1] / size); k * size <= b[1]; k++) {
        const y = Math.round(view.screen([0, k * size])[1]) + 0.5;
        ctx.moveTo(0, y);
        ctx.lineTo(w, y);
      }
      stroke(ctx, colour, 1);
    }
  }

  drawGround() {
    const { ctx, colours, half, motion } = this;
    for (const guide of this.guides) {
      let [a, b] = [this.view.screen(guide.from), this.view.screen(guide.to)];
      if (a[0] > b[0] || (a[0] === b[0] && a[1] > b[1])) [a, b] = [b, a];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1, [nx, ny] = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
      const rail = guide.half * this.view.s + 1.5, gap = clamp(0.9 * half, 4, 8);
      if (guide.half > 0) {
        trace(ctx, [a, b]);
        stroke(ctx, colours.muted, 0.9, [12, 4, 2, 4]);
      }
      for (const d of guide.half > 0 ? [rail, -rail] : [0]) {
        const [p, q] = /** @type {Pixel[]} */ ([a, b].map(([x, y]) => [x + nx * d, y + ny * d]));
        trace(ctx, [p, q]);
        stroke(ctx, colours.ink, 1.6);
        if (d >= 0) hatch(ctx, p, q, colours.ink, gap, 0.75 * gap); else hatch(ctx, q, p, colours.ink, gap, 0.75 * gap);
      }
    }
    for (const shape of motion.ground.shapes) if (shape.kind !== "line") this.drawShape(shape, motion.pose(motion.ground), this.groundLook);
    for (const joint of motion.joints) {
      const p = joint.grounded && this.place(joint);
      if (p && joint.symbol === "pin") groundPivot(ctx, p, half, colours, this.tilt);
      if (p && joint.symbol === "clamp") this.drawAnchor(p, this.middleOf(joint.on) ?? [p[0], p[1] - 1]);
    }
  }

  /** Middle of the outline of a body. @param {Part | null} body @returns {Pixel | null} */
  middleOf(body) {
    const points = body?.shapes.flatMap((shape) => this.motion.outline(shape)) ?? [];
    return body && points.length ? this.place({ body, point: [mean(points.map((p) => p[0])), mean(points.map((p) => p[1]))] }) : null;
  }

  /** Bodies of another design, or of the initial guess. */
  drawGhosts() {
    const { ctx, motion } = this, look = { edge: Theme.muted, fill: Theme.surface, text: Theme.muted, width: 1.5 };
    ctx.globalAlpha = motion.n > 1 ? 0.5 : 0.25;
    for (const ghost of this.scene.show.ghosts ? motion.ghosts : []) {
      const pose = motion.pose(ghost);
      if (pose) for (const shape of ghost.shapes) this.drawShape(shape, pose, look);
    }
    ctx.globalAlpha = 1;
  }

  drawBodies() {
    const { bodies } = this.motion;
    LAYERS.forEach((kinds, layer) => {
      const parts = bodies.flatMap((body) => body.shapes.filter(({ kind }) => kinds.includes(kind)).map((shape) => ({ body, shape })));
      if (!layer) parts.sort((a, b) => b.shape.radius - a.shape.radius);
      for (const { body, shape } of parts) {
        const pose = this.poses.get(body), look = this.looks[body.index];
        if (pose) this.drawShape(shape, pose, this.highlighted === body ? { ...look, edge: Theme.accent, width: 2.6 } : look);
      }
    });
    for (const body of bodies) {
      const p = !body.node && !body.shapes.length && !body.of && this.place({ body, point: [0, 0] });
      if (p) centreMark(this.ctx, p, this.half, this.looks[body.index].edge, Theme.surface);
    }
  }

  /** @param {Shape} shape @param {PlanarPose | null} pose @param {Look} look */
  drawShape(shape, pose, look) {
    if (!pose) return;
    const { ctx, half } = this, put = (/** @type {any} */ p) => this.view.screen(this.motion.placed(pose, p));
    switch (shape.kind) {
      case "bar": return plate(ctx, [put(shape.from), put(shape.to)], half, look);
      case "polygon": return plate(ctx, shape.points.map(put), half, look);
      case "disc": return wheel(ctx, put(shape.center), shape.radius * this.view.s, pose.a, look, shape.teeth);
      case "block":
        trace(ctx, corners(shape).map(put), true);
        return solid(ctx, look);
      case "curve":
        trace(ctx, shape.points.map(put), shape.closed);
        if (shape.closed) return solid(ctx, look);
        ctx.lineJoin = "round";
        return stroke(ctx, look.edge, 2);
      case "line":
        trace(ctx, [put(shape.from), put(shape.to)]);
        return stroke(ctx, look.edge, 2);
      case "particle":
        circle(ctx, put(shape.center), 1.15 * half);
        return solid(ctx, { ...look, fill: look.edge });
    }
  }

  // Links ----------------------------------------------------------------------------------------

  /** @param {Link} link */
  drawLink(link) {
    const { ctx, half, motion } = this, p = this.place(link.i), q = this.place(link.j);
    if (!p || !q) return;
    // All pieces of a beam have the colour of the first one.
    const strand = link.symbol === "strand" && motion.links.find(({ name }) => name === link.name), colours = strand ? { ...this.colours, ink: this.looks[strand.j.body.index].edge } : this.colours;
    linkSymbol(ctx, link.symbol, p, q, half, link.rest * this.view.s, 3.4 * link.offset * half, colours);
    for (const [{ body, point }, at, toward] of /** @type {[End, Pixel, Pixel][]} */ (strand ? [] : [[link.i, p, q], [link.j, q, p]])) {
      circle(ctx, at, clamp(0.32 * half, 1.8, 4));
      ctx.fillStyle = colours.ink;
      ctx.fill();
      const occupied = motion.joints.some((joint) => joint.body.fixed && Math.hypot(joint.point[0] - point[0], joint.point[1] - point[1]) < this.scene.unit);
      if (body.fixed && !occupied) this.drawAnchor(at, toward);
    }
  }

  /** Hatched wall behind the fixed end of a link. @param {Pixel} at @param {Pixel} toward */
  drawAnchor(at, toward) {
    const [dx, dy] = [toward[0] - at[0], toward[1] - at[1]], length = Math.hypot(dx, dy) || 1, r = 2.4 * this.half, [nx, ny] = [(-dy / length) * r, (dx / length) * r];
    hatchedLine(this.ctx, [at[0] - nx, at[1] - ny], [at[0] + nx, at[1] + ny], this.half, this.colours);
  }

  // Traces ---------------------------------------------------------------------------------------

  /** Whole paths of the traced points, faint, with the recent part strong; on paper strong. @param {boolean} paper */
  drawTraces(paper) {
    const { ctx, motion, scene, view } = this, traced = motion.points.filter((point) => point.traced), { canvas } = scene;
    if (!traced.length) return;
    if (paper) {
      for (const point of traced) this.drawPath(ctx, point, -Infinity, Infinity, scene.pointColour(point), 1.6);
      return;
    }
    const key = [canvas.width, canvas.height, view.x, view.y, view.s, Theme.name, traced.map(({ index }) => index)].join(), layer = this.traces.canvas;
    if (key !== this.traces.key) {
      this.traces.key = key;
      [layer.width, layer.height] = [canvas.width, canvas.height];
      const context = contextOf(layer);
      context.scale(canvas.width / this.w, canvas.width / this.w);
      for (const point of traced) this.drawPath(context, point, -Infinity, Infinity, mix(Theme.surface, scene.pointColour(point), 0.5), 1.6);
    }
    /** @type {CanvasRenderingContext2D} */ (ctx).drawImage(layer, 0, 0, this.w, this.h);
    for (const point of traced) this.drawPath(ctx, point, motion.now - RECENT * motion.span, motion.now, scene.pointColour(point), 2.4, this.place(point));
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
      const [x, y] = this.view.screen(p);
      if (on) ctx.lineTo(x, y); else ctx.moveTo(x, y);
      on = true;
      if (++count % 100) continue;
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
    const { s } = this.view, { way, thin } = point;
    if (thin?.s === s && thin.way === way) return thin.points;
    /** @type {any} */
    let last = null;
    const points = way.filter(({ p }, k) => {
      if (p && last && k < way.length - 1 && (Math.abs(p[0] - last[0]) + Math.abs(p[1] - last[1])) * s < 0.7) return false;
      last = p;
      return true;
    });
    point.thin = { s, way, points };
    return points;
  }

  drawPoints() {
    const { ctx, half, scene } = this;
    for (const point of this.motion.spots) {
      const p = this.place(point), colour = scene.pointColour(point);
      if (!p) continue;
      circle(ctx, p, point.traced ? clamp(0.5 * half, 3, 5) : 2.2);
      ctx.fillStyle = point.traced || this.highlighted === point ? colour : Theme.surface;
      ctx.fill();
      stroke(ctx, point.traced ? Theme.surface : colour, 1.4);
    }
  }

  // Under the pointer ------------------------------------------------------------------------------

  /** @param {Pixel} pixel @returns {Hit | null} */
  hit(pixel) {
    const { half, motion, view } = this, near = (/** @type {Pixel | null} */ p, /** @type {number} */ r) => p !== null && Math.hypot(p[0] - pixel[0], p[1] - pixel[1]) <= r;
    for (const item of motion.joints) if (near(this.place(item), Math.max(8, half))) return { kind: "joint", item };
    for (const item of motion.spots) if (near(this.place(item), 8)) return { kind: "point", item };
    for (const item of motion.links) {
      const p = this.place(item.i), q = this.place(item.j);
      if (p && q && distanceToSegment(pixel, p, q) < half * (1.3 + 3.4 * Math.abs(item.offset)) + 3) return { kind: "link", item };
    }
    for (const item of motion.symbols) if (!item.at && item.node === null && !item.nodes.length && near(this.place(item), 3 * half)) return { kind: "symbol", item };
    /** @type {Hit | null} */
    let hit = null;
    let rank = Infinity;
    const reach = (half + 2) / view.s;
    for (const body of motion.bodies) {
      const pose = this.poses.get(body), p = pose && local(pose, view.world(pixel));
      if (!p) continue;
      if (!body.shapes.length && Math.hypot(...p) < reach) hit = { kind: "body", item: body };
      for (const shape of body.shapes) {
        const order = PICKED.indexOf(shape.kind) + (shape.radius ? 1 - 1 / (1 + shape.radius) : 0);
        if (order < rank && inShape(shape, p, reach)) [hit, rank] = [{ kind: "body", item: body }, order];
      }
    }
    return hit;
  }

  // Labels ---------------------------------------------------------------------------------------

  /** @param {Paper} paper @returns {Label[]} */
  labels({ ctx }) {
    const { half, motion, view } = this, bodies = [...this.poses].filter(([, pose]) => pose !== null);
    const covered = (/** @type {Pixel} */ pixel) => bodies.filter(([body, pose]) => pose && body.shapes.some((shape) => inShape(shape, local(pose, view.world(pixel)), (half + 4) / view.s))).length;
    const short = motion.joints.filter(({ name }) => name && name.length <= 3), [dx, dy] = [1.1 * half + 7, 0.9 * half + 5];
    const joints = (short.length > 24 ? [] : short).map((joint) => {
      const p = this.place(joint);
      if (!p) return null;
      const places = /** @type {Pixel[]} */ ([[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([u, v]) => [p[0] + u * dx, p[1] + v * dy])), costs = places.map(covered), least = Math.min(...costs);
      return { text: joint.name, font: "italic 12px", colour: Theme.muted, places: [...places.filter((_, k) => costs[k] === least), ...places], required: true, owner: joint };
    });
    const names = motion.bodies.map((body) => {
      const pose = this.poses.get(body), font = "600 12px";
      if (!pose || !body.label) return null;
      ctx.font = `${font} ${Theme.font}`;
      return { text: body.label, font, colour: this.looks[body.index].text, places: this.labelPlaces(body, pose, ctx.measureText(body.label).width / 2), required: true, owner: body };
    });
    return [...joints, ...names].filter((label) => label !== null);
  }

  /** Positions of the name of a body, best first: beside a bar, in a plate, about other shapes. @param {Part} body @param {PlanarPose} pose @param {number} wide @returns {Pixel[]} */
  labelPlaces({ shapes }, pose, wide) {
    const seen = (/** @type {any} */ p) => this.view.screen(this.motion.placed(pose, p));
    if (shapes.length === 1 && shapes[0].kind === "bar") {
      const [a, b] = [seen(shapes[0].from), seen(shapes[0].to)], length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const [nx, ny] = [(b[1] - a[1]) / length, -(b[0] - a[0]) / length], gap = this.half + 11 + (wide - 6) * Math.abs(nx);
      return [gap, -gap].flatMap((d) => [0.5, 0.33, 0.67].map((k) => /** @type {Pixel} */ ([a[0] + k * (b[0] - a[0]) + d * nx, a[1] + k * (b[1] - a[1]) + d * ny])));
    }
    const points = (shapes.length ? shapes.flatMap((shape) => this.motion.outline(shape)) : [[0, 0]]).map(seen), columns = [0, 1].map((k) => points.map((p) => p[k]));
    const [[x0, x1], [y0, y1]] = columns.map((column) => extent([column]) ?? [0, 0]), [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2], plates = shapes.some(({ kind }) => kind === "polygon");
    const pad = 12 + (!shapes.length || shapes.some(({ kind }) => ["polygon", "bar", "particle"].includes(kind)) ? this.half : 0);
    /** @type {Pixel[]} */
    const around = [[x, y0 - pad], [x, y1 + pad], [x1 + pad + wide - 4, y], [x0 - pad - wide + 4, y]];
    return plates && Math.min(x1 - x0, y1 - y0) > 2 * wide ? [[mean(columns[0]), mean(columns[1])], ...around] : around;
  }
}

/** @param {number[]} values */
const mean = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;

/** Number of the first instant of a path that is not before a time. @param {TracedPoint["way"]} way @param {number} time */
function firstAfter(way, time) {
  let low = 0, high = way.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (way[middle].t < time) low = middle + 1; else high = middle;
  }
  return low;
}

/** Whether a point in the axes of a body lies on a shape. @param {Shape} shape @param {Pixel} p @param {number} reach */
function inShape(shape, p, reach) {
  const [from, to, center] = /** @type {Pixel[]} */ ([shape.from, shape.to, shape.center]), points = /** @type {Pixel[]} */ (shape.points);
  const onEdge = (/** @type {boolean} */ closed) => points.some((q, k) => (k || closed) && distanceToSegment(p, points[(k || points.length) - 1], q) < reach);
  switch (shape.kind) {
    case "bar": case "line": return distanceToSegment(p, from, to) < reach;
    case "disc": return Math.hypot(p[0] - center[0], p[1] - center[1]) < shape.radius + reach / 3;
    case "particle": return Math.hypot(p[0] - center[0], p[1] - center[1]) < reach;
    case "block": return inside(p, corners(shape));
    case "curve": return onEdge(shape.closed) || (shape.closed && inside(p, points));
    default: return onEdge(true) || inside(p, points);
  }
}
