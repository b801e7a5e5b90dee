// Controls of the states of a page: the state in which a model swings, and the scale of its displacements.

/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */
/** @import { Swing } from "./swing.js" */

import { el } from "./dom.js";
import { clamp } from "./numbers.js";
import { metres } from "./units.js";

/** Upper end of the scale of displacements, relative to the automatic one. */
const LARGEST = 3;

/** Labelled choice of one of several names. @param {string} id @param {string} label @param {string[]} names @param {number} chosen @param {(k: number) => void} onchange */
export function chooser(id, label, names, chosen, onchange) {
  const select = el("select", { id, onchange: () => onchange(Number(select.value)) }, names.map((name, k) => el("option", { value: String(k) }, name)));
  select.value = String(chosen);
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, label), select);
}

/** Choice of the state: load case, mode, buckling shape. @param {Motion} motion */
export function stateChooser(motion) {
  const { states: { kind, names } } = motion, label = kind === "load case" ? "Case" : kind[0]?.toUpperCase() + kind.slice(1);
  const node = chooser("case", label, names, motion.chosen, (k) => motion.choose(k)), [select] = node.querySelectorAll("select");
  select.style.maxWidth = "min(340px, 56vw)";  // names state values
  motion.onState.on(() => {
    const { states: { names: present }, chosen } = motion;
    if (select.options.length !== present.length) select.replaceChildren(...present.map((name, k) => el("option", { value: String(k) }, name)));
    present.forEach((name, k) => { select.options[k].text = name; });
    select.value = String(chosen);
  });
  return node;
}

/** Scale of the displacements, from none to three times the automatic one. @param {Motion} motion @param {() => Mesh | Swing} moving displacements of the present design */
export function scaleSlider(motion, moving) {
  const text = el("span", { class: "now", id: "factor" });
  const slider = el("input", { type: "range", min: "0", max: String(LARGEST), step: "0.01", value: "1", id: "scale", "aria-label": "Scale of the displacements", oninput: () => set(slider.valueAsNumber) });
  const set = (/** @type {number} */ factor) => {
    moving().factor = factor;
    motion.onState.emit();
  };
  const chip = (/** @type {string} */ id, /** @type {string} */ label, /** @type {string} */ title, /** @type {() => number} */ factor) =>
    el("button", { type: "button", class: "chip", id, title, onclick: () => set(factor()) }, label);
  const refresh = () => {
    const { factor, scale, relative } = moving();
    text.textContent = relative ? `up to ${metres(scale)}` : `× ${+scale.toPrecision(3)}`;
    slider.value = String(Math.min(LARGEST, factor));
    slider.style.setProperty("--p", String(clamp(factor / LARGEST, 0, 1)));
    slider.setAttribute("aria-valuetext", text.textContent);
  };
  motion.onState.on(refresh);
  refresh();
  return el("div", { class: "displacements" }, el("span", { class: "caption" }, "Displacements"), el("div", { class: "track" }, slider), text,
    !moving().relative && chip("true-scale", "1 : 1", "True scale", () => 1 / moving().automatic),
    chip("auto-scale", "auto", "Automatic scale", () => 1));
}
