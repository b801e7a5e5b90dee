// List of the keys of the page.

import { showSheet } from "./dialogs.js";
import { button, el } from "./dom.js";
import { OVERLAYS } from "./overlays.js";
import { keyName } from "./palette.js";
import { SPACE_STRUCTURE_TOOLS } from "./space_structure_tools.js";
import { SPACE_TOOLS } from "./space_tools.js";
import { STRUCTURE_TOOLS } from "./structure_tools.js";
import { TOOLS } from "./tools.js";

/** @typedef {[string, string][]} Rows keys and their meaning */

/** @param {string} modifier @returns {[string, Rows][]} */
export const groups = (modifier) => [
  ["Tools", TOOLS.flatMap(({ key, title }) => (key ? [[keyName(key), title]] : []))],
  ["Structures", STRUCTURE_TOOLS.map(({ key, title }) => [keyName(key), title])],
  ["Spatial models", [.../** @type {Rows} */ (SPACE_TOOLS.map(({ key, title }) => [keyName(key), title])), ["G", "axes of space, or of the element"]]],
  ["Spatial structures", SPACE_STRUCTURE_TOOLS.map(({ key, title }) => [keyName(key), title])],
  ["Space", [["1 2 3 4", "look along x, y, z, obliquely, with Select"], ["H", "working plane through the selected element"], ["0–9 Enter", "coordinates of the next place, such as 0.1, 0, 0.25; value of a drag"]]],
  ["Drawing", [["Arrows", "move the crosshair by a step of the grid, with Shift by a tenth"], ["Enter", "click at the crosshair; finish a plate"], ["0–9 Enter", "length 0.3, length and angle 0.3<45, or coordinates 0.1,0.2"], ["Esc", "give up what is being drawn; select"], ["Alt", "hold: no snapping"]]],
  ["Selection", [["Delete", "remove, with all that depends on it"], [`${modifier}A`, "select all, but in spatial mechanisms"], ["Arrows", "move it, in planar models, while the drawing has no crosshair"]]],
  ["Selection in planar mechanisms", [["H", "mirror left and right"], ["⇧H", "mirror up and down"], ["R", "rotate by 15°"], ["⇧R", "rotate by −15°"], ["F2", "rename"], [`${modifier}C`, "copy"], [`${modifier}V`, "paste at the pointer"], [`${modifier}D`, "copy beside it"]]],
  ["Picture of a planar mechanism", [.../** @type {Rows} */ (OVERLAYS.map(({ key, title }) => [key, title])), ["8", "Joint reactions"], ["9", "Other configurations"]]],
  ["Motion, with the picture in focus", [["Space", "play or pause"], ["← →", "step, with Shift by a fiftieth of the motion"], ["Home End", "its start, its end"], ["+ −", "zoom"], ["0", "show all"]]],
  ["File", [[`${modifier}S`, "save"], [`${modifier}Shift+S`, "save as"], [`${modifier}O`, "open"], [`${modifier}Z`, "undo"], [`${modifier}Y`, "redo"], [`${modifier}Shift+Z`, "redo"]]],
  ["Text", [[`${modifier}E`, "turn the number at the cursor into a parameter"], [`${modifier}F`, "search"], [`${modifier}Space`, "complete"], ["Tab", "next part of the page"]]],
  ["Page", [["Tab", "next part: buttons, tools, drawing, text"], ["?", "this list"]]],
];

/** Show the keys. @param {string} modifier name of Control on this machine @param {() => void} guide begins the guided first build */
export function showShortcuts(modifier, guide) {
  const begin = button("Guided first build", () => {
    dialog.close();
    guide();
  });
  const section = (/** @type {[string, Rows]} */ [title, rows]) => el("section", {}, el("h3", {}, title), el("dl", {}, rows.flatMap(([keys, text]) => [el("dt", {}, keys.split(" ").map((key) => el("kbd", {}, key))), el("dd", {}, text)])));
  const dialog = showSheet("Keys", [el("div", { class: "sheet-body shortcuts" }, groups(modifier).map(section)), el("div", { class: "chips" }, begin)]);
}
