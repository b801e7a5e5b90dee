// Keys of the drawing of a spatial structure: tools, typed coordinates and values.

/** @import { SpaceStructure } from "./space_structure.js" */

import { pulled, withTyped } from "./space_gizmo.js";
import { COORDINATES, spacePlaced, typedSpacePlace } from "./space_places.js";
import { SPACE_STRUCTURE_TOOLS } from "./space_structure_tools.js";
import { BEGINS, TYPED } from "./typed_numbers.js";

/** Keys with Ctrl. @param {SpaceStructure} structure @param {string} key */
export function command(structure, key) {
  const { plan, document } = structure;
  if (key !== "a" || !plan) return false;
  structure.select([...[...plan.nodes.keys()].map((name) => ({ section: "points", name })), ...Object.keys(document?.elements ?? {}).map((name) => ({ section: "elements", name }))]);
  return true;
}

/** Carry out a key; returns whether it has a meaning. @param {SpaceStructure} structure @param {string} key */
export function answer(structure, key) {
  const { held, tool, boundPage: page } = structure;
  if (held) return whileHeld(structure, key);
  if (typing(structure, key)) return true;
  if (key === "Escape") {
    if (structure.places.length) [structure.places, structure.target] = [[], null];
    else if (tool.name === "select") structure.select([]);
    else structure.choose("select");
  } else if (key === "Enter" && tool.chain && structure.places.length) structure.places = [];
  else if ((key === "Delete" || key === "Backspace") && structure.selection.length) structure.actions.commands.do(() => structure.properties.removeSelection(), false);
  else if (key === "h") structure.palette.choice.throughSelected();
  else if (page?.scene.keys[key]) page.scene.keys[key]();
  else {
    const next = SPACE_STRUCTURE_TOOLS.find((item) => item.key === key);
    if (!next) return false;
    structure.choose(next.name);
  }
  return true;
}

/** @param {SpaceStructure} structure @param {string} key */
function whileHeld(structure, key) {
  const { held, boundPage: page } = structure;
  if (!held || !page) return false;
  if (key === "Enter") structure.release(held);
  else if (key === "Escape") structure.revert();
  else if (/^[-\d.]$/.test(key) || (key === "Backspace" && held.typed)) {
    const typed = key === "Backspace" ? held.typed.slice(0, -1) : held.typed + key;
    structure.held = typed ? withTyped(held, typed) : pulled(page, { ...held, typed: "" }, held.pixel, held.free);
    structure.preview();
  } else return false;
  return true;
}

/** Keys of coordinates and values. @param {SpaceStructure} structure @param {string} key */
function typing(structure, key) {
  const { tool, typed } = structure;
  if (tool.clicks < 1) return false;
  if (key === "Enter" && typed) place(structure);
  else if (key === "Backspace" && typed) structure.typed = typed.slice(0, -1);
  else if (key === "Escape" && typed) structure.typed = "";
  else if (typed ? TYPED.test(key) : BEGINS.test(key)) structure.typed += key;
  else return false;
  return true;
}

/** A place with typed coordinates, or the value of a load. @param {SpaceStructure} structure */
function place(structure) {
  const { tool, typed, now, places } = structure, last = places.at(-1)?.p ?? null;
  if (tool.units && last) return structure.put(now ? { ...now } : spacePlaced(last));
  const next = typedSpacePlace(typed, structure.palette.plane, last);
  if (next) structure.put(next);
  else structure.actions.refuse(COORDINATES);
  structure.typed = "";
}
