// What the drawing shows over the picture: selection, guides, clicked places and a readout at the pointer.

/** @import { Drawing } from "./drawing.js" */

import { controlPoints } from "./controls.js";
import { otherEnd } from "./operations.js";
import { bounds } from "./selection.js";
import { elementPlaces, namedPlaces } from "./snapping.js";

/** @typedef {{ x: number, y: number }} Spot */

/** Width beyond which the readout is wrapped [px]. */
const WIDEST = 280;

/** Number with four digits. @param {number} value */
export const short = (value) => String(Number(value.toPrecision(4)));

/** Length and angle of a line. @param {Spot} from @param {Spot} to */
export const measured = (from, to) => `${short(Math.hypot(to.x - from.x, to.y - from.y))} m < ${short((Math.atan2(to.y - from.y, to.x - from.x) * 180) / Math.PI)}°`;

/** @param {CanvasRenderingContext2D} ctx @param {Drawing} drawing */
export function drawOverlay(ctx, drawing) {
  const { page, drag, places, now, tool } = drawing;
  if (!page) return;
  if (tool.name !== "select" || drag?.moved) page.scene.pointer = null;  // no tip over what is drawn
  const style = getComputedStyle(document.documentElement), colour = (/** @type {string} */ name) => style.getPropertyValue(name).trim(), { view } = page.scene;
  const screen = (/** @type {Spot} */ { x, y }) => /** @type {[number, number]} */ (view.screen([x, y]));
  const mark = (/** @type {Spot} */ place, /** @type {number} */ radius) => {
    ctx.beginPath();
    ctx.arc(...screen(place), radius, 0, 2 * Math.PI);
    ctx.stroke();
  };
  const line = (/** @type {Spot[]} */ spots, closed = false) => {
    ctx.beginPath();
    for (const spot of spots) ctx.lineTo(...screen(spot));
    if (closed) ctx.closePath();
    ctx.stroke();
  };
  ctx.save();
  [ctx.strokeStyle, ctx.lineWidth, ctx.font] = [colour("--accent"), 2, "12px system-ui, sans-serif"];
  for (const { name, places: corners } of elementPlaces(page)) {
    if (!drawing.selection.has(name)) continue;
    for (const [x, y] of corners) mark({ x, y }, 6);
  }
  if (tool.name !== "select") for (const place of namedPlaces(page)) mark(place, 4);
  for (const { x, y } of drawing.document && tool.name === "select" ? controlPoints(page, drawing.document, drawing.selected) : []) {
    const [u, v] = screen({ x, y });
    ctx.strokeRect(u - 4, v - 4, 8, 8);
  }
  ctx.setLineDash([6, 4]);
  const box = drawing.selection.size > 1 && tool.name === "select" && bounds(page, drawing.selection);
  if (box) {
    const pad = 12 / view.s;
    line([{ x: box.x0 - pad, y: box.y0 - pad }, { x: box.x1 + pad, y: box.y0 - pad }, { x: box.x1 + pad, y: box.y1 + pad }, { x: box.x0 - pad, y: box.y1 + pad }], true);
  }
  line(!now || !drawing.from ? places : tool.fromFirst ? [drawing.from, now] : [...places, now]);
  for (const place of places) mark(place, 3);
  if (drag?.kind === "box") {
    const { from: p, to: q } = drag;
    line([p, { x: q.x, y: p.y }, q, { x: p.x, y: q.y }], true);
  }
  if (drag?.kind === "point" && drag.moved) for (const name of drag.from.names) {
    const [body, point] = name.split("."), other = drawing.document?.bodies?.[body]?.type === "Bar" && otherEnd(page, body, point);
    if (other) line([other, drag.to]);
  }
  const last = drag && drag.kind !== "box" ? drag.moved ? drag.to : null : tool.name === "select" ? null : now;
  ctx.lineWidth = 1;
  for (const guide of last?.guides ?? []) line(guide);
  ctx.setLineDash([]);
  ctx.lineWidth = 2;
  if (last) {
    mark(last, last.names.length ? 8 : 4);
    const from = drawing.from ?? (drag?.kind === "body" ? drag.from : null);
    readout(ctx, screen(last), [drawing.typed ? `${drawing.typed}▏` : from ? measured(from, last) : `${short(last.x)}, ${short(last.y)} m`, last.how, drawing.status], colour);
  }
  ctx.restore();
}

/** Lines of text in a box beside the pointer. @param {CanvasRenderingContext2D} ctx @param {[number, number]} at @param {string[]} lines @param {(name: string) => string} colour */
export function readout(ctx, [x, y], lines, colour) {
  const rows = lines.filter(Boolean).flatMap((line) => wrapped(ctx, line)), width = Math.max(...rows.map((row) => ctx.measureText(row).width)) + 16, height = 17 * rows.length + 8;
  const left = x + 18 + width > ctx.canvas.clientWidth ? Math.max(4, x - 14 - width) : x + 14, top = Math.max(4, y - 14 - height);
  ctx.beginPath();
  ctx.roundRect(left, top, width, height, 6);
  ctx.globalAlpha = 0.92;
  ctx.fillStyle = colour("--surface");
  ctx.fill();
  ctx.globalAlpha = 1;
  [ctx.strokeStyle, ctx.lineWidth, ctx.textAlign, ctx.textBaseline] = [colour("--line"), 1, "left", "alphabetic"];
  ctx.stroke();
  rows.forEach((row, k) => {
    ctx.fillStyle = colour(k ? "--muted" : "--ink");
    ctx.fillText(row, left + 8, top + 17 * (k + 1));
  });
}

/** Rows of a line of text. @param {CanvasRenderingContext2D} ctx @param {string} line */
function wrapped(ctx, line) {
  const rows = [""], most = Math.min(WIDEST, ctx.canvas.clientWidth - 40);
  for (const word of line.split(" ")) {
    const longer = [rows.at(-1), word].filter(Boolean).join(" ");
    if (rows.at(-1) && ctx.measureText(longer).width > most) rows.push(word);
    else rows[rows.length - 1] = longer;
  }
  return rows;
}
