// Tools of the palette, in groups.

/** @import { Drawing } from "./drawing.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { SHAPE_TOOLS } from "./contact_shapes.js";
import { transform } from "./editing.js";
import { actuator, contact, damper, hydraulic, linearMotor, rope, stop, stroke, torque, torsionSpring } from "./new_forces.js";
import { beam, cam, gears, guide, link, mass, point, rack, slot, weld } from "./new_joints.js";
import { bar, force, motor, pin, plate, slider, spring } from "./operations.js";
import { TARGET_TOOLS } from "./targets.js";
import { reflection } from "./transforms.js";

/** A tool: what its clicks are, and the change that they make. `clicks` is zero for a list that Enter or a click on its start ends.
 * With `onBody` the first place may be on a body, with `all` every place. Directions are measured from the last place, or `fromFirst`.
 * @typedef {{ name: string, key: string, group: string, title: string, hint: string[], clicks: number, onBody?: boolean | "all", fromFirst?: boolean, make: (places: Place[], drawing: Drawing) => Change | null }} Tool */

export const GROUPS = ["Select", "Bodies", "Joints", "Forces", "Contacts", "Drives", "Targets"];

/** A tool that needs the picture and the document. @param {(page: Page, document: Document, places: Place[]) => Change | null} make @returns {Tool["make"]} */
const using = (make) => (places, { page, document }) => page && document && make(page, document, places);

const A_POINT = "click one end, on a point, a body or the ground", A_JOINT = "click a joint";

/** @type {Tool[]} */
export const TOOLS = [
  { name: "select", key: "v", group: "Select", title: "Select", hint: ["drag a point or a body; click, Shift+click or drag a rectangle to select; Alt+drag or the middle button pans"], clicks: -1, make: () => null },
  { name: "mirror", key: "", group: "Select", title: "Mirror", hint: ["click the first point of the line about which the selection is mirrored", "click its second point"], clicks: 2, make: ([p, q], { page, document, selection }) => page && document && transform(page, document, selection, reflection(p, q), "mirror") },
  { name: "bar", key: "b", group: "Bodies", title: "Bar", hint: ["click the start of the bar", "click its end, or type 0.3 or 0.3<45"], clicks: 2, make: ([from, to]) => bar(from, to) },
  { name: "plate", key: "p", group: "Bodies", title: "Plate", hint: ["click the corners; Enter, or a click on the first, closes the plate"], clicks: 0, make: (places) => plate(places) },
  { name: "mass", key: "a", group: "Bodies", title: "Point mass", hint: ["click its place; on a body it is pinned there"], clicks: 1, onBody: true, make: ([place]) => mass(place) },
  { name: "beam", key: "e", group: "Bodies", title: "Flexible beam", hint: ["click where it is clamped: a point, a body or the ground", "click its other end; on a body it is clamped too"], clicks: 2, onBody: "all", make: using((page, _, [from, to]) => beam(page, from, to)) },
  { name: "point", key: "t", group: "Bodies", title: "Point", hint: ["click a body or the ground"], clicks: 1, onBody: true, make: using((_, document, [place]) => point(place, document)) },
  { name: "pin", key: "o", group: "Joints", title: "Pin", hint: ["click a point or where bars cross: bodies there are joined, a single one is pinned to the ground"], clicks: 1, onBody: true, make: using((page, _, [place]) => pin(page, place)) },
  { name: "slider", key: "s", group: "Joints", title: "Slider", hint: ["click a point that slides", "click in the direction of the slot"], clicks: 2, onBody: true, make: ([place, toward]) => slider(place, toward) },
  { name: "slot", key: "u", group: "Joints", title: "Slot in a body", hint: ["click the point that slides", "click the body with the slot", "click in the direction of the slot"], clicks: 3, fromFirst: true, onBody: "all", make: using((page, _, places) => slot(page, places)) },
  { name: "guide", key: "i", group: "Joints", title: "Guide", hint: ["click the body that slides", "click the body or the ground that it slides along", "click in the direction of the guide"], clicks: 3, fromFirst: true, onBody: "all", make: using((page, _, places) => guide(page, places)) },
  { name: "weld", key: "w", group: "Joints", title: "Weld", hint: ["click a point: bodies there are welded, a single one to the ground; a pin there is replaced"], clicks: 1, onBody: true, make: using((page, document, [place]) => weld(page, document, place)) },
  { name: "link", key: "l", group: "Joints", title: "Massless link", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => link(from, to) },
  { name: "gears", key: "g", group: "Joints", title: "Gear pair", hint: ["click the centre of the first gear", "click the centre of the second gear", "click where the pitch circles touch; beyond the second centre for inner teeth"], clicks: 3, onBody: "all", make: (places) => gears(places) },
  { name: "rack", key: "G", group: "Joints", title: "Rack and pinion", hint: ["click the centre of the pinion", "click the rack: a body or the ground", "click in the direction of the rack"], clicks: 3, onBody: "all", make: using((page, _, places) => rack(page, places)) },
  { name: "cam", key: "c", group: "Joints", title: "Cam", hint: ["click the centre of the cam on its body", "click the point of the follower; then select the cam and drag its control points"], clicks: 2, onBody: "all", make: using((page, _, [center, follower]) => cam(page, center, follower)) },
  { name: "force", key: "f", group: "Forces", title: "Force", hint: ["click the point on which the force acts", "click its direction"], clicks: 2, onBody: true, make: ([place, toward]) => force(place, toward) },
  { name: "torque", key: "q", group: "Forces", title: "Torque", hint: ["click a body"], clicks: 1, onBody: true, make: ([place]) => torque(place) },
  { name: "spring", key: "k", group: "Forces", title: "Spring", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => spring(from, to) },
  { name: "damper", key: "d", group: "Forces", title: "Damper", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => damper(from, to) },
  { name: "torsion", key: "y", group: "Forces", title: "Torsion spring", hint: [A_JOINT], clicks: 1, make: using((page, document, [place]) => torsionSpring(place, page, document)) },
  { name: "cylinder", key: "j", group: "Forces", title: "Cylinder", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => actuator(from, to) },
  { name: "hydraulic", key: "J", group: "Forces", title: "Hydraulic cylinder", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => hydraulic(from, to) },
  { name: "rope", key: "z", group: "Forces", title: "Rope", hint: ["click the points it runs through, on bodies or the ground; Enter ends it"], clicks: 0, onBody: "all", make: (places) => rope(places) },
  { name: "stop", key: "x", group: "Forces", title: "Stop", hint: ["click a pin, a slider or a guide"], clicks: 1, make: using((page, document, [place]) => stop(place, page, document)) },
  { name: "contact", key: "C", group: "Contacts", title: "Contact", hint: ["click a body", "click another body, or the height of the floor"], clicks: 2, onBody: "all", make: using((_, document, [first, second]) => contact(first, second, document)) },
  ...SHAPE_TOOLS,
  { name: "motor", key: "m", group: "Drives", title: "Motor", hint: [A_JOINT], clicks: 1, make: using((page, document, [place]) => motor(place, page, document)) },
  { name: "drive", key: "n", group: "Drives", title: "Linear motor", hint: ["click a slider or a guide"], clicks: 1, make: using((_, document, [place]) => linearMotor(place, document)) },
  { name: "stroke", key: "N", group: "Drives", title: "Length drive", hint: [A_POINT, "click the other end"], clicks: 2, onBody: "all", make: ([from, to]) => stroke(from, to) },
  ...TARGET_TOOLS,
];
