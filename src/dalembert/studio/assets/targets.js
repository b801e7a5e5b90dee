// Targets of a synthesis: points and poses that are clicked, drawn on the picture.

/** @import { Change } from "./operations.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Tool } from "./tools.js" */
/** @import { Document } from "./types.d.ts" */

/** Length of the arm of a pose [pixels]. */
export const ARM = 26;

/** Keys of [synthesis]. @param {Document | null} document @returns {Record<string, any>} */
export const synthesisOf = (document) => document?.synthesis ?? {};

/** @param {string} label @param {Record<string, unknown>} fields @returns {Change} */
const change = (label, fields) => ({ label, operations: [{ op: "section", section: "synthesis", fields }] });

/** Numbers without the noise of pixels. @param {number} value */
const short = (value) => Number(value.toPrecision(6));

/** A further point of a path; a former motion or function becomes a path. @param {Place} place @param {Document | null} document */
export function addPoint(place, document) {
  const table = synthesisOf(document), points = table.type === "path" ? table.points ?? [] : [];
  return change("add target point", { type: "path", coupler_angles: null, outputs: null, ...(table.type === "function" ? { crank_angles: null } : {}), points: [...points, [short(place.x), short(place.y)]] });
}

/** A further pose: position and direction. @param {Place} place @param {Place} toward @param {Document | null} document */
export function addPose(place, toward, document) {
  const table = synthesisOf(document), has = table.type === "motion", points = has ? table.points ?? [] : [], angles = has ? table.coupler_angles ?? [] : [];
  let angle = Math.atan2(toward.y - place.y, toward.x - place.x);
  const last = angles.at(-1);
  if (typeof last === "number") angle += 2 * Math.PI * Math.round((last - angle) / (2 * Math.PI));
  return change("add pose", { type: "motion", outputs: null, ...(table.type === "function" ? { crank_angles: null } : {}), points: [...points, [short(place.x), short(place.y)]], coupler_angles: [...angles, short(angle)] });
}

/** @type {Tool[]} */
export const TARGET_TOOLS = [
  { name: "target", key: "T", group: "Targets", title: "Target", hint: ["click the points of the path one after the other; the sheet Synthesis lists them"], clicks: 1, make: ([place], { document }) => addPoint(place, document) },
  { name: "pose", key: "P", group: "Targets", title: "Pose", hint: ["click a position of the coupler", "click its direction"], clicks: 2, make: ([place, toward], { document }) => addPose(place, toward, document) },
];

/** Draw the targets over a picture. @param {CanvasRenderingContext2D} ctx @param {Page} page @param {Document | null} document @param {string} colour @param {number} marked number of the entry under the pointer in the list; -1 for none */
export function drawTargets(ctx, page, document, colour, marked) {
  const { type, points = [], coupler_angles: angles = [], closed } = synthesisOf(document);
  if (!type || type === "function" || !Array.isArray(points)) return;
  const places = points.filter((point) => Array.isArray(point) && point.every(Number.isFinite)).map((point) => page.scene.view.screen(point));
  ctx.save();
  [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth, ctx.font] = [colour, colour, 1.4, "11px system-ui, sans-serif"];
  ctx.setLineDash([3, 4]);
  ctx.beginPath();
  for (const [x, y] of closed && places.length > 2 ? [...places, places[0]] : places) ctx.lineTo(x, y);
  ctx.stroke();
  ctx.setLineDash([]);
  places.forEach(([x, y], k) => {
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
  });
  ctx.restore();
}
