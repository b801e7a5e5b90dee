// Names of bodies and joints in space.

/** @import { Label, Part, Pixel, Point } from "./scene_types.d.ts" */
/** @import { SpatialMotion } from "./spatial_motion.js" */
/** @import { SpatialPainter } from "./spatial_painter.js" */

import { clamp } from "./numbers.js";
import { Theme, mix } from "./theme.js";

/** Names at the middles of bodies and beside joints, the nearest first. @param {SpatialPainter} painter @returns {Label[]} */
export function spatialLabels({ motion, unit, view }) {
  const short = motion.joints.filter(({ at, name }) => !at && name && name.length <= 3);
  const items = [
    ...motion.bodies.filter(({ label }) => label).map((body) => ({ text: body.label, font: "600 12px", place: motion.at(body, middleOf(motion, body)), colour: mix(Theme.colour(body.index), Theme.ink, 0.35), owner: body })),
    ...(short.length > 24 ? [] : short).map((joint) => ({ text: joint.name, font: "italic 12px", place: motion.placeOf(joint), colour: Theme.muted, owner: joint })),
  ];
  return items.map(({ place, ...label }) => {
    const p = place && view.screen(place);
    if (!p) return null;
    const r = clamp(2.4 * unit * view.scaleAt(place), 6, 40), wide = 4 * label.text.length;
    const offsets = label.font[0] === "i" ? [[-r - wide, -r], [r + wide, -r], [-r - wide, r], [r + wide, r]] : [[0, -r - 8], [0, r + 8], [r + wide, 0], [-r - wide, 0]];
    return { ...label, places: offsets.map(([dx, dy]) => /** @type {Pixel} */ ([p[0] + dx, p[1] + dy])), required: false, depth: -view.seen(place).z };
  }).filter((label) => label !== null).sort((a, b) => b.font.length - a.font.length || a.depth - b.depth);
}

/** Mean of the outline of a body. @param {SpatialMotion} motion @param {Part} body @returns {Point} */
function middleOf(motion, { shapes }) {
  const points = shapes.flatMap((shape) => motion.outline(shape));
  return motion.point([0, 1, 2].map((k) => points.reduce((sum, p) => sum + (p[k] ?? 0), 0) / (points.length || 1)));
}
