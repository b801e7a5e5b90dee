// Marks over the drawing: loads, labels, gaps, axes, gravity, scales.

/** @import { LoadKind } from "./types.d.ts" */
/** @import { DrawnArrow, Item, Label, Paper, Pixel } from "./scene_types.d.ts" */
/** @import { Scene } from "./scene.js" */

import { arrow, label, momentArc } from "./arrows.js";
import { circle, stroke, trace } from "./canvas.js";
import { LOADS, READABLE, loadText } from "./loads.js";
import { TAU, clamp, clock, niceAbove } from "./numbers.js";
import { Theme, mix } from "./theme.js";
import { inUnits, metres, quantity } from "./units.js";

const AXIS_COLOURS = { light: ["#c0392b", "#1e8449", "#1f5fbf"], dark: ["#ff7b6b", "#58d68d", "#6aa9ff"] };
/** Length of the largest arrow, relative to the canvas: of reactions, of loads, of loads on nodes, of many of them. */
const REACTION = 0.26, LOAD = 0.16, NODAL_LOAD = 0.11, MANY_LOADS = 0.07;
/** Upper limit of nodal loads with long arrows. */
const FEW_LOADS = 6;
/** Number of arrows above which they are thin and have no halo. */
const DENSE = 40;
/** Lower limit of the length of an arrow [px]. */
const SHORTEST = 18;
/** Limit of the names of nodes that are placed beside each other. */
const PLACED_NAMES = 60;

/** Whether two texts would be written over each other. @param {{ x: number, y: number, half: number }} a @param {{ x: number, y: number, half: number }} b */
const overlap = (a, b) => Math.abs(a.x - b.x) < a.half + b.half - 8 && Math.abs(a.y - b.y) < 13;

export class Marks {
  /** @param {Scene} scene */
  constructor(scene) {
    this.scene = scene;
    /** @type {Paper} */
    this.paper = /** @type {any} */ (null);
  }

  /** @param {Paper} paper */
  draw(paper) {
    const { scene, scene: { motion, show } } = this;
    this.paper = paper;
    scene.arrows = [];
    if (motion.mesh?.diagram) scene.structure?.drawDiagram(this, motion.mesh);
    if (show.loads) this.drawLoads(scene.applied);
    if (show.forces) this.drawLoads(scene.loaded);
    this.drawGaps();
    if (show.values) this.drawValues();
    if (show.labels) this.drawLabels();
    if (motion.dimension === 3 || motion.mesh) this.drawAxes();
    if (motion.gravity && motion.dimension === 2) this.drawGravity([32, 34]);
    this.drawScales();
  }

  /** Note below the drawing. @param {Paper} paper @param {string} text */
  note(paper, text) {
    this.paper = paper;
    this.write(text, [paper.w / 2, paper.h - 12], Theme.muted);
  }

  get ink() { return mix(Theme.ink, Theme.surface, 0.2); }

  /** @param {string} text @param {Pixel} at @param {string} colour @param {CanvasTextAlign} [align] */
  write(text, at, colour, font = "12px", align = "center") {
    this.paper.ctx.font = `${font} ${Theme.font}`;
    label(this.paper.ctx, text, at, colour, Theme.surface, align);
  }

  /** Width of a text [px]. @param {string} text */
  widthOf(text, font = "12px") {
    this.paper.ctx.font = `${font} ${Theme.font}`;
    return this.paper.ctx.measureText(text).width;
  }

  // Loads ----------------------------------------------------------------------------------------

  /** Role of a load. @param {Item} item @param {"force" | "moment"} key @returns {LoadKind} */
  roleOf(item, key) { return this.scene.motion.symbols.includes(item) ? (key === "force" ? "load" : "twist") : key; }

  /** @param {LoadKind} role */
  colourOf(role) {
    if (this.scene.motion.mesh) return LOADS[role].reaction ? Theme.accent : Theme.force;
    return role === "force" || role === "moment" ? Theme[role] : Theme.ink;
  }

  /** Pixels per newton or newton metre of the arrows of a role. @param {LoadKind} role */
  scaleOf(role) {
    const { paper: { w, h }, scene: { applied, greatest, loaded, motion, sizes } } = this;
    const nodal = (LOADS[role].reaction ? loaded : applied).length > FEW_LOADS ? MANY_LOADS : NODAL_LOAD;
    const share = motion.mesh ? nodal : LOADS[role].reaction ? REACTION : LOAD;
    return (share * sizes[role] * Math.min(w, h)) / (greatest[role] || 1);
  }

