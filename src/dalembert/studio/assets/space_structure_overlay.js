// What the drawing of a spatial structure shows over its picture.

/** @import { SpaceStructure } from "./space_structure.js" */

import { drawGizmo, gripText } from "./space_gizmo.js";
import { stepAt } from "./space_places.js";
import { Sketch } from "./space_sketch.js";

/** Units in which the usual values of tools are shown. @type {Record<string, string>} */
const UNITS = { heat: "K", torque: "N m", displacement: "mm" };

/** Draw what is being drawn, selected or moved. @param {CanvasRenderingContext2D} ctx @param {SpaceStructure} structure */
export function drawSpaceStructure(ctx, structure) {
  const { boundPage: page, plan, tool, now, places, hover, held, selection, pose } = structure;
  if (!page || !plan) return;
  if (tool.name !== "select" || held || structure.handle) page.scene.pointer = null;  // no tip over what is drawn
  ctx.save();
  const sketch = new Sketch(ctx, page), pictured = new Set(page.motion.mesh?.elements ?? []);
  for (const { name, ends } of plan.bars) if (!pictured.has(name)) sketch.line(ends);
  for (const { name, at } of plan.handles) {
    const chosen = selection.some((part) => part.section === "points" && part.name === name);
    if (tool.name !== "select" || chosen) sketch.mark(at, chosen ? 6 : 3.5, chosen);
    else sketch.mark(at, 2.5);
  }
  [ctx.lineWidth, ctx.globalAlpha] = [5, 0.45];
  for (const { section, name } of selection) if (section === "elements") for (const bar of plan.bars) if (bar.name === name) sketch.line(bar.ends);
  if (hover) hover.spots.length > 1 ? sketch.line(hover.spots) : sketch.mark(hover.spots[0], 9);
  [ctx.lineWidth, ctx.globalAlpha] = [2, 1];
  if (tool.name !== "select") {
    const focus = places.at(-1)?.p ?? now?.p, first = !tool.target || places.length > 0;
    if (focus && first && !tool.scalar) sketch.grid(structure.palette.plane, now?.p ?? focus, stepAt(page, focus));
    ctx.setLineDash([6, 4]);
    if (now && places.length && !tool.scalar) sketch.line([places[places.length - 1].p, now.p]);
    ctx.setLineDash([]);
    if (now && first) {
      sketch.mark(now.p, now.names.length ? 8 : 4);
      const usual = tool.units?.(structure.target), unit = UNITS[tool.name] ?? (structure.target?.kind === "element" ? "N/m" : "N"), size = (usual?.size ?? 1) * (unit === "mm" ? 1e3 : 1);
      sketch.text(now.p, structure.typed ? `${structure.typed}▏` : usual ? `${size} ${unit}; or type a value` : `${now.how} (${now.p.map((v) => Number(v.toPrecision(4))).join(", ")})`);
    } else if (hover) sketch.text(hover.spots[0], hover.name);
  } else if (pose) {
    const shown = held?.after ?? pose;
    if (held) sketch.line([held.before.p, shown.p]);
    drawGizmo(ctx, page, shown, held ? [held.handle] : structure.handles, held?.handle ?? structure.handle, Boolean(held));
    if (held) sketch.text(shown.p, gripText(held));
  }
  ctx.restore();
}
