// Commands of the selection: copied, pasted, mirrored, rotated, nudged, deleted, renamed.

/** @import { Drawing } from "./drawing.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Transform } from "./transforms.js" */
/** @import { Document } from "./types.d.ts" */

import { copied, remove, transform } from "./editing.js";
import { stillPage } from "./preview.js";
import { bodiesAmong, bounds, namesIn } from "./selection.js";
import { gridStep } from "./snapping.js";
import { reflection, rotation, shift } from "./transforms.js";

/** Angle of a rotation by a key [rad]. */
const TURN = Math.PI / 12;

export class SelectionKeys {
  /** @param {Drawing} drawing */
  constructor(drawing) {
    this.drawing = drawing;
    /** Copied elements, as they were. @type {{ page: Page, document: Document, names: string[] } | null} */
    this.clipboard = null;
  }

  /** Move, rotate or mirror elements. @param {Set<string>} names @param {(middle: { x: number, y: number }) => Transform} map @param {string} label */
  turn(names, map, label) {
    const { drawing } = this, { page, document } = drawing, middle = page && bounds(page, names);
    if (!page || !document || !middle) return;
    if (drawing.pictures.outdated) return drawing.actions.refuse(`${label}: the picture is not that of this text; correct its errors`);
    drawing.rest();
    drawing.attempt(() => transform(page, document, names, map(middle), label), `${label}: select bodies`);
  }

  /** Rotate or mirror the selection, after what was done before. @param {(middle: { x: number, y: number }) => Transform} map @param {string} label */
  turnSelection(map, label) {
    const { actions, selection } = this.drawing;
    actions.commands.do(() => this.turn(selection, map, label), true);
  }

  mirror(upright = true) { this.turnSelection(({ x, y }) => reflection({ x, y }, upright ? { x, y: y + 1 } : { x: x + 1, y }), upright ? "mirror left and right" : "mirror up and down"); }

  /** @param {number} sense */
  rotate(sense) { this.turnSelection((middle) => rotation(middle, sense * TURN), "rotate by 15°"); }

  /** Keep a copy of the selected bodies. */
  copy() {
    const { page, document, selection, actions } = this.drawing;
    if (!page || !document || !bodiesAmong(document, selection).length) return actions.refuse("copy: select bodies");
    this.drawing.rest();
    this.clipboard = { page: stillPage(page), document, names: [...selection] };
  }

  /** Add the copied elements: at the pointer, or beside the originals. @param {boolean} atPointer */
  paste(atPointer) {
    const { clipboard, drawing } = this, { page, now } = drawing, middle = clipboard && bounds(clipboard.page, clipboard.names);
    if (!clipboard || !page || !middle) return;
    const step = 2 * gridStep(page.scene.view.s), map = atPointer && now ? shift(now.x - middle.x, now.y - middle.y) : shift(step, -step);
    drawing.attempt(() => copied(clipboard.page, clipboard.document, clipboard.names, map));
    drawing.before = new Set(namesIn(drawing.document));
  }

  duplicate() {
    this.copy();
    this.paste(false);
  }

  /** Keys with Ctrl. @param {KeyboardEvent} event @returns {boolean} */
  command({ key, altKey, shiftKey }) {
    const { drawing } = this, { document } = drawing;
    if (altKey || shiftKey || !document || !drawing.possible) return false;
    const { commands } = drawing.actions;
    if (key === "c" && drawing.selection.size) commands.do(() => this.copy(), true);
    else if (key === "v" && (this.clipboard || commands.waiting.length)) commands.do(() => this.paste(true), false);
    else if (key === "d") commands.do(() => this.duplicate(), true);
    else if (key === "a") drawing.select(namesIn(document));
    else return false;
    return true;
  }

  /** Keys without Ctrl. @param {KeyboardEvent} event @returns {boolean} */
  edits({ key, shiftKey }) {
    const { drawing } = this, { page, selected, selection, actions } = drawing;
    if (!page || !drawing.document || !selection.size) return false;
    const step = gridStep(page.scene.view.s) * (shiftKey ? 0.1 : 1), way = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] })[key];
    if (way) actions.commands.step((sum) => this.turn(selection, () => shift(...sum), "move selection"), way, true);
    else if (key === "Delete" || key === "Backspace") {
      drawing.select([]);
      actions.commands.do(() => drawing.attempt(() => drawing.document && remove(drawing.document, selection)), false);
    } else if (key === "F2" && selected) drawing.actions.rename(selected);
    else if (key === "h" || key === "H") this.mirror(key === "h");
    else if (key === "r" || key === "R") this.rotate(key === "r" ? 1 : -1);
    else return false;
    return true;
  }
}
