// Tools of spatial drawings: directions of view, transparency, section.

/** @import { Axis } from "./scene_types.d.ts" */
/** @import { SpatialPainter } from "./spatial_painter.js" */
/** @import { SpatialView } from "./spatial_view.js" */
/** @import { Scene } from "./scene.js" */

import { byId, el, toggleButton } from "./dom.js";
import { AXES } from "./spatial_motion.js";

/** @param {Scene} scene @param {HTMLElement} toolbar */
export function buildSpatialTools(scene, toolbar) {
  const painter = /** @type {SpatialPainter} */ (scene.painter), view = /** @type {SpatialView} */ (scene.view), axes = /** @type {Axis[]} */ (Object.keys(AXES));
  const look = (/** @type {Axis | null} */ axis, /** @type {string} */ text, /** @type {string} */ title, /** @type {number} */ key) =>
    el("button", { type: "button", class: "icon axis", id: `look-${axis ?? "all"}`, title: `${title} (${key})`, "aria-label": title, onclick: () => view.lookAlong(axis) }, text);
  byId("zoom").append(...axes.map((axis, k) => look(axis, axis, `Look along ${axis}`, k + 1)), look(null, "3D", "Oblique view from above", 4),
    toggleButton("∥", false, (on) => view.setParallel(on), { class: "icon axis", id: "parallel", title: "Parallel projection", "aria-label": "Parallel projection" }));
  if (!scene.motion.bodies.length) return;
  const box = sectionBox(painter);
  byId("view").append(box.node);
  if (scene.motion.bodies.some(({ shapes }) => shapes.some(({ kind }) => kind === "ellipsoid"))) {
    toolbar.append(toggleButton("Inertia", true, (on) => painter.change({ inertia: on }), { id: "inertia", title: "Inertia ellipsoids of bodies without a shape" }));
  }
  toolbar.append(
    toggleButton("See-through", false, (on) => painter.change({ clear: on }), { id: "clear", title: "Transparent bodies" }),
    toggleButton("Section", false, (on) => box.show(on), { id: "section", title: "Cut through the bodies" }));
}

/** Controls of the section: axis, position, side. @param {SpatialPainter} painter */
function sectionBox(painter) {
  const axis = el("select", { id: "section-axis", "aria-label": "Axis of the section" }, Object.keys(AXES).map((name) => el("option", { value: name }, name)));
  const place = el("input", { type: "range", min: "-1", max: "1", step: "0.005", value: "0", id: "section-place", "aria-label": "Position of the section" });
  const flip = toggleButton("Other side", false, () => update(), { id: "section-flip" });
  const node = el("div", { class: "section-box", hidden: true }, el("span", { class: "caption" }, "Section along"), axis, el("div", { class: "track" }, place), flip);
  const update = () => {
    place.style.setProperty("--p", String((place.valueAsNumber + 1) / 2));
    painter.setSection(node.hidden ? null : /** @type {Axis} */ (axis.value), place.valueAsNumber, flip.getAttribute("aria-pressed") === "true");
  };
  axis.addEventListener("change", update);
  place.addEventListener("input", update);
  return { node, show: (/** @type {boolean} */ on) => { node.hidden = !on; update(); } };
}
