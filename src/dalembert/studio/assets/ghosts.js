// Other assembly configurations, drawn faintly over the picture; a click on one takes it over.

/** @import { Page, Pictures } from "./pictures.js" */
/** @import { AssembliesMessage, Document } from "./types.d.ts" */

import { button, el } from "./dom.js";
import { neat } from "./neat.js";

/** Distance within which the pointer catches a configuration [px]. */
const CATCH = 9;
/** Number with or without a unit, which is replaced; a formula is not. */
const NUMBER = /^\s*[-+]?[\d.]+(e[-+]?\d+)?\s*[^\W\d_]*\s*$/i;

export class Ghosts {
  /** @param {Pictures} pictures
   * @param {{ request: (kind: string, more: Record<string, unknown>) => void, edit: (label: string, operations: Record<string, unknown>[]) => void, refuse: (text: string) => void, rest: () => void, document: () => Document | null, revision: () => number, selects: () => boolean }} actions */
  constructor(pictures, actions) {
    this.pictures = pictures;
    this.actions = actions;
    this.shown = false;
    /** @type {AssembliesMessage | null} */
    this.message = null;
    /** Configuration under the pointer. */
    this.near = -1;
    this.button = button("Other configurations", () => this.toggle(), { class: "pick", "aria-pressed": "false", title: "Draw the other ways in which the mechanism can be assembled (key 9); a click on one takes it over" });
    this.picks = el("div", { class: "picks" });
    this.state = el("p", { class: "muted", role: "status" });
    this.node = el("div", {}, this.state, this.picks);
    pictures.onShow.unshift((page) => this.bind(page));  // before the drawing, whose clicks it may take
  }

  toggle() {
    this.shown = !this.shown;
    this.button.setAttribute("aria-pressed", String(this.shown));
    this.state.textContent = this.shown ? "searching other configurations…" : "";
    if (this.shown) this.actions.rest();
    else this.picks.replaceChildren();
    this.actions.request("assemblies", { shown: this.shown });
    this.pictures.page?.scene.invalidate();
  }

  /** @param {AssembliesMessage} message */
  receive(message) {
    this.message = message;
    this.near = -1;
    if (!this.shown) return;
    this.state.textContent = message.text;
    this.picks.replaceChildren(...message.poses.map((_, k) => button(`Take configuration ${k + 1}`, () => this.take(k), { class: "pick", onmouseenter: () => this.mark(k), onmouseleave: () => this.mark(-1), onfocus: () => this.mark(k) })));
    this.pictures.page?.scene.invalidate();
  }

  /** @param {number} k */
  mark(k) {
    if (k === this.near) return;
    this.near = k;
    this.pictures.page?.scene.invalidate();
  }

  /** Configurations of the shown text. @returns {Record<string, number[]>[]} */
  get poses() { return this.shown && this.message?.revision === this.actions.revision() ? this.message.poses : []; }

  /** @param {Page} page */
  bind(page) {
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow), { canvas } = page.scene;
    const pixel = (/** @type {MouseEvent} */ event) => { const { left, top } = canvas.getBoundingClientRect(); return /** @type {[number, number]} */ ([event.clientX - left, event.clientY - top]); };
    view.addEventListener("pointermove", (event) => this.mark(event.target === canvas && this.actions.selects() ? this.at(page, pixel(event)) : -1), true);
    view.addEventListener("pointerdown", (event) => {
      if (event.target !== canvas || event.button !== 0 || event.shiftKey || !this.actions.selects() || page.scene.painter.hit(pixel(event))) return;
      const k = this.at(page, pixel(event));
      if (k < 0) return;
      event.stopImmediatePropagation();
      this.take(k);
    }, true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => this.draw(ctx, page));
  }

  /** Outlines of the bodies of a configuration [pixels]. @param {Page} page @param {Record<string, number[]>} poses @returns {[number, number][][]} */
  outlines({ motion, scene }, poses) {
    return motion.bodies.flatMap((/** @type {any} */ body) => {
      const pose = poses[body.name];
      if (!pose) return [];
      const [x, y, a = 0] = pose, [c, s] = [Math.cos(a), Math.sin(a)];
      return body.shapes.map((/** @type {any} */ shape) => motion.outline(shape).map((/** @type {any} */ [u, v]) => scene.view.screen([x + c * u - s * v, y + s * u + c * v])));
    });
  }

  /** Configuration at a pixel; -1 without one. @param {Page} page @param {[number, number]} pixel */
  at(page, [u, v]) {
    let [best, nearest] = [-1, CATCH];
    this.poses.forEach((poses, k) => {
      for (const corners of this.outlines(page, poses)) for (let i = 0; i < corners.length; i++) {
        const [[ax, ay], [bx, by]] = [corners[i], corners[(i + 1) % corners.length]], square = (bx - ax) ** 2 + (by - ay) ** 2 || 1;
        const along = Math.min(1, Math.max(0, ((u - ax) * (bx - ax) + (v - ay) * (by - ay)) / square)), away = Math.hypot(ax + along * (bx - ax) - u, ay + along * (by - ay) - v);
        if (away < nearest) [best, nearest] = [k, away];
      }
    });
    return best;
  }

  /** Write the poses of a configuration as those from which the assembly starts. @param {number} k */
  take(k) {
    const poses = this.poses[k], bodies = this.actions.document()?.bodies ?? {}, formulas = /** @type {string[]} */ ([]);
    if (!poses) return;
    const operations = Object.entries(poses).flatMap(([name, [x, y, angle]]) => {
      const entry = bodies[name], { position } = entry ?? {};
      if (!entry) return [];
      const set = (/** @type {(string | number)[]} */ keys, /** @type {unknown} */ old, /** @type {unknown} */ value) => {
        if (typeof old === "string" && !NUMBER.test(old)) formulas.push(`${keys[0]} of ${name} (${old})`);
        return { op: "set", keys: ["bodies", name, ...keys], value };
      };
      const place = Array.isArray(position) ? [set(["position", 0], position[0], neat(x)), set(["position", 1], position[1], neat(y))] : [set(["position"], position, [neat(x), neat(y)])];
      return [...place, ...(angle === undefined ? [] : [set(["angle"], entry.angle, neat(angle))])];
    });
    if (formulas.length) this.actions.refuse(`the initial pose is a formula: ${formulas.slice(0, 3).join(", ")}; write a number there to take another configuration`);
    else if (operations.length) this.actions.edit("take another configuration", operations);
  }

  /** @param {CanvasRenderingContext2D} ctx @param {Page} page */
  draw(ctx, page) {
    if (!this.poses.length || !("s" in page.scene.view)) return;
    const style = getComputedStyle(document.documentElement), colour = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
    ctx.save();
    this.poses.forEach((poses, k) => {
      [ctx.strokeStyle, ctx.lineWidth, ctx.lineJoin, ctx.globalAlpha] = [colour(k === this.near ? "--accent" : "--muted"), k === this.near ? 3 : 2, "round", k === this.near ? 0.9 : 0.45];
      ctx.setLineDash(k === this.near ? [] : [5, 5]);
      for (const corners of this.outlines(page, poses)) {
        ctx.beginPath();
        for (const corner of corners) ctx.lineTo(...corner);
        if (corners.length > 2) ctx.closePath();
        ctx.stroke();
      }
    });
    ctx.restore();
  }
}