  /** Angle of the arc of a planar moment. @param {LoadKind} role @param {number} moment */
  sweepOf(role, moment) { return clamp((moment / (this.scene.greatest[role] || 1)) * this.scene.sizes[role] * 0.78, -0.94, 0.94) * TAU; }

  /** Arrows of forces and moments with their values. @param {Item[]} items */
  drawLoads(items) {
    const { paper: { ctx }, scene: { greatest, motion, painter, arrows } } = this, first = arrows.length, dense = items.length > DENSE;
    for (const item of items) {
      const place = motion.placeOf(item), from = place && this.scene.screen(place);
      for (const key of /** @type {const} */ (["force", "moment"])) {
        const value = motion.vectorOf(item[key]), role = this.roleOf(item, key), size = Math.hypot(...value ?? [NaN]);
        if (!from || !value || !(size > 1e-9 * greatest[role])) continue;
        const colour = this.colourOf(role), reaction = LOADS[role].reaction;
        if (value.length === 1) {
          const r = (reaction ? 2.2 : 3.2) * painter.half + (reaction ? 8 : 4);
          momentArc(ctx, from, r, this.sweepOf(role, value[0]), colour, Theme.surface, reaction ? 2.2 : 2.6);
          arrows.push({ item, role, from, way: [0, r + 4], value: size });
          continue;
        }
        const [u, v] = this.scene.view.direction(value), k = Math.max(this.scaleOf(role), size > 1e-3 * greatest[role] ? SHORTEST / size : 0);
        const way = /** @type {Pixel} */ ([k * u, k * v]), inward = item.inward && item.inward[motion.state] > 0.5;
        const tail = /** @type {Pixel} */ (inward ? [from[0] - way[0], from[1] - way[1]] : from);
        arrow(ctx, tail, way, colour, dense ? "" : Theme.surface, dense ? 1.2 : reaction ? 2.4 : motion.mesh ? 2 : 2.8, key === "moment" ? 2 : 1);
        arrows.push({ item, role, from: tail, way, value: size, inward: Boolean(inward) });
      }
    }
    if (this.scene.show.labels || motion.mesh) this.writeLoads(arrows.slice(first));
  }

  /** Position nearest to x of a text between the legend and the buttons [px]. @param {number} x @param {number} y @param {number} half of its width */
  freeAt(x, y, half) {
    const { w } = this.paper;
    let [left, right] = [0, w];
    for (const { offsetLeft, offsetTop, offsetWidth, offsetHeight } of this.scene.panels) {
      if (y < offsetTop - 10 || y > offsetTop + offsetHeight + 10) continue;
      if (2 * offsetLeft + offsetWidth < w) left = Math.max(left, offsetLeft + offsetWidth);
      else right = Math.min(right, offsetLeft);
    }
    return clamp(x, left + half, Math.max(left + half, right - half));
  }

  /** Values beside the arrows, if there are few; equal values side by side are written once, and of different ones in one place the largest. @param {DrawnArrow[]} arrows */
  writeLoads(arrows) {
    if (arrows.length > 2 * READABLE) return;
    const font = "600 11.5px";
    const texts = arrows.map(({ role, from: [x, y], way: [u, v], value, inward }) => {
      const text = this.scene.motion.mesh ? quantity(value, LOADS[role].unit.replace("·", " "), 3) : loadText(role, value), length = Math.hypot(u, v) || 1, half = this.widthOf(text, font) / 2 + 6;
      const [px, py] = inward ? [x, y] : [x + u, y + v], side = inward ? -1 : 1, level = Math.abs(u) > Math.abs(v);
      const dx = level ? side * Math.sign(u) * (half + 2) : half + 3, dy = level ? 0 : (side * 4 * v) / length, free = this.freeAt(px + dx, py + dy, half);
      return { text, half, value, colour: this.colourOf(role), x: free, y: py + (free === px + dx ? dy : -13) };
    }).sort((a, b) => a.y - b.y || a.x - b.x);
    /** @type {(typeof texts)[]} */
    const runs = [];
    for (const one of texts) {
      const near = runs.find((run) => run[0].text === one.text && run.some((other) => Math.hypot(other.x - one.x, other.y - one.y) < 30 || overlap(one, other)));
      if (near) near.push(one); else runs.push([one]);
    }
    const joined = runs.map((run) => {
      const one = run[run.length >> 1], text = run.length > 1 ? `${run.length} × ${one.text}` : one.text, half = this.widthOf(text, font) / 2 + 6;
      return { ...one, text, half, x: this.freeAt(one.x, one.y, half) };
    }).sort((a, b) => b.value - a.value);
    joined.forEach((one, k) => { if (!joined.slice(0, k).some((larger) => overlap(one, larger))) this.write(one.text, [one.x, one.y], one.colour, font); });
  }

