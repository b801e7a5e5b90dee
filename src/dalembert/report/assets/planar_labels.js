// Names of bodies and joints in the plane.

/** @import { Label, Part, Pixel } from "./scene_types.d.ts" */
/** @import { PlanarPainter } from "./planar_painter.js" */
/** @import { PlanarPose } from "./planar_motion.js" */

import { extent } from "./numbers.js";
import { inShape } from "./planar_hits.js";
import { local } from "./planar_motion.js";
import { Theme } from "./theme.js";

/** @param {number[]} values */
export const mean = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;

/** Labels of joints, at their corners on the fewest bodies, and of bodies. @param {PlanarPainter} painter @returns {Label[]} */
export function planarLabels(painter) {
  const { ctx, half, motion, view } = painter, bodies = [...painter.poses].filter(([, pose]) => pose !== null);
  const covered = (/** @type {Pixel} */ pixel) => bodies.filter(([body, pose]) => pose && body.shapes.some((shape) => inShape(shape, local(pose, view.world(pixel)), (half + 4) / view.s))).length;
  const short = motion.joints.filter(({ at, name }) => !at && name && name.length <= 3), [dx, dy] = [1.1 * half + 7, 0.9 * half + 5];
  const joints = (short.length > 24 ? [] : short).map((joint) => {
    const p = painter.place(joint);
    if (!p) return null;
    const places = /** @type {Pixel[]} */ ([[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([u, v]) => [p[0] + u * dx, p[1] + v * dy])), costs = places.map(covered), least = Math.min(...costs);
    return { text: joint.name, font: "italic 12px", colour: Theme.muted, places: [...places.filter((_, k) => costs[k] === least), ...places], required: true, owner: joint };
  });
  const names = motion.bodies.map((body) => {
    const pose = painter.poses.get(body), font = "600 12px";
    if (!pose || !body.label) return null;
    ctx.font = `${font} ${Theme.font}`;
    return { text: body.label, font, colour: painter.looks[body.index].text, places: labelPlaces(painter, body, pose, ctx.measureText(body.label).width / 2), required: true, owner: body };
  });
  return [...joints, ...names].filter((label) => label !== null);
}

/** Positions of the name of a body, best first: beside a bar, in a plate, about other shapes. @param {PlanarPainter} painter @param {Part} body @param {PlanarPose} pose @param {number} wide @returns {Pixel[]} */
function labelPlaces({ half, motion, view }, { shapes }, pose, wide) {
  const seen = (/** @type {any} */ p) => view.screen(motion.placed(pose, p));
  if (shapes.length === 1 && shapes[0].kind === "bar") {
    const [a, b] = [seen(shapes[0].from), seen(shapes[0].to)], length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const [nx, ny] = [(b[1] - a[1]) / length, -(b[0] - a[0]) / length], gap = half + 11 + (wide - 6) * Math.abs(nx);
    return [gap, -gap].flatMap((d) => [0.5, 0.33, 0.67].map((k) => /** @type {Pixel} */ ([a[0] + k * (b[0] - a[0]) + d * nx, a[1] + k * (b[1] - a[1]) + d * ny])));
  }
  const points = (shapes.length ? shapes.flatMap((shape) => motion.outline(shape)) : [[0, 0]]).map(seen), columns = [0, 1].map((k) => points.map((p) => p[k]));
  const [[x0, x1], [y0, y1]] = columns.map((column) => extent([column]) ?? [0, 0]), [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2], plates = shapes.some(({ kind }) => kind === "polygon");
  const pad = 12 + (!shapes.length || shapes.some(({ kind }) => ["polygon", "bar", "particle"].includes(kind)) ? half : 0);
  /** @type {Pixel[]} */
  const around = [[x, y0 - pad], [x, y1 + pad], [x1 + pad + wide - 4, y], [x0 - pad - wide + 4, y]];
  return plates && Math.min(x1 - x0, y1 - y0) > 2 * wide ? [[mean(columns[0]), mean(columns[1])], ...around] : around;
}
