// Keys of the drawing of a structure: tools, numbers that are typed, steps of what is selected.

/** @import { Page } from "./pictures.js" */
/** @import { Structure } from "./structure.js" */
/** @import { Spot } from "./structure_plan.js" */

import { gridStep, placed } from "./snapping.js";
import { moved } from "./structure_drag.js";
import { STRUCTURE_TOOLS, typedVector } from "./structure_tools.js";
import { BEGINS, TYPED, typedPlace } from "./typed_numbers.js";

/** Keys with Ctrl. @param {Structure} structure @param {string} key */
export function command(structure, key) {
  if (key !== "a" || !structure.plan) return false;
  structure.select([...structure.plan.handles.filter(({ kind }) => kind !== "radius").map(({ name }) => ({ section: "points", name })), ...structure.plan.bars.map(({ name }) => ({ section: "elements", name }))]);
  return true;
}

/** Carry out a key; returns whether it has a meaning. @param {Structure} structure @param {KeyboardEvent} event */
export function answer(structure, { key, shiftKey }) {
  const { tool } = structure, page = /** @type {Page} */ (structure.page), step = gridStep(page.scene.view.s) * (shiftKey ? 0.1 : 1);
  const way = /** @type {Record<string, Spot>} */ ({ ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] })[key];
  if (typing(structure, key)) return true;
  if (key === "Escape") {
    if (structure.drag) page.design?.replace(structure.drag.values, "drawing");
    if (structure.places.length || structure.drag) [structure.places, structure.drag, structure.target] = [[], null, null];
    else if (tool.name !== "select") structure.choose("select");
    else structure.select([]);
  } else if (key === "Enter" && tool.clicks === 0 && structure.places.length > 2) structure.finish();
  else if (key === "Enter" && tool.chain && structure.places.length) structure.places = [];
  else if ((key === "Delete" || key === "Backspace") && structure.selection.length) structure.actions.commands.do(() => structure.properties.removeSelection(), false);
  else if (way && structure.selection.length) {
    const points = new Set(structure.selection.map(({ name }) => name));
    structure.actions.commands.step((sum) => {
      const change = moved((structure.plan?.handles ?? []).filter(({ name }) => points.has(name)), sum, null);
      if (change) structure.send(change);
    }, way, false);
  } else {
    const next = STRUCTURE_TOOLS.find((item) => item.key === key);
    if (!next) return false;
    structure.choose(next.name);
  }
  return true;
}

/** Keys of numbers that are typed while drawing. @param {Structure} structure @param {string} key */
function typing(structure, key) {
  const { tool, now } = structure, from = structure.places.at(-1) ?? null, isLoad = Boolean(tool.units && from);
  if (tool.name === "select" || !structure.page) return false;
  if (key === "Enter" && structure.typed) {
    const place = isLoad ? typedTarget(structure) : typedPlace(structure.typed, from, now);
    if (place) structure.put({ ...placed(place.x, place.y), how: "typed" });
    else structure.actions.refuse(`${structure.typed}: ${isLoad ? "type a value 5 kN, with an angle 5 kN<-90, or components 0, -5000" : "type a length 0.3, a length and an angle 0.3<45, or coordinates 0.1,0.2"}`);
  } else if (key === "Backspace" && structure.typed) structure.typed = structure.typed.slice(0, -1);
  else if (key === "Escape" && structure.typed) structure.typed = "";
  else if (structure.typed ? TYPED.test(key) : BEGINS.test(key)) structure.typed += key;
  else return false;
  const place = structure.typed && !isLoad ? typedPlace(structure.typed, from, now) : null;
  if (place) structure.now = { ...placed(place.x, place.y), how: "typed" };
  return true;
}

/** Place toward which a typed load points. @param {Structure} structure */
function typedTarget(structure) {
  const { tool, places: [from], now, target } = structure;
  if (!from) return null;
  const toward = now ?? from, way = /** @type {Spot} */ ([toward.x - from.x, toward.y - from.y]);
  return tool.units && typedVector(structure.typed, tool.units(target).units, way) ? { x: toward.x, y: toward.y } : null;
}
