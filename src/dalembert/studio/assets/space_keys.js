// Keys of the spatial drawing: tools, typed values and coordinates.

/** @import { Page } from "./pictures.js" */
/** @import { Space } from "./space.js" */

import { pulled, withTyped } from "./space_gizmo.js";
import { COORDINATES, joinedPlace, typedSpacePlace } from "./space_places.js";
import { previewPull, writePull } from "./space_pull.js";
import { isRemovable, removal } from "./space_targets.js";
import { SPACE_TOOLS } from "./space_tools.js";

/** Carry out a key; returns whether it has a meaning. @param {Space} space @param {string} key */
export function answer(space, key) {
  const { held, selected, tool } = space, page = /** @type {Page} */ (space.boundPage);
  if (/^[-\d.,; ]$/.test(key) && (held ?? (tool.clicks > 0 && space.typed + key !== " "))) return type(space, key);
  if (key === "Backspace" && (held?.typed || space.typed)) return type(space, "");
  if (key === "Enter" && held) return writePull(space, held), true;
  if (key === "Enter" && space.typed) return put(space), true;
  if (key === "Escape") {
    if (held) space.revert();
    if (held || space.places.length || space.typed) [space.held, space.places, space.typed] = [null, [], ""];
    else if (tool.name === "select") space.select(null);
    else space.choose("select");
  } else if ((key === "Delete" || key === "Backspace") && selected && isRemovable(space.document ?? {}, selected)) space.send({ label: `delete ${selected.key ?? selected.name}`, operations: [removal(selected)] });
  else if (key === "h") space.palette.throughSelected();
  else if (key === "g" && tool.name === "select") space.local = !space.local;
  else if (page.scene.keys[key]) page.scene.keys[key]();
  else {
    const next = SPACE_TOOLS.find((item) => item.key === key);
    if (!next) return false;
    space.choose(next.name);
  }
  return true;
}

/** @param {Space} space @param {string} character empty to delete the last one */
function type(space, character) {
  const page = /** @type {Page} */ (space.boundPage), next = (/** @type {string} */ text) => (character ? text + character : text.slice(0, -1));
  if (space.held) {
    const typed = next(space.held.typed);
    space.held = typed ? withTyped(space.held, typed) : pulled(page, { ...space.held, typed: "" }, space.held.pixel, space.held.free);
    previewPull(space);
  } else space.typed = next(space.typed);
  return true;
}

/** A place with typed coordinates; a single number is one along the normal of the plane from the last place. @param {Space} space */
function put(space) {
  const place = typedSpacePlace(space.typed, space.palette.plane, space.places.at(-1)?.p ?? null);
  space.typed = "";
  if (place) space.add(joinedPlace(/** @type {Page} */ (space.boundPage), place));
  else space.actions.refuse(COORDINATES);
}
