// Diagrams of section forces along lines.

/** @import { Pixel } from "./scene_types.d.ts" */
/** @import { Marks } from "./marks.js" */
/** @import { Mesh } from "./mesh.js" */

import { stroke, trace } from "./canvas.js";
import { Theme, mix } from "./theme.js";
import { quantity } from "./units.js";

/** Largest ordinate, relative to the structure. */
const HEIGHT = 0.1;
/** Limit of the lines with values. */
const FEW_LINES = 40;

/** Draw the chosen diagram of a mesh over its lines, with the values at their ends. @param {Marks} marks @param {Mesh} mesh */
export function drawDiagram(marks, mesh) {
  const { paper: { ctx }, scene } = marks, ordinates = mesh.ordinates();
  const largest = Math.max(0, ...ordinates.flatMap(({ values }) => values.map((v) => Math.abs(v) || 0))), scale = (HEIGHT * scene.size) / (largest || 1);
  const colour = Theme.moment;
  /** @type {Pixel[]} */
  const written = [];
  for (const { vertices, values, unit, across } of ordinates) {
    const ends = vertices.map((vertex) => mesh.placeOf(vertex, 3)), feet = ends.map((p) => scene.screen(p));
    const tips = ends.map((p, k) => scene.screen(/** @type {typeof p} */ (p.map((v, axis) => v + scale * values[k] * across[axis]))));
    const ring = /** @type {Pixel[]} */ ([feet[0], ...tips, feet[1]].filter((p) => p !== null));
    if (ring.length < 4 || values.some(Number.isNaN)) continue;
    trace(ctx, ring, true);
    ctx.globalAlpha = 0.22;
    ctx.fillStyle = colour;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.lineJoin = "round";
    stroke(ctx, mix(colour, Theme.surface, 0.15), 1.2);
    if (ordinates.length > FEW_LINES) continue;
    const constant = Math.abs(values[0] - values[1]) < 1e-6 * largest;
    for (const k of constant ? [0] : [0, 1]) {
      const [x, y] = constant ? [0, 1].map((axis) => (ring[1][axis] + ring[2][axis]) / 2) : ring[k + 1], [fx, fy] = constant ? [0, 1].map((axis) => (ring[0][axis] + ring[3][axis]) / 2) : ring[k ? 3 : 0];
      const text = quantity(values[k], unit, 3), font = "600 11.5px", half = marks.widthOf(text, font) / 2, away = Math.hypot(x - fx, y - fy) || 1;
      const at = /** @type {Pixel} */ ([marks.freeAt(x + ((half + 4) * (x - fx)) / away, y, half), y + (11 * (y - fy)) / away]);
      if (Math.abs(values[k]) < 1e-6 * largest || written.some((p) => Math.abs(p[0] - at[0]) < 1.6 * half && Math.abs(p[1] - at[1]) < 13)) continue;
      written.push(at);
      marks.write(text, at, colour, font);
    }
  }
}
