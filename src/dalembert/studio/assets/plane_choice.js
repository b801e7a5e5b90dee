// Choice of the working plane: its normal, its coordinate, or through what is selected.

/** @import { Vec } from "./space_math.js" */
/** @import { WorkingPlane } from "./space_places.js" */

import { el } from "./dom.js";
import { AXES } from "./space_math.js";

/** Working planes by their normal. */
const PLANES = /** @type {const} */ ([["z", "xy"], ["x", "yz"], ["y", "zx"]]);

export class PlaneChoice {
  /** @param {string} id of the palette @param {{ change: () => void, through: () => Vec | null }} actions */
  constructor(id, actions) {
    this.actions = actions;
    /** @type {WorkingPlane} */
    this.plane = { axis: "z", normal: AXES.z, origin: [0, 0, 0] };
    this.planes = PLANES.map(([axis, title]) => el("button", { type: "button", class: "button", "data-plane": axis, title: `Draw on a plane parallel to ${title}`, onclick: () => this.set(axis) }, title));
    this.offset = el("input", { type: "text", id: `${id}-offset`, inputmode: "decimal", size: "6", "aria-label": "Coordinate of the plane", title: "Coordinate of the plane along its normal [m]", onchange: () => this.set(this.plane.axis, Number(this.offset.value)) });
    this.label = el("span", {}, "z =");
    this.through = el("button", { type: "button", class: "button", title: "Plane through the selected element (H)", onclick: () => this.throughSelected() }, "Through", el("kbd", {}, "H"));
    this.mark();
  }

  /** @param {"x" | "y" | "z"} axis @param {number} [offset] [m] */
  set(axis, offset = this.plane.origin["xyz".indexOf(axis)]) {
    const k = "xyz".indexOf(axis), at = Number.isFinite(offset) ? offset : 0;
    this.plane = { axis, normal: AXES[axis], origin: this.plane.origin.map((v, i) => (i === k ? at : v)) };
    this.mark();
    this.actions.change();
  }

  mark() {
    const { axis, origin } = this.plane;
    this.label.textContent = `${axis} =`;
    this.offset.value = String(origin["xyz".indexOf(axis)]);
    for (const node of this.planes) node.setAttribute("aria-pressed", String(node.dataset.plane === axis));
  }

  throughSelected() {
    const p = this.actions.through();
    if (p) this.plane.origin = [...p];
    if (p) this.set(this.plane.axis, p["xyz".indexOf(this.plane.axis)]);
  }
}
