// What the drawing of a structure shows over its picture: handles, parts that are not pictured yet, places, a readout.

/** @import { Structure } from "./structure.js" */
/** @import { Spot } from "./structure_plan.js" */

import { readout } from "./overlay.js";
import { loopsNow, shifted } from "./structure_drag.js";
import { circle } from "./structure_plan.js";

/** Upper limit of free nodes whose names are shown. */
const NAMED = 6;

/** @param {CanvasRenderingContext2D} ctx @param {Structure} structure */
export function drawStructure(ctx, structure) {
  const { page, plan, tool, places, now, drag, selection } = structure;
  if (!page || !plan) return;
  const style = getComputedStyle(document.documentElement), colour = (/** @type {string} */ name) => style.getPropertyValue(name).trim(), { view } = page.scene;
  const screen = (/** @type {Spot} */ p) => /** @type {[number, number]} */ (view.screen(p));
  const path = (/** @type {Spot[]} */ spots, closed = false) => {
    ctx.beginPath();
    for (const spot of spots) ctx.lineTo(...screen(spot));
    if (closed) ctx.closePath();
    ctx.stroke();
  };
  const mark = (/** @type {Spot} */ p, /** @type {number} */ r, /** @type {string} */ fill = "") => {
    ctx.beginPath();
    ctx.arc(...screen(p), r, 0, 2 * Math.PI);
    if (fill) {
      ctx.fillStyle = fill;
      ctx.fill();
    }
    ctx.stroke();
  };
  ctx.save();
  [ctx.font, ctx.textAlign, ctx.textBaseline] = ["12px system-ui, sans-serif", "left", "alphabetic"];
  const pictured = new Set([...(page.motion.mesh?.elements ?? []), ...Object.keys(structure.picturedMeshes ?? {})]);
  const spotOf = (/** @type {Spot} */ p) => shifted(structure, p);
  [ctx.strokeStyle, ctx.lineWidth] = [colour("--muted"), 2];
  for (const { name, ends } of plan.bars) if (drag?.moved || !pictured.has(name)) path(ends.map(spotOf));
  for (const { name, loops } of plan.regions) if (drag?.moved || !pictured.has(name)) for (const loop of loopsNow(structure, loops)) path(loop, true);
  [ctx.strokeStyle, ctx.lineWidth] = [colour("--accent"), 4];
  ctx.globalAlpha = 0.55;
  for (const { section, name } of selection) {
    if (section === "elements") for (const bar of plan.bars) if (bar.name === name) path(bar.ends.map(spotOf));
    if (section === "meshes") for (const region of plan.regions) if (region.name === name) for (const loop of loopsNow(structure, region.loops)) path(loop, true);
    if (section === "edges" && structure.target) path(structure.target.spots);
  }
  ctx.globalAlpha = 1;
  [ctx.strokeStyle, ctx.lineWidth] = [colour("--accent"), 1.6];
  for (const { name, kind, at } of plan.handles) {
    const chosen = selection.some((one) => one.name === name), p = spotOf(at);
    if (kind === "node") mark(p, chosen ? 6 : 4.5, chosen ? colour("--accent") : colour("--surface"));
    else {
      const [x, y] = screen(p), r = chosen ? 5 : 4;
      ctx.fillStyle = chosen ? colour("--accent") : colour("--surface");
      ctx.fillRect(x - r, y - r, 2 * r, 2 * r);
      ctx.strokeRect(x - r, y - r, 2 * r, 2 * r);
    }
  }
  drawMoving(ctx, structure, screen, colour);
  if (structure.tip && tool.name === "select") {
    const [x, y] = structure.tip.pixel;
    ctx.beginPath();
    ctx.arc(x, y, 7, 0, 2 * Math.PI);
    ctx.stroke();
  }
  if (structure.hover && tool.target && !places.length) {
    [ctx.lineWidth, ctx.globalAlpha] = [5, 0.4];
    if (structure.hover.spots.length > 1) path(structure.hover.spots);
    else mark(structure.hover.spots[0], 9);
    [ctx.lineWidth, ctx.globalAlpha] = [1.6, 1];
  }
  ctx.setLineDash([6, 4]);
  ctx.lineWidth = 2;
  const chain = now && places.length ? [...places, now] : places, spots = chain.map(({ x, y }) => /** @type {Spot} */ ([x, y]));
  if (tool.name === "round" && spots.length === 2) path(circle(spots[0], Math.hypot(spots[1][0] - spots[0][0], spots[1][1] - spots[0][1])), true);
  else if (spots.length > 1) path(spots);
  if (drag?.kind === "box") {
    const { from: p, to: q } = drag;
    path([[p.x, p.y], [q.x, p.y], [q.x, q.y], [p.x, q.y]], true);
  }
  ctx.lineWidth = 1;
  const last = drag && drag.kind !== "box" ? (drag.moved ? drag.to : null) : tool.name === "select" ? null : now;
  for (const guide of last?.guides ?? []) path(guide.map(({ x, y }) => /** @type {Spot} */ ([x, y])));
  ctx.setLineDash([]);
  if (last) {
    mark([last.x, last.y], last.names.length ? 8 : 4);
    readout(ctx, screen([last.x, last.y]), structure.readout(last), colour);
  }
  ctx.restore();
}

/** Nodes that move without strain. @param {CanvasRenderingContext2D} ctx @param {Structure} structure @param {(p: Spot) => [number, number]} screen @param {(name: string) => string} colour */
function drawMoving(ctx, { page, moving }, screen, colour) {
  const mesh = page?.motion.mesh;
  if (!mesh || !moving.length) return;
  [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth] = [colour("--error"), colour("--error"), 2];
  moving.forEach((name) => {
    const k = mesh.nodes.indexOf(name);
    if (k < 0) return;
    const [x, y] = screen([mesh.rest[3 * k], mesh.rest[3 * k + 1]]);
    ctx.beginPath();
    ctx.arc(x, y, 9, 0, 2 * Math.PI);
    ctx.stroke();
    if (moving.length > NAMED) return;
    const text = `${name} moves freely`, fits = x + 16 + ctx.measureText(text).width < ctx.canvas.clientWidth;
    ctx.textAlign = fits ? "left" : "right";
    ctx.fillText(text, fits ? x + 13 : x - 13, y + 17);
  });
  [ctx.strokeStyle, ctx.lineWidth] = [colour("--accent"), 1.6];
}
