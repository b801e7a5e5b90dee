// Targets of a synthesis that are dragged on the picture: points, positions and directions of poses.

/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Document } from "./types.d.ts" */

import { snap } from "./snapping.js";
import { movedPoint, synthesisOf, targetOf, turnedPose } from "./target_edits.js";
import { ARM } from "./targets.js";

/** Distance within which the pointer catches a target [px]. */
const CATCH = 9;

/** Number of a target, and whether its direction is dragged. @typedef {{ entry: number, turns: boolean }} Grip */

export class TargetDrag {
  /** @param {Pictures} pictures @param {{ edit: (label: string, operations: Record<string, unknown>[]) => void, document: () => Document | null, selects: () => boolean }} actions */
  constructor(pictures, actions) {
    this.pictures = pictures;
    this.actions = actions;
    /** @type {Grip | null} */
    this.grip = null;
    /** Coordinates of the target while it is dragged, or its angle. @type {number[] | number | null} */
    this.moved = null;
    pictures.onShow.unshift((page) => this.bind(page));  // before the drawing, whose clicks it takes
  }

  /** The document with the target at the pointer. @returns {Document | null} */
  get document() {
    const document = this.actions.document(), { grip, moved } = this;
    if (!document || !grip || moved === null) return document;
    const key = grip.turns ? "coupler_angles" : "points", table = synthesisOf(document);
    return { ...document, synthesis: { ...table, [key]: table[key].map((/** @type {unknown} */ old, /** @type {number} */ k) => (k === grip.entry ? moved : old)) } };
  }

  /** Target at a pixel. @param {Page} page @param {[number, number]} pixel @returns {Grip | null} */
  at(page, [u, v]) {
    const { type, points, angles } = targetOf(this.actions.document());
    if (!["path", "motion"].includes(type)) return null;
    const near = (/** @type {number} */ x, /** @type {number} */ y) => Math.hypot(x - u, y - v) < CATCH;
    for (let entry = points.length - 1; entry >= 0; entry--) {
      if (!points[entry].every(Number.isFinite)) continue;
      const [x, y] = page.scene.view.screen(points[entry]), angle = type === "motion" ? angles[entry] : NaN;
      if (near(x, y)) return { entry, turns: false };
      if (Number.isFinite(angle) && near(x + Math.cos(angle) * ARM, y - Math.sin(angle) * ARM)) return { entry, turns: true };
    }
    return null;
  }

  /** @param {Page} page */
  bind(page) {
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow), { canvas } = page.scene;
    const pixel = (/** @type {PointerEvent} */ event) => { const { left, top } = canvas.getBoundingClientRect(); return /** @type {[number, number]} */ ([event.clientX - left, event.clientY - top]); };
    const on = (/** @type {string} */ kind, /** @type {(event: PointerEvent, at: [number, number]) => boolean} */ act) => view.addEventListener(kind, (event) => {
      if (("s" in page.scene.view) && act(/** @type {PointerEvent} */ (event), pixel(/** @type {PointerEvent} */ (event)))) event.stopImmediatePropagation();
    }, true);
    on("pointerdown", (event, at) => {
      this.grip = event.target === canvas && event.button === 0 && !event.shiftKey && this.actions.selects() ? this.at(page, at) : null;
      return this.grip !== null;
    });
    on("pointermove", (event, at) => {
      if (!this.grip) return false;
      this.moved = this.change(page, this.grip, at, event.altKey);
      page.scene.invalidate();
      return true;
    });
    const end = (/** @type {boolean} */ written) => {
      if (!this.grip) return false;
      const { grip, moved } = this;
      [this.grip, this.moved] = [null, null];
      const document = this.actions.document(), operations = !written || moved === null ? [] : Array.isArray(moved) ? movedPoint(document, grip.entry, moved) : turnedPose(document, grip.entry, moved);
      if (operations.length) this.actions.edit(grip.turns ? "turn target" : "move target", operations);
      page.scene.invalidate();
      return true;
    };
    on("pointerup", () => end(true));
    on("pointercancel", () => end(false));
    view.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || !end(false)) return;
      event.preventDefault();
      event.stopImmediatePropagation();
    }, true);
  }

  /** Coordinates of a target at a pixel, or its angle. @param {Page} page @param {Grip} grip @param {[number, number]} pixel @param {boolean} free */
  change(page, { entry, turns }, pixel, free) {
    const { points, angles } = targetOf(this.actions.document());
    if (!turns) {
      const { x, y } = snap(page, pixel, { free });
      return [x, y];
    }
    const [x, y] = page.scene.view.screen(points[entry]), angle = Math.atan2(y - pixel[1], pixel[0] - x);
    return angle + 2 * Math.PI * Math.round((angles[entry] - angle) / (2 * Math.PI));
  }
}
