// Drawing on the picture: tools, snapping, selection.

/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { move, otherEnd, remove, sectionOf } from "./operations.js";
import { stillPage, valuesAfter } from "./preview.js";
import { elementAt, inBody, namedPlaces, snap } from "./snapping.js";
import { TOOLS } from "./tools.js";

export class Drawing {
  /** @param {Pictures} pictures @param {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void, onTool: (name: string) => void }} actions */
  constructor(pictures, actions) {
    this.pictures = pictures;
    this.actions = actions;
    this.tool = TOOLS[0];
    /** @type {Document | null} */
    this.document = null;
    /** Places clicked so far. @type {Place[]} */
    this.places = [];
    /** Place under the pointer. @type {Place | null} */
    this.now = null;
    /** Place that is being dragged, and where to; the page before, and the values of its parameters. @type {{ from: Place, to: Place, moved: boolean, still: Page, values: number[] } | null} */
    this.drag = null;
    /** Selected element. @type {string | null} */
    this.selected = null;
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @returns {Page | null} */
  get page() { return this.pictures.page; }

  /** Whether the picture is a planar mechanism that can be drawn on. */
  get possible() {
    const view = this.page?.scene.view;
    return Boolean(view && "s" in view && !this.page?.motion.mesh && !this.page?.motion.swings);
  }

  /** @param {string} name */
  choose(name) {
    this.tool = TOOLS.find((tool) => tool.name === name) ?? TOOLS[0];
    this.places = [];
    this.drag = null;
    if (this.tool.name !== "select") this.rest();
    this.actions.onTool(this.tool.name);
    this.refresh();
  }

  /** Show the position at the start, to which the file refers. */
  rest() {
    const { page } = this;
    if (!page) return;
    page.player.pause();
    page.player.seek(page.motion.start);
  }

  /** @param {Page} page */
  bind(page) {
    const { canvas } = page.scene, view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    const pixel = (/** @type {PointerEvent} */ event) => { const { left, top } = canvas.getBoundingClientRect(); return /** @type {[number, number]} */ ([event.clientX - left, event.clientY - top]); };
    const on = (/** @type {string} */ kind, /** @type {(event: PointerEvent, at: [number, number]) => boolean} */ act) => view.addEventListener(kind, (event) => {
      if ((event.target !== canvas && !this.drag) || !this.possible) return;
      if (act(/** @type {PointerEvent} */ (event), pixel(/** @type {PointerEvent} */ (event)))) event.stopImmediatePropagation();
    }, true);
    on("pointerdown", (event, at) => this.down(event, at));
    on("pointermove", (event, at) => this.over(event, at));
    on("pointerup", (event, at) => this.up(event, at));
    on("dblclick", () => this.tool.name !== "select");
    view.addEventListener("keydown", (event) => this.key(event), true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => this.draw(ctx));
    if (this.tool.name !== "select") this.rest();
    this.refresh();
  }

  /** @param {PointerEvent} event @param {[number, number]} at @returns {Place} */
  placeAt(event, at) {
    const page = /** @type {Page} */ (this.page), ignore = this.drag?.from.names ?? [];
    const from = this.places.at(-1) ?? null, place = snap(page, at, { from, free: event.altKey, ignore });
    if (!place.names.length && this.tool.onBody && !this.places.length) {
      const hit = elementAt(page, at);
      if (hit && this.document?.bodies?.[hit.name]) return { ...place, body: hit.name, local: inBody(page, hit.name, place.x, place.y), how: `on ${hit.name}` };
    }
    return place;
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  down(event, at) {
    if (event.button !== 0) return false;
    if (this.tool.name === "select") return this.grasp(event, at);
    const place = this.placeAt(event, at), first = this.places[0];
    const closes = this.tool.clicks === 0 && this.places.length > 2 && Math.hypot(place.x - first.x, place.y - first.y) * /** @type {Page} */ (this.page).scene.view.s < 8;
    if (!closes) this.places.push(place);
    if (closes || this.places.length === this.tool.clicks) this.finish();
    this.refresh();
    return true;
  }

  /** Begin to drag a point, or select an element. @param {PointerEvent} event @param {[number, number]} at */
  grasp(event, at) {
    const page = /** @type {Page} */ (this.page), resting = !page.player.playing && page.player.time === page.motion.start, place = snap(page, at);
    const hit = elementAt(page, at);
    this.selected = hit && this.document && sectionOf(this.document, hit.name) ? hit.name : null;
    if (this.selected && this.document) this.actions.select(/** @type {string} */ (sectionOf(this.document, this.selected)), this.selected);
    if (place.names.length) {
      this.rest();
      this.drag = resting ? { from: place, to: place, moved: false, still: stillPage(page), values: [...(page.design?.values ?? [])] } : null;
    }
    this.refresh();
    return place.names.length > 0;
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  over(event, at) {
    if (this.drag) {
      const to = this.placeAt(event, at);
      this.drag = { ...this.drag, to, moved: this.drag.moved || Math.hypot(to.x - this.drag.from.x, to.y - this.drag.from.y) > 0 };
      this.preview(this.drag);
      this.refresh();
      return true;
    }
    if (this.tool.name === "select") return false;
    this.now = this.placeAt(event, at);
    this.refresh();
    return event.buttons === 1;
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  up(event, at) {
    const { drag, page, document } = this;
    this.drag = null;
    if (!drag || !page || !document) return this.tool.name !== "select";
    const change = drag.moved && move(drag.still, document, drag.from, drag.to);
    if (change) this.actions.change(change);
    this.refresh();
    return true;
  }

  /** Let a live page compute the position to which a point is dragged. @param {NonNullable<Drawing["drag"]>} drag */
  preview({ from, to, still, values }) {
    const { page, document } = this, design = page?.design;
    if (!page || !document || design?.parameters.length !== values.length) return;
    const change = move(still, document, from, to), next = change && valuesAfter(page, document, values, change.operations);
    if (next) design.replace(next, "drawing");
  }

  finish() {
    const change = this.tool.make(this.places, this);
    this.places = [];
    if (change) this.actions.change(change);
    else this.actions.refuse(`${this.tool.title}: ${this.tool.hint[0]}`);
    this.refresh();
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const typing = /** @type {HTMLElement} */ (event.target)?.closest?.("input, select, textarea, .cm-editor, dialog");
    if (!this.possible || typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const { key } = event;
    if (key === "Escape") {
      if (this.drag) this.page?.design?.replace(this.drag.values, "drawing");
      if (this.places.length || this.drag) [this.places, this.drag] = [[], null];
      else this.choose("select");
    } else if (key === "Enter" && this.tool.clicks === 0 && this.places.length > 2) this.finish();
    else if ((key === "Delete" || key === "Backspace") && this.selected && this.document) {
      const change = remove(this.document, this.selected);
      this.selected = null;
      if (change) this.actions.change(change);
    } else {
      const tool = TOOLS.find((item) => item.key === key);
      if (!tool) return;
      this.choose(tool.name);
    }
    event.preventDefault();
    event.stopImmediatePropagation();
    this.refresh();
  }

  refresh() {
    if (!this.possible) return;
    const { hint } = this.tool, step = Math.min(this.places.length, hint.length - 1);
    this.actions.hint(this.possible ? `${this.tool.title}: ${hint[step]}` : "");
    this.page?.scene.invalidate();
    const canvas = this.page?.scene.canvas;
    if (canvas) canvas.style.cursor = this.tool.name === "select" ? "" : "crosshair";
  }

  /** @param {CanvasRenderingContext2D} ctx */
  draw(ctx) {
    const { page } = this;
    if (!page || !this.possible) return;
    const style = getComputedStyle(document.documentElement), accent = style.getPropertyValue("--accent").trim(), { view } = page.scene;
    const mark = (/** @type {{ x: number, y: number }} */ place, /** @type {number} */ radius) => {
      const [x, y] = view.screen([place.x, place.y]);
      ctx.beginPath();
      ctx.arc(x, y, radius, 0, 2 * Math.PI);
      ctx.stroke();
    };
    const line = (/** @type {{ x: number, y: number }[]} */ places) => {
      ctx.beginPath();
      for (const place of places) ctx.lineTo(.../** @type {[number, number]} */ (view.screen([place.x, place.y])));
      ctx.stroke();
    };
    ctx.save();
    [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth, ctx.font] = [accent, accent, 2, "12px system-ui, sans-serif"];
    if (this.tool.name !== "select") for (const place of namedPlaces(page)) mark(place, 4);
    const chain = this.now && this.places.length ? [...this.places, this.now] : this.places;
    ctx.setLineDash([6, 4]);
    line(chain);
    if (this.drag?.moved) for (const name of this.drag.from.names) {
      const [body, point] = name.split("."), other = this.document?.bodies?.[body]?.type === "Bar" && otherEnd(page, body, point);
      if (other) line([other, this.drag.to]);
    }
    ctx.setLineDash([]);
    const last = this.drag?.to ?? (this.tool.name === "select" ? null : this.now);
    if (last) {
      mark(last, last.names.length ? 8 : 4);
      const from = this.places.at(-1), [x, y] = view.screen([last.x, last.y]);
      const size = from ? ` ${Number(Math.hypot(last.x - from.x, last.y - from.y).toPrecision(4))} m` : ` (${Number(last.x.toPrecision(4))}, ${Number(last.y.toPrecision(4))})`;
      ctx.fillText(`${last.how}${size}`, x + 12, y - 10);
    }
    ctx.restore();
  }
}
