// A guided first build: a four-bar in two minutes, step by step.

/** @import { Document } from "./types.d.ts" */

import { button, el } from "./dom.js";

/** State of the page as steps see it. @typedef {{ document: Document | null, tool: string, undo: string, changed: boolean, path: string }} Now */
/** A step: what to do, the part of the page for it, and whether it is done. @typedef {{ text: string, target: string, done: (now: Now) => boolean }} Step */

const KEY = "guide";
const entries = (/** @type {Now} */ { document }, /** @type {string} */ section) => Object.values(document?.[section] ?? {});
const bars = (/** @type {Now} */ now) => entries(now, "bodies").filter(({ type }) => type === "Bar").length;
const joints = (/** @type {Now} */ now, /** @type {boolean} */ ground) => entries(now, "joints").filter(({ type, connect }) => type === "Revolute" && JSON.stringify(connect ?? []).includes('"ground') === ground).length;

/** @type {Step[]} */
export const STEPS = [
  { text: "Choose the tool Bar: click it, or press B.", target: '[data-tool="bar"]', done: (now) => now.tool === "bar" || bars(now) > 0 },
  { text: "Draw the crank: click its start on the left, then its end above it, about 0.2 m away.", target: "#canvas", done: (now) => bars(now) > 0 },
  { text: "Draw the coupler: click the end of the crank, then a place on the right and above it, about 0.6 m away. Ends on one point are joined.", target: "#canvas", done: (now) => bars(now) > 1 && joints(now, false) > 0 },
  { text: "Draw the rocker: click the end of the coupler, then a place below it, on the height of the start of the crank.", target: "#canvas", done: (now) => bars(now) > 2 && joints(now, false) > 1 },
  { text: "Choose Pin (O), and click the two free ends: they are pinned to the ground.", target: '[data-tool="pin"]', done: (now) => joints(now, true) > 1 },
  { text: "Choose Motor (M), and click the pin of the crank. The linkage moves.", target: '[data-tool="motor"]', done: (now) => entries(now, "drivers").length > 0 },
  { text: "Choose Select (V), and drag the joint of coupler and rocker. The motion follows while you drag.", target: '[data-tool="select"]', done: (now) => now.undo.startsWith("move") || Object.keys(now.document?.parameters ?? {}).length > 0 },
  { text: "Click the number of a length in the text, and press Parameter: it becomes a slider of the picture.", target: "#make-parameter", done: (now) => Object.keys(now.document?.parameters ?? {}).length > 0 },
  { text: "Save the model with Save, under a name that ends with .toml.", target: "#save", done: (now) => Boolean(now.path) && !now.changed },
];

export class Guide {
  /** @param {HTMLElement} parent whose last child, the problems, it precedes @param {() => Now} now */
  constructor(parent, now) {
    this.now = now;
    this.card = el("aside", { class: "guide card", hidden: true, "aria-label": "Guided first build" });
    parent.insertBefore(this.card, parent.lastElementChild);
    /** Step that is shown; -1 for none. */
    this.step = -1;
    const kept = localStorage.getItem(KEY);
    /** Whether the guide is offered while nothing is drawn. */
    this.offered = kept === null;
    if (kept !== null && /^\d+$/.test(kept)) this.show(Number(kept));
  }

  /** Offer the guide while nothing is drawn. */
  offer() {
    const now = this.now(), empty = now.document !== null && !["bodies", "elements", "meshes"].some((section) => entries(now, section).length);
    this.card.hidden = !empty;
    if (!empty || this.card.childElementCount) return;
    this.card.replaceChildren(el("p", {}, el("b", {}, "New here?"), " Draw a four-bar linkage in two minutes."), el("div", { class: "chips" }, button("Not now", () => this.leave()), button("Show me", () => this.start(), { class: "button primary" })));
  }

  /** Begin, or go on where it was left. */
  start() {
    const at = STEPS.findIndex((step) => !step.done(this.now()));
    this.show(at < 0 ? 0 : at);
  }

  leave() {
    this.offered = false;
    localStorage.setItem(KEY, "left");
    this.step = -1;
    this.card.hidden = true;
    this.point("");
  }

  /** @param {number} step */
  show(step) {
    [this.step, this.offered] = [step, false];
    localStorage.setItem(KEY, String(step));
    this.card.hidden = false;
    const end = step >= STEPS.length;
    this.point(end ? "" : STEPS[step].target);
    const text = end ? "This is a four-bar of your own. Keys are listed by ?, and the examples under Open." : STEPS[step].text;
    this.card.replaceChildren(el("p", { role: "status" }, el("b", {}, end ? "Done. " : `${step + 1} of ${STEPS.length}. `), text), el("div", { class: "chips" }, !end && button("Skip", () => this.show(step + 1)), button(end ? "Close" : "Leave", () => this.leave())));
  }

  /** Go on when the action of the step is done. */
  check() {
    if (this.offered) this.offer();
    if (this.step < 0 || this.step >= STEPS.length) return;
    let step = this.step;
    while (step < STEPS.length && STEPS[step].done(this.now())) step++;
    if (step !== this.step) this.show(step);
  }

  /** Mark a part of the page. @param {string} selector */
  point(selector) {
    for (const node of document.querySelectorAll(".guided")) node.classList.remove("guided");
    if (selector) document.querySelector(selector)?.classList.add("guided");
  }
}
