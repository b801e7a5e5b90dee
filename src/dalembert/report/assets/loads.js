// Arrows of loads in drawings: kinds, lengths and texts.

/** @import { LoadKind } from "./types.d.ts" */
/** @import { Scene } from "./scene.js" */

import { el, menu } from "./dom.js";
import { number } from "./numbers.js";
import { inUnits } from "./units.js";

/** @type {Record<LoadKind, { name: string, unit: string, reaction: boolean }>} */
export const LOADS = {
  force: { name: "Reaction forces", unit: "N", reaction: true },
  moment: { name: "Reaction moments", unit: "N·m", reaction: true },
  load: { name: "Applied forces", unit: "N", reaction: false },
  twist: { name: "Applied moments", unit: "N·m", reaction: false },
};

/** Decades by which a slider lengthens or shortens arrows. */
const DECADES = 1.5;

/** Limit of the loads of one kind that are labelled with their values. */
export const READABLE = 16;

const KINDS = /** @type {LoadKind[]} */ (Object.keys(LOADS));

export const newSizes = () => /** @type {Record<LoadKind, number>} */ (Object.fromEntries(KINDS.map((kind) => [kind, 1])));

/** @param {LoadKind} kind @param {number} value */
export const loadText = (kind, value) => inUnits([value], LOADS[kind].unit.replace("·", " "), { digits: 3 });

/** Menu with a slider for each kind of arrow of a drawing. @param {Scene} scene */
export function arrowMenu(scene) {
  const kinds = KINDS.filter((kind) => scene.greatest[kind] > 0);
  if (!kinds.length) return null;
  const rows = kinds.map((kind) => {
    const { name } = LOADS[kind], text = ` up to ${loadText(kind, scene.greatest[kind])}`;
    const slider = el("input", { type: "range", min: String(-DECADES), max: String(DECADES), step: "0.01", value: "0", id: `arrows-${kind}`, "aria-label": `Length of the arrows of ${name.toLowerCase()}`,
      oninput: () => {
        scene.sizes[kind] = 10 ** slider.valueAsNumber;
        slider.style.setProperty("--p", String((slider.valueAsNumber + DECADES) / (2 * DECADES)));
        slider.setAttribute("aria-valuetext", `${number(scene.sizes[kind], 2)} times`);
        scene.invalidate();
      } });
    slider.style.setProperty("--p", "0.5");
    return el("label", { class: "menu-row" }, el("span", {}, name, el("small", {}, text)), el("div", { class: "track short" }, slider));
  });
  return menu("Arrows", rows, { id: "arrows", title: "Lengths of the arrows" });
}
