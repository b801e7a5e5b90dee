// Tools of the palette.

/** @import { Drawing } from "./drawing.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Change } from "./operations.js" */

import { bar, force, motor, pin, plate, slider, spring } from "./operations.js";

/** A tool: what its clicks are, and the change that they make. `clicks` is zero for a list that Enter or a click on its start ends.
 * @typedef {{ name: string, key: string, title: string, hint: string[], clicks: number, onBody?: boolean, make: (places: Place[], drawing: Drawing) => Change | null }} Tool */

/** @type {Tool[]} */
export const TOOLS = [
  { name: "select", key: "v", title: "Select", hint: ["drag a point to move it; click an element to select it, Delete removes it"], clicks: -1, make: () => null },
  { name: "bar", key: "b", title: "Bar", hint: ["click the start of the bar", "click its end"], clicks: 2, make: ([from, to]) => bar(from, to) },
  { name: "plate", key: "p", title: "Plate", hint: ["click the corners; Enter, or a click on the first, closes the plate"], clicks: 0, make: (places) => plate(places) },
  { name: "pin", key: "o", title: "Pin", hint: ["click a point: bodies there are joined, a single one is pinned to the ground"], clicks: 1, onBody: true, make: ([place]) => pin(place) },
  { name: "slider", key: "s", title: "Slider", hint: ["click a point that slides", "click in the direction of the slot"], clicks: 2, onBody: true, make: ([place, toward]) => slider(place, toward) },
  { name: "spring", key: "k", title: "Spring", hint: ["click one end of the spring", "click the other end"], clicks: 2, onBody: true, make: ([from, to]) => spring(from, to) },
  { name: "force", key: "f", title: "Force", hint: ["click the point on which the force acts", "click its direction"], clicks: 2, onBody: true, make: ([place, toward]) => force(place, toward) },
  { name: "motor", key: "m", title: "Motor", hint: ["click a joint"], clicks: 1, make: ([place], { page, document }) => page && document && motor(place, page, document) },
];
