// What the spatial drawing shows over its picture.

/** @import { Space } from "./space.js" */

import { drawGizmo, gripText } from "./space_gizmo.js";
import { namedPoints, stepAt } from "./space_places.js";
import { Sketch } from "./space_sketch.js";
import { poseOf } from "./space_targets.js";

/** Length of the axes of frames [px]. */
const TRIAD = 30;

/** Draw what is being drawn or moved. @param {Space} space @param {CanvasRenderingContext2D} ctx */
export function drawOver(space, ctx) {
  const page = space.boundPage, { document, poses, tool, now } = space;
  if (!page || !poses || !document || !space.possible || !space.resting) return;
  if (tool.name !== "select" || space.held || space.hover) page.scene.pointer = null;  // no tip over what is drawn
  ctx.save();
  const sketch = new Sketch(ctx, page);
  triads(space, sketch);
  if (tool.name !== "select") {
    for (const { p } of namedPoints(page)) sketch.mark(p, 3.5);
    const focus = space.places.at(-1)?.p ?? now?.p;
    if (focus && tool.name !== "motor") sketch.grid(space.palette.plane, now?.p ?? focus, stepAt(page, focus));
    const chain = now && space.places.length ? [...space.places, now] : space.places;
    ctx.setLineDash([6, 4]);
    for (const line of chain.length > 1 ? tool.sketch?.(chain, space.setting) ?? [chain.map(({ p }) => p)] : []) sketch.line(line);
    ctx.setLineDash([]);
    if (now) {
      sketch.mark(now.p, now.names.length ? 8 : 4);
      sketch.text(now.p, `${now.how} (${now.p.map((v) => Number(v.toPrecision(4))).join(", ")})`);
    }
  } else if (space.pose && space.selected) {
    const pose = space.held?.after ?? space.pose;
    if (space.held) sketch.line([space.held.before.p, pose.p]);
    drawGizmo(ctx, page, pose, space.held ? [space.held.handle] : space.handles, space.held?.handle ?? space.hover, Boolean(space.held));
    if (space.held) sketch.text(pose.p, gripText(space.held));
  }
  ctx.restore();
}

/** Axes of named frames. @param {Space} space @param {Sketch} sketch */
function triads(space, sketch) {
  const { document, poses } = space;
  if (!document || !poses || (space.tool.name === "select" && !space.selected)) return;
  const owners = /** @type {[string, string, any][]} */ ([["ground", "ground", document.ground], ...Object.entries(document.bodies ?? {}).map(([name, entry]) => ["bodies", name, entry])]);
  for (const [section, name, entry] of owners) for (const key of Object.keys(entry?.frames ?? {})) {
    const pose = space.hidden.has(name) ? null : poseOf(poses, document, { section, name, part: "frames", key });
    if (pose) sketch.triad(pose, TRIAD);
  }
}