  // Labels ---------------------------------------------------------------------------------------

  drawLabels() {
    const { scene: { motion, painter }, paper: { w, h } } = this;
    const place = (/** @type {{ body: any, point: any }} */ { body, point }) => { const p = motion.at(body, point); return p && this.scene.screen(p); };
    const middles = motion.links.map(({ i, j }) => { const p = place(i), q = place(j); return p && q && /** @type {Pixel} */ ([(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]); });
    const pins = [...motion.joints.filter(({ at }) => !at).map(place), ...middles].filter((p) => p !== null), { half } = painter;
    /** @type {{ x: number, y: number, wide: number }[]} */
    const taken = [];
    for (const { text, font, colour, places, required, owner } of [...painter.labels(), ...this.nodeLabels()]) {
      const wide = this.widthOf(text, font) / 2;
      const cost = ([x, y] = /** @type {Pixel} */ ([0, 0]), more = 0) =>
        pins.filter((p) => Math.abs(p[0] - x) < wide + half + more && Math.abs(p[1] - y) < 8 + half + more).length
        + 2 * taken.filter((t) => Math.abs(t.x - x) < wide + t.wide + more && Math.abs(t.y - y) < 16 + more).length
        + (Math.abs(x - w / 2) > w / 2 - wide || Math.abs(y - h / 2) > h / 2 - 8 ? 3 : 0);
      // A label keeps its place until another one is better, or the best one is clear again.
      const costs = places.map((p) => cost(p)), least = Math.min(...costs);
      if (owner.side === undefined || !(costs[owner.side] <= least)) owner.side = costs.indexOf(least);
      if (owner.side && !cost(places[0], 10)) owner.side = 0;
      if (!required && least > 1) continue;
      const [x, y] = places[owner.side];
      taken.push({ x, y, wide });
      this.write(text, [x, y], colour, font);
    }
  }

  /** Names of the nodes of a mesh. @returns {Label[]} */
  nodeLabels() {
    const { mesh } = this.scene.motion, seen = this.scene.seen();
    return (mesh?.nodes ?? []).map((text, k) => {
      const [x, y] = [seen[3 * k], seen[3 * k + 1]], wide = this.widthOf(text) / 2 + 7;
      const places = /** @type {Pixel[]} */ ([[x + wide, y - 10], [x - wide, y - 10], [x + wide, y + 10], [x - wide, y + 10], [x, y - 15], [x, y + 15]]);
      const few = (mesh?.nodes.length ?? 0) <= PLACED_NAMES;
      return { text, font: "12px", colour: Theme.ink, places: few ? places : places.slice(0, 1), required: few, owner: {} };
    });
  }

  /** Values of the field on the lines. */
  drawValues() {
    const { mesh } = this.scene.motion, field = mesh?.field;
    if (!mesh || !field || field.atVertices) return;
    const values = mesh.values(field), largest = values.reduce((size, v) => Math.max(size, Math.abs(v) || 0), 0), seen = this.scene.seen();
    for (const { size, vertices, elements } of mesh.lines) elements.forEach((element, row) => {
      const value = values[element], [a, b] = [3 * vertices[row * size], 3 * vertices[(row + 1) * size - 1]];
      if (Number.isFinite(value)) this.write(Math.abs(value) < 1e-9 * largest ? "0" : quantity(value, field.unit, 3), [(seen[a] + seen[b]) / 2, (seen[a + 1] + seen[b + 1]) / 2], Theme.ink, "600 11.5px");
    });
  }

  /** Points that should coincide, and their distance. */
  drawGaps() {
    const { scene: { motion, painter }, paper: { ctx, w } } = this;
    for (const { from, to, text } of motion.gaps) {
      const p = this.scene.screen(from), q = this.scene.screen(to), wide = this.widthOf(text, "600 13px") / 2 + 8;
      if (!p || !q) continue;
      trace(ctx, [p, q]);
      stroke(ctx, Theme.error, 2.4, [6, 4]);
      for (const end of [p, q]) { circle(ctx, end, painter.half + 4); stroke(ctx, Theme.error, 2); }
      this.write(text, [clamp((p[0] + q[0]) / 2, wide, w - wide), Math.max(p[1], q[1]) + painter.half + 20], Theme.error, "600 13px");
    }
  }

  // Axes and scales ------------------------------------------------------------------------------

  /** Axes in the corner, and gravity beside them in space. */
  drawAxes() {
    const { scene: { motion, view }, paper: { ctx, h } } = this, centre = /** @type {Pixel} */ ([48, h - 52]), size = 30;
    const axes = motion.axes.map((name, k) => ({ name, colour: AXIS_COLOURS[Theme.name][k], way: view.direction([0, 1, 2].map((i) => +(i === k))) }));
    for (const { name, way: [u, v], colour } of axes.sort((a, b) => a.way[2] - b.way[2])) {
      arrow(ctx, centre, [size * u, size * v], colour, Theme.surface, 2.2);
      this.write(name, [centre[0] + 1.36 * size * u, centre[1] + 1.36 * size * v], colour, "600 12px");
    }
    if (motion.gravity && motion.dimension === 3) this.drawGravity([centre[0] + 62, centre[1]]);
  }

  /** @param {Pixel} centre */
  drawGravity([x, y]) {
    const gravity = this.scene.motion.gravity ?? [], size = Math.hypot(...gravity), [u, v] = this.scene.view.direction(gravity).map((w) => w / size);
    arrow(this.paper.ctx, [x - 15 * u, y - 15 * v], [30 * u, 30 * v], Theme.muted, Theme.surface, 1.6);
    this.write("g", [x + 14 * Math.abs(v), y + 14 * Math.abs(u)], Theme.muted, "italic 13px");
  }

  /** Scale of lengths, time on paper, and arrows of round loads. */
  drawScales() {
    const { scene: { motion, ratio, show, greatest, view }, paper: { ctx, w, h } } = this, { ink } = this;
    if (motion.dimension === 3) {
      if (show.grid) this.write(`grid ${metres(/** @type {any} */ (view).step)}`, [16, h - 12], Theme.muted, "12px", "left");
    } else {
      const size = niceAbove(70 / view.scaleAt(motion.point(null))), length = size * view.scaleAt(motion.point(null)), [x, y] = [motion.mesh ? 104 : 18, h - 20];
      trace(ctx, [[x, y - 5], [x, y], [x + length, y], [x + length, y - 5]]);
      ctx.lineJoin = "miter";
      stroke(ctx, Theme.surface, 4);
      stroke(ctx, ink, 1.5);
      this.write(metres(size), [x + length / 2, y - 11], ink);
    }
    if (ratio && motion.moves && !motion.swings) this.write(motion.inTime ? `t = ${clock(motion.now, motion.span)} s` : motion.timeText(motion.now), [w - 16, 24], ink, "12px", "right");
    let right = w - 18;
    for (const role of /** @type {LoadKind[]} */ (Object.keys(LOADS))) {
      const { reaction, unit } = LOADS[role], shown = reaction ? show.forces : show.loads;
      if (!(greatest[role] > 0) || !shown || motion.mesh) continue;
      const value = niceAbove(0.2 * greatest[role]), text = `${inUnits([value], unit.replace("·", " "), { digits: 2 })}${reaction ? "" : " applied"}`;
      const arc = motion.dimension === 2 && unit !== "N", length = arc ? 16 : value * this.scaleOf(role), room = Math.max(length, this.widthOf(text));
      const from = /** @type {Pixel} */ ([right - room / 2 - length / 2, h - 20]);
      if (arc) momentArc(ctx, [from[0] + 8, from[1] + 1], 8, this.sweepOf(role, value), this.colourOf(role), Theme.surface);
      else arrow(ctx, from, [length, 0], this.colourOf(role), Theme.surface, 2.4, unit === "N" ? 1 : 2);
      this.write(text, [right - room / 2, h - 37], ink);
      right -= room + 26;
    }
  }
}
