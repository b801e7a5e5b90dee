// The drawing by keyboard: a crosshair that arrow keys move, and Enter in place of a click.

/** @import { Page, Pictures } from "./pictures.js" */

import { el } from "./dom.js";
import { gridStep, snap } from "./snapping.js";

const STEPS = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] });
/** Part of a step of the grid by which Shift and an arrow key move. */
const FINE = 0.1;
/** Distance of the crosshair from the border of the picture [px]. */
const MARGIN = 24;

/** What is drawn on: a planar mechanism or structure.
 * @typedef {{ possible: boolean, page: Page | null, snapPage: Page | null, pictures: Pictures, tool: { name: string, clicks: number }, places: { x: number, y: number }[], drag: unknown, typed: string, rest: () => void, finish: () => void }} Surface */

export class Crosshair {
  /** @param {HTMLElement} stage @param {Surface[]} surfaces of which at most one is possible */
  constructor(stage, surfaces) {
    this.stage = stage;
    this.surfaces = surfaces;
    this.mark = el("div", { class: "crosshair", hidden: true, "aria-hidden": "true" });
    this.voice = el("div", { class: "unseen", "aria-live": "polite" });
    stage.append(this.mark, this.voice);
    /** World coordinates. @type {[number, number] | null} */
    this.at = null;
    /** A point is dragged. */
    this.holds = false;
    stage.addEventListener("keydown", (event) => this.key(event));
    stage.addEventListener("blur", () => this.hide());
    stage.addEventListener("pointerdown", () => this.hide());
  }

  get drawing() { return this.surfaces.find(({ possible }) => possible) ?? null; }

  hide() {
    this.mark.hidden = true;
    this.holds = false;
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const { drawing } = this;
    if (event.target !== this.stage || event.ctrlKey || event.metaKey || event.altKey || !drawing) return;
    const { key } = event, step = STEPS[key], page = /** @type {Page} */ (drawing.page), { view } = page.scene;
    if (key === "Tab" || (!step && key !== "Enter" && key !== " ")) return;
    if (key === " " && drawing.typed) return;  // before a unit
    event.preventDefault();
    event.stopPropagation();
    if (drawing.tool.name === "select") drawing.rest();
    if (!this.at || this.mark.hidden) this.at ??= this.nearGrid(page);
    if (step) {
      const size = gridStep(view.s) * (event.shiftKey ? FINE : 1);
      const moved = /** @type {[number, number]} */ (this.at.map((value, k) => Number((Math.round((value + size * step[k]) / size) * size).toPrecision(9))));
      if (this.inside(page, moved)) this.at = moved;
      this.send("pointermove", this.holds ? 1 : 0);
    } else if (drawing.tool.name === "select" && !this.holds) {
      this.send("pointerdown", 1);
      this.holds = Boolean(drawing.drag);
      if (!this.holds) this.send("pointerup", 0);
    } else if (this.closes(drawing)) drawing.finish();
    else {
      if (!this.holds) this.send("pointermove", 0), this.send("pointerdown", 1);
      this.send("pointerup", 0);
      this.holds = false;
    }
    this.show(page);
  }

  /** Whether a second Enter at the last corner closes an outline. @param {Surface} drawing */
  closes({ tool, places }) {
    const last = places.at(-1);
    return Boolean(tool.clicks === 0 && places.length > 2 && last && this.at && Math.hypot(last.x - this.at[0], last.y - this.at[1]) < 1e-9 + 1e-6 * Math.hypot(...this.at));
  }

  /** Middle of the picture on the grid. @param {Page} page @returns {[number, number]} */
  nearGrid({ scene: { view, canvas } }) {
    const step = gridStep(view.s), [x, y] = view.world([canvas.clientWidth / 2, canvas.clientHeight / 2]);
    return [Math.round(x / step) * step, Math.round(y / step) * step];
  }

  /** @param {Page} page @param {[number, number]} at */
  inside({ scene: { view, canvas } }, at) {
    const [u, v] = view.screen(at);
    return u > MARGIN && v > MARGIN && u < canvas.clientWidth - MARGIN && v < canvas.clientHeight - MARGIN;
  }

  /** Send the event of a pointer at the crosshair to the picture. @param {string} kind @param {number} buttons */
  send(kind, buttons) {
    const { page, pictures } = this.drawing ?? {}, frame = pictures?.frame;
    if (!page || !frame || !this.at) return;
    const { canvas, view } = page.scene, [u, v] = view.screen(this.at), { left, top } = canvas.getBoundingClientRect();
    const Inner = /** @type {any} */ (frame.contentWindow).PointerEvent;
    canvas.dispatchEvent(new Inner(kind, { clientX: u + left, clientY: v + top, buttons, button: 0, bubbles: true, pointerId: 1 }));
  }

  /** @param {Page} page */
  show(page) {
    const { drawing } = this;
    if (!this.at || !drawing) return;
    const frame = /** @type {HTMLElement} */ (drawing.pictures.frame), { canvas, view } = page.scene;
    const [u, v] = view.screen(this.at), inner = canvas.getBoundingClientRect(), outer = frame.getBoundingClientRect(), own = this.stage.getBoundingClientRect();
    this.mark.style.translate = `${u + inner.left + outer.left - own.left}px ${v + inner.top + outer.top - own.top}px`;
    this.mark.hidden = false;
    const { how } = snap(drawing.snapPage ?? page, [u, v]), place = this.at.map((value) => Number(value.toPrecision(4))).join(", ");
    this.voice.textContent = `${place}${how && how !== "grid" ? `, at ${how}` : ""}`;
  }
}
