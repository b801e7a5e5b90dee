// Planar scenes on a canvas: grid, ground, bodies, mesh, traces, links and symbols.

/** @import { Context } from "./types.d.ts" */
/** @import { End, Item, Link, Paper, Part, Pixel, Shape } from "./scene_types.d.ts" */
/** @import { Colours, Look } from "./planar_symbols.js" */
/** @import { MeshPainter } from "./mesh_painter.js" */
/** @import { PlanarMotion, PlanarPose } from "./planar_motion.js" */
/** @import { PlanarView } from "./planar_view.js" */
/** @import { Scene } from "./scene.js" */

import { circle, contextOf, fitCanvas, stroke, trace } from "./canvas.js";
import { clamp, niceAbove } from "./numbers.js";
import { LOOKS, drawBelt } from "./planar_looks.js";
import { planarHit } from "./planar_hits.js";
import { mean, planarLabels } from "./planar_labels.js";
import { corners } from "./planar_motion.js";
import { centreMark, groundPivot, hatch, hatchedLine, jointMark, linkSymbol, plate, solid, wheel } from "./planar_symbols.js";
import { cross } from "./polygons.js";
import { PlanarTraces } from "./planar_traces.js";
import { Theme, mix } from "./theme.js";

/** Layers of the shapes of bodies, from the back. */
const LAYERS = [["disc", "curve"], ["block", "polygon"], ["bar", "line", "particle"]];

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
    this.traces = new PlanarTraces(this);
    this.restyle();
  }

  build() {
    const { motion: { mesh, otherMesh }, scene: { structure } } = this;
    this.mesh = structure && mesh ? new structure.Picture(this, mesh, otherMesh) : null;
    this.guides = this.findGuides();
    this.traces.key = "";
  }

  refit() { this.guides = this.findGuides(); }

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

  /** Pixel of a joint: of its point, or of a position of its own over time. @param {Item} joint */
  placeOf(joint) {
    const place = joint.at && this.motion.placeOf(joint);
    return joint.at ? place && this.view.screen(place) : this.place(joint);
  }

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
    this.traces.draw(paper !== null);
    for (const link of motion.links) this.drawLink(link);
    for (const item of [...motion.symbols, ...motion.joints]) if (item.wheels.length === 2) drawBelt(this, item);
    for (const item of motion.symbols) LOOKS[item.symbol]?.(this, item);
    for (const joint of motion.joints) {
      const p = this.placeOf(joint);
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
    for (const ghost of this.scene.pale) {
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
  /** @param {Pixel} pixel */
  hit(pixel) { return planarHit(this, pixel); }

  labels() { return planarLabels(this); }
}
