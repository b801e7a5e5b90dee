// An element of a spatial mechanism that is dragged by its gizmo: what the picture shows, and what is written into the text.

/** @import { Space } from "./space.js" */
/** @import { Grip } from "./space_gizmo.js" */
/** @import { Choice } from "./space_targets.js" */

import { valuesAfter } from "./preview.js";
import { moved } from "./space_targets.js";

/** Show the held body where it is dragged to. @param {Space} space */
export function previewPull(space) {
  const { held, poses, selected } = space;
  if (held && poses && selected && !compute(space, held, selected) && selected.section === "bodies" && !selected.part) poses.moved.set(selected.name, held.after);
  space.refresh();
}

/** Let a live page compute the assembled position; returns whether it can. @param {Space} space @param {Grip} held @param {Choice} selected */
function compute({ still, document, boundPage }, held, selected) {
  const design = boundPage?.design;
  if (!still || !document || !boundPage || !design || design.parameters.length !== still.values.length) return false;
  try {
    const next = valuesAfter(boundPage, document, still.values, moved(still.poses, document, selected, held.before, held.after));
    if (next) design.replace(next, "drawing");
    return next !== null;
  } catch {
    return false;  // the reason is shown when it is released
  }
}

/** Write a movement into the text. @param {Space} space @param {Grip} held */
export function writePull(space, held) {
  const { document, selected } = space, computed = selected !== null && compute(space, held, selected), poses = space.poses && (space.still?.poses ?? space.poses);
  [space.held, space.pressed, space.still] = [null, null, null];
  if (poses && document && selected) {
    poses.moved.clear();
    try {
      const operations = moved(poses, document, selected, held.before, held.after), name = selected.key ?? selected.name, turns = held.handle.kind === "turn";
      if (operations.length) {
        if (!computed && selected.section === "bodies" && !selected.part) poses.moved.set(selected.name, held.after);
        space.send({ label: `${turns ? "rotate" : "move"} ${name}`, operations });
      } else if (held.value) space.actions.refuse(`${name}: this ${turns ? "rotation" : "displacement"} changes no number of the file${turns && selected.section === "joints" ? "; a joint has no direction about its own axis" : ""}`);
    } catch (error) {
      space.actions.refuse(/** @type {Error} */ (error).message);
    }
  }
  space.refresh();
}
