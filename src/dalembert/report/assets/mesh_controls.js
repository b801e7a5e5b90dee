// Controls of the drawing of a structure: state, field with its colours, diagram, parts.

/** @import { Child } from "./types.d.ts" */
/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */
/** @import { Scene } from "./scene.js" */

import { contextOf } from "./canvas.js";
import { el, toggleButton } from "./dom.js";
import { chooser, stateChooser } from "./state_controls.js";
import { quantity } from "./units.js";

/** Upper limit of members with values written on them. */
const FEW_MEMBERS = 60;

/** Fields of continuum elements that vary within an element. */
const VARYING = /^([es](xx|yy|zz|xy|yz|xz)|von_mises)$/;

/** Choices of the state, of the field and of the diagram. @param {Motion} motion @param {Mesh} mesh */
export function meshChoosers(motion, mesh) {
  const fields = ["none", ...mesh.fields.map(({ name }) => name.replaceAll("_", " "))], chosen = mesh.field ? mesh.fields.indexOf(mesh.field) + 1 : 0;
  const diagrams = [...new Set(mesh.diagrams.map(({ name }) => name))];
  return el("div", { class: "chips" }, motion.states.names.length > 1 && motion.swings && stateChooser(motion),
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

/** Colours of the field and their values. @param {Motion} motion @param {Mesh} mesh */
export function fieldLegend(motion, mesh) {
  const bar = el("canvas", { class: "ramp", width: 1, height: 256 }), marks = el("div", { class: "ramp-marks" }), name = el("span", { class: "ramp-name" }), where = el("small", {}, "at element centres");
  const node = el("div", { class: "ramp-box", id: "colours" }, name, where, el("div", { class: "ramp-row" }, bar, marks));
  const refresh = () => {
    const { field } = motion.mesh ?? mesh, ramp = (motion.mesh ?? mesh).ramp();
    node.hidden = !field;
    if (!field || !ramp) return;
    const { lo, hi, steps } = ramp, ctx = contextOf(bar);
    steps.forEach((colour, k) => { ctx.fillStyle = colour; ctx.fillRect(0, 255 - k, 1, 1); });
    name.textContent = field.name.replaceAll("_", " ");
    where.hidden = field.atVertices || !VARYING.test(field.name);
    marks.replaceChildren(...[4, 3, 2, 1, 0].map((k) => lo + (k / 4) * (hi - lo)).map((v) => el("span", {}, quantity(Math.abs(v) < 1e-12 * (hi - lo) ? 0 : v, field.unit, 3))));
  };
  motion.onState.on(refresh);
  refresh();
  return node;
}
