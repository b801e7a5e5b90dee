// Controls of the drawing of a structure: state, field with its colours, scale of the displacements.

/** @import { Child } from "./types.d.ts" */
/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */
/** @import { Scene } from "./scene.js" */

import { contextOf } from "./canvas.js";
import { el, toggleButton } from "./dom.js";
import { clamp } from "./numbers.js";
import { metres, quantity } from "./units.js";

/** Upper limit of members with values written on them. */
const FEW_MEMBERS = 60;
/** Upper end of the scale of displacements, relative to the automatic one. */
const LARGEST = 3;

/** Labelled choice of one of several names. @param {string} id @param {string} label @param {string[]} names @param {number} chosen @param {(k: number) => void} onchange */
function chooser(id, label, names, chosen, onchange) {
  const select = el("select", { id, onchange: () => onchange(Number(select.value)) }, names.map((name, k) => el("option", { value: String(k) }, name)));
  select.value = String(chosen);
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, label), select);
}

/** Choices of the state, of the field and of the diagram. @param {Motion} motion @param {Mesh} mesh */
export function meshChoosers(motion, mesh) {
  const { states: { kind, names }, swings } = motion, label = kind === "load case" ? "Case" : kind[0]?.toUpperCase() + kind.slice(1);
  const fields = ["none", ...mesh.fields.map(({ name }) => name.replaceAll("_", " "))], chosen = mesh.field ? mesh.fields.indexOf(mesh.field) + 1 : 0;
  const diagrams = [...new Set(mesh.diagrams.map(({ name }) => name))];
  const states = names.length > 1 && swings && chooser("case", label, names, 0, (k) => motion.choose(k));
  motion.onState.on(() => {
    if (!states) return;
    const [select] = states.querySelectorAll("select");
    motion.states.names.forEach((name, k) => { select.options[k].text = name; });
    select.value = String(motion.chosen);
  });
  return el("div", { class: "chips" }, states,
    chooser("field", "Colours", fields, chosen, (k) => {
      if (motion.mesh) motion.mesh.field = motion.mesh.fields[k - 1] ?? null;
      motion.onState.emit();
    }),
    diagrams.length > 0 && chooser("diagram", "Diagram", ["none", ...diagrams], 0, (k) => {
      if (motion.mesh) motion.mesh.diagram = diagrams[k - 1] ?? "";
      motion.onState.emit();
    }));
}

/** Buttons that show parts of the drawing of a structure. @param {Motion} motion @param {Scene} scene @param {(key: string) => (on: boolean) => void} show @returns {Child} */
export function meshToggles({ mesh }, scene, show) {
  if (!mesh) return null;
  const members = mesh.lines.reduce((sum, { elements }) => sum + elements.length, 0), values = members > 0 && members <= FEW_MEMBERS && mesh.fields.some(({ atVertices }) => !atVertices);
  const toggle = (/** @type {string} */ key, /** @type {string} */ text, title = "") => toggleButton(text, scene.show[key], show(key), { id: `show-${key}`, title: title || null });
  return [toggle("rest", "Undeformed"), toggle("supports", "Supports"), values && toggle("values", "Values", "Values of the members"), mesh.faces.length > 0 && toggle("mesh", "Mesh")];
}

/** Scale of the displacements, from none to three times the automatic one. @param {Motion} motion @param {Mesh} mesh */
export function scaleSlider(motion, mesh) {
  const text = el("span", { class: "now", id: "factor" });
  const slider = el("input", { type: "range", min: "0", max: String(LARGEST), step: "0.01", value: "1", id: "scale", "aria-label": "Scale of the displacements", oninput: () => set(slider.valueAsNumber) });
  const set = (/** @type {number} */ factor) => {
    if (motion.mesh) motion.mesh.factor = factor;
    motion.onState.emit();
  };
  const chip = (/** @type {string} */ id, /** @type {string} */ label, /** @type {string} */ title, /** @type {() => number} */ factor) =>
    el("button", { type: "button", class: "chip", id, title, onclick: () => set(factor()) }, label);
  const refresh = () => {
    const { factor, scale, relative } = motion.mesh ?? mesh;
    text.textContent = relative ? `up to ${metres(scale)}` : `× ${+scale.toPrecision(3)}`;
    slider.value = String(Math.min(LARGEST, factor));
    slider.style.setProperty("--p", String(clamp(factor / LARGEST, 0, 1)));
    slider.setAttribute("aria-valuetext", text.textContent);
  };
  motion.onState.on(refresh);
  refresh();
  return el("div", { class: "displacements" }, el("span", { class: "caption" }, "Displacements"), el("div", { class: "track" }, slider), text,
    !mesh.relative && chip("true-scale", "1 : 1", "True scale", () => 1 / (motion.mesh ?? mesh).automatic),
    chip("auto-scale", "auto", "Automatic scale", () => 1));
}

/** Colours of the field and their values. @param {Motion} motion @param {Mesh} mesh */
export function fieldLegend(motion, mesh) {
  const bar = el("canvas", { class: "ramp", width: 1, height: 256 }), marks = el("div", { class: "ramp-marks" }), name = el("span", { class: "ramp-name" });
  const node = el("div", { class: "ramp-box", id: "colours" }, name, el("div", { class: "ramp-row" }, bar, marks));
  const refresh = () => {
    const { field } = motion.mesh ?? mesh, ramp = (motion.mesh ?? mesh).ramp();
    node.hidden = !field;
    if (!field || !ramp) return;
    const { lo, hi, steps } = ramp, ctx = contextOf(bar);
    steps.forEach((colour, k) => { ctx.fillStyle = colour; ctx.fillRect(0, 255 - k, 1, 1); });
    name.textContent = field.name.replaceAll("_", " ");
    marks.replaceChildren(...[4, 3, 2, 1, 0].map((k) => lo + (k / 4) * (hi - lo)).map((v) => el("span", {}, quantity(Math.abs(v) < 1e-12 * (hi - lo) ? 0 : v, field.unit, 3))));
  };
  motion.onState.on(refresh);
  refresh();
  return node;
}
