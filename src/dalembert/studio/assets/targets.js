// Targets of a synthesis: points and poses that are clicked, drawn on the picture.

/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Tool } from "./tools.js" */
/** @import { Document } from "./types.d.ts" */

import { addedPoint, addedPose, synthesisOf, targetOf } from "./target_edits.js";

/** Length of the arm of a pose [pixels]. */
export const ARM = 26;

/** A further pose at a place in the direction of another one. @param {Place} place @param {Place} toward @param {Document | null} document */
const pose = (place, toward, document) => addedPose(document, [place.x, place.y], Math.atan2(toward.y - place.y, toward.x - place.x));

/** @type {Tool[]} */
export const TARGET_TOOLS = [
  { name: "target", key: "T", group: "Targets", title: "Target", hint: ["click the points of the path one after the other; the sheet Synthesis lists them"], clicks: 1, make: ([place], { document }) => ({ label: "add target point", operations: addedPoint(document, [place.x, place.y]) }) },
  { name: "pose", key: "P", group: "Targets", title: "Pose", hint: ["click a position of the coupler", "click its direction"], clicks: 2, make: ([place, toward], { document }) => ({ label: "add pose", operations: pose(place, toward, document) }) },
];

/** Draw the targets over a picture. @param {CanvasRenderingContext2D} ctx @param {Page} page @param {Document | null} document @param {string} colour @param {number} marked number of the entry under the pointer in the list; -1 for none */
export function drawTargets(ctx, page, document, colour, marked) {
  const { type, points, angles, closed } = targetOf(document);
  if (!synthesisOf(document).type || type === "function") return;
  const spots = points.flatMap((point, k) => (point.every(Number.isFinite) ? [{ k, at: page.scene.view.screen(point) }] : [])), places = spots.map(({ at }) => at);
  ctx.save();
  [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth, ctx.font] = [colour, colour, 1.4, "11px system-ui, sans-serif"];
  ctx.setLineDash([3, 4]);
  ctx.beginPath();
  for (const [x, y] of closed && places.length > 2 ? [...places, places[0]] : places) ctx.lineTo(x, y);
  ctx.stroke();
  ctx.setLineDash([]);
  for (const { k, at: [x, y] } of spots) {
    ctx.beginPath();
    ctx.arc(x, y, k === marked ? 8 : 4.5, 0, 2 * Math.PI);
    ctx.lineWidth = 2;
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(x, y, 1.4, 0, 2 * Math.PI);
    ctx.fill();
    if (type === "motion" && Number.isFinite(angles[k])) {
      const [u, v] = [Math.cos(angles[k]) * ARM, -Math.sin(angles[k]) * ARM];
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.lineTo(x + u, y + v);
      ctx.moveTo(x + u, y + v);
      ctx.lineTo(x + 0.72 * u - 0.18 * v, y + 0.72 * v + 0.18 * u);
      ctx.moveTo(x + u, y + v);
      ctx.lineTo(x + 0.72 * u + 0.18 * v, y + 0.72 * v - 0.18 * u);
      ctx.stroke();
    }
    if (places.length <= 40) ctx.fillText(String(k + 1), x + 7, y - 7);
  }
  ctx.restore();
}
