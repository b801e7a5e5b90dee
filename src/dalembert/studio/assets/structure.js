// Planar structures in the studio: drawing tools, selection, dragging of nodes, vertices and loads.

/** @import { Completion } from "./completion.js" */
/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Drag } from "./structure_drag.js" */
/** @import { Spot, Target } from "./structure_plan.js" */
/** @import { Tip } from "./structure_tips.js" */
/** @import { Document } from "./types.d.ts" */

import { measured, short } from "./overlay.js";
import { isOutside } from "./pictures.js";
import { isTyped, takePointer } from "./picture_events.js";
import { placed, snap } from "./snapping.js";
import { changeOf, grasp, preview, release } from "./structure_drag.js";
import { answer, command } from "./structure_keys.js";
import { drawStructure } from "./structure_overlay.js";
import { StructurePalette } from "./structure_palette.js";
import { Plan } from "./structure_plan.js";
import { StructureProperties } from "./structure_properties.js";
import { tipAt } from "./structure_tips.js";
import { STRUCTURE_TOOLS, drawnVector, typedVector } from "./structure_tools.js";
import { typedPlace } from "./typed_numbers.js";

/** Distance within which the pointer takes hold [px], and up to which a press is a click. */
const REACH = 10, STILL = 3;

/** @typedef {{ section: string, name: string }} Part */

export class Structure {
  /** @param {Pictures} pictures @param {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void, commands: import("./command_queue.js").CommandQueue }} actions @param {HTMLElement} stage @param {HTMLElement} writing @param {() => Completion | null} completion */
  constructor(pictures, actions, stage, writing, completion) {
    this.pictures = pictures;
    this.actions = actions;
    this.tool = STRUCTURE_TOOLS[0];
    /** @type {Document | null} */
    this.document = null;
    /** @type {Plan | null} */
    this.plan = null;
    /** Nodes that were added since the last text. @type {Map<string, Spot>} */
    this.claimed = new Map();
    /** Places clicked so far, and that under the pointer. @type {Place[]} */
    this.places = [];
    /** @type {Place | null} */
    this.now = null;
    /** What the first click was on, and what is under the pointer. @type {Target | null} */
    this.target = null;
    /** @type {Target | null} */
    this.hover = null;
    /** Load whose tip is under the pointer. @type {Tip | null} */
    this.tip = null;
    /** @type {Drag | null} */
    this.drag = null;
    /** @type {Part[]} */
    this.selection = [];
    /** Numbers that are being typed. */
    this.typed = "";
    /** Nodes that move without strain. @type {string[]} */
    this.moving = [];
    /** Regions of the shown picture. @type {Record<string, unknown>} */
    this.picturedMeshes = {};
    this.palette = new StructurePalette(stage, (name) => this.choose(name));
    this.properties = new StructureProperties(writing, this, completion);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @returns {Page | null} */
  get page() { return this.pictures.page; }

  /** Whether the text is a planar structure, and its picture can be drawn on. */
  get possible() {
    const view = this.page?.scene.view;
    return Boolean(this.plan?.isPlanar && view && "s" in view);
  }

  /** Picture for snapping: nodes, corners, bars and outlines. @returns {Page | null} */
  get snapPage() { return this.page && this.plan ? this.plan.asPage(this.page) : null; }

  /** @returns {import("./structure_changes.js").Setting} */
  get setting() { return { ...this.palette.settings, plan: /** @type {Plan} */ (this.plan), document: this.document ?? {}, claimed: this.claimed }; }

  /** The contents of the last text. @param {Document | null} document */
  show(document) {
    const isStructure = /** @type {unknown} */ (document?.kind) === "structure";
    window.document.documentElement.dataset.structure = String(isStructure);
    this.document = isStructure ? document : null;
    this.plan = this.document && new Plan(this.document, this.page);
    this.claimed.clear();
    const { plan } = this, names = new Set(plan?.handles.map(({ name }) => name));
    this.selection = this.selection.filter(({ section, name }) => (section === "points" ? names.has(name) : section === "edges" || this.document?.[section]?.[name] !== undefined));
    if (!this.selection.length) this.target = this.places.length ? this.target : null;
    this.palette.node.hidden = !this.possible;
    this.properties.show();
    this.refresh();
  }

  /** Nodes that move without strain, of the last picture. @param {string[]} nodes */
  describe(nodes) {
    this.moving = nodes;
    this.refresh();
  }

  /** @param {Page} page */
  bind(page) {
    this.picturedMeshes = page.motion.mesh && this.document ? { ...this.document.meshes } : {};
    if (this.document) this.plan = new Plan(this.document, page);
    this.palette.node.hidden = !this.possible;
    this.properties.show();
    const { scene, player } = page, { canvas } = scene, view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    // Also in the picture of a mechanism: a structure opened after it is drawn on it until its own picture comes.
    takePointer(page, view, () => this.page === page && this.possible, () => this.drag !== null, {
      pointerdown: (event, at) => this.down(event, at), pointermove: (event, at) => this.over(event, at), pointerup: (event) => release(this, event),
      dblclick: () => this.tool.name !== "select",
    });
    view.addEventListener("keydown", (event) => this.key(event), true);
    scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => { if (this.possible && this.page === page) drawStructure(ctx, this); });
    if (!this.possible) return;
    const grid = /** @type {HTMLElement | null | undefined} */ (this.pictures.frame?.contentDocument?.getElementById("grid"));
    if (grid && !scene.show.grid) grid.click();
    if (!page.motion.mesh && scene.view.fitted) [scene.view.x, scene.view.y, scene.view.s, scene.view.fitted] = [2, 0.5, Math.max(60, canvas.clientWidth / 7), false];
    if (!this.moving.length) player.pause();
    this.refresh();
  }

  /** @param {string} name */
  choose(name) {
    this.tool = STRUCTURE_TOOLS.find((tool) => tool.name === name) ?? STRUCTURE_TOOLS[0];
    [this.places, this.drag, this.typed, this.target, this.hover, this.tip] = [[], null, "", null, null, null];
    if (this.tool.name !== "select") this.select([]);
    this.palette.show(this.tool.name);
    this.refresh();
  }

  /** @param {Part[]} parts @param {Target | null} [target] */
  select(parts, target = null) {
    this.selection = parts;
    this.target = target;
    const [part] = parts, section = part?.section === "points" ? (this.plan?.nodes.has(part.name) ? "nodes" : "meshes") : part?.section === "edges" ? "meshes" : part?.section;
    if (parts.length === 1) this.actions.select(section, section === "meshes" ? part.name.split(/[. ]/)[0] : part.name);
    this.properties.show();
    this.refresh();
  }

  // Pointer --------------------------------------------------------------------------------------

  /** Show one instant, in which places are selected. */
  rest() { this.page?.player.pause(); }

  /** @param {{ altKey: boolean }} event @param {Spot} pixel @returns {Place} */
  placeAt(event, pixel) {
    const page = /** @type {Page} */ (this.page), plan = /** @type {Plan} */ (this.plan), from = this.places.at(-1) ?? null;
    const ignore = this.drag?.kind === "handle" ? this.drag.handles.map(({ name }) => name) : [];
    const place = snap(plan.asPage(page), pixel, { from: this.tool.units ? null : from, free: event.altKey, ignore });
    const typed = this.typed && !(this.tool.units && from) ? typedPlace(this.typed, from, place) : null;
    return typed ? { ...placed(typed.x, typed.y), how: "typed" } : place;
  }

  /** @param {Spot} pixel @returns {Spot} */
  world(pixel) { return /** @type {Page} */ (this.page).scene.view.world(pixel); }

  /** Distance within which the pointer takes hold [m]. */
  get reach() { return REACH / /** @type {Page} */ (this.page).scene.view.s; }

  /** @param {PointerEvent} event @param {Spot} pixel */
  down(event, pixel) {
    if (event.button !== 0) return false;
    if (this.tool.name === "select") return grasp(this, event, pixel);
    const place = this.placeAt(event, pixel);
    this.put(place, place.how === "typed" ? [place.x, place.y] : this.world(pixel));
    return true;
  }

  /** Add a place to what is being drawn. @param {Place} place @param {Spot} [at] */
  put(place, at = [place.x, place.y]) {
    const { tool, plan, page } = this, first = this.places[0];
    if (!plan || !page) return;
    if (tool.target && !this.places.length) {
      this.target = this.targetAt(at);
      if (!this.target) return this.actions.refuse(`${tool.title}: ${tool.hint[0]}`);
    }
    const closes = tool.clicks === 0 && this.places.length > 2 && Math.hypot(place.x - first.x, place.y - first.y) * page.scene.view.s < 8;
    if (!closes) this.places.push(place);
    if (closes || this.places.length === tool.clicks) this.finish();
    this.typed = "";
    this.refresh();
  }

  /** What the tool can act on at a place. @param {Spot} at */
  targetAt(at) { return (this.tool.parts ? this.plan?.partAt(at, this.reach) : this.plan?.targetAt(at, this.reach, this.tool.bars)) ?? null; }

  finish() {
    const { places, tool, target } = this, [from, to] = places;
    this.places = tool.chain ? places.slice(-1) : [];
    /** @type {Spot | null} */
    let vector = null;
    if (tool.units && from && to) {
      const { size, units } = tool.units(target);
      const toward = /** @type {Spot} */ (tool.scalar ? [1, 0] : [to.x - from.x, to.y - from.y]), sense = tool.parts || to.x <= from.x ? 1 : -1;
      vector = this.typed ? typedVector(this.typed, units, toward) : tool.scalar ? [sense * size, 0] : drawnVector(from, to, size);
    }
    const fits = isOutside(this.page, places.map(({ x, y }) => [x, y]));
    this.actions.commands.do(() => {
      const change = tool.make(places, this.setting, target, vector);
      if (change) this.send(change, fits);
      else this.actions.refuse(`${tool.title}: ${tool.hint.join("; ")}`);
    }, false);
    this.target = null;
  }

  /** @param {Change} change @param {boolean} [fits] whether the view is fitted to what was drawn outside it */
  send(change, fits = false) {
    const view = this.page?.scene.view;
    if (view) view.fitted = fits;  // the view stays while one draws
    this.actions.change(change);
  }

  /** @param {PointerEvent} event @param {Spot} pixel */
  over(event, pixel) {
    if (event.buttons > 1) return false;
    const { drag, tool } = this, page = /** @type {Page} */ (this.page);
    const place = this.placeAt(event, pixel), [x, y] = this.world(pixel);
    this.now = place;
    if (drag) {
      drag.to = drag.kind === "handle" ? place : placed(x, y);
      drag.moved ||= Math.hypot(x - drag.from.x, y - drag.from.y) * page.scene.view.s > STILL;
      if (drag.moved && drag.kind !== "box") preview(this, drag);
    } else if (tool.name === "select") {
      const tip = event.buttons || !this.document ? null : tipAt(page, this.document, pixel), changed = tip?.index !== this.tip?.index;
      this.tip = tip;
      if (changed) this.refresh();
      return false;
    } else this.hover = tool.target && !this.places.length ? this.targetAt([x, y]) : null;
    page.scene.pointer = null;  // no tip over what is drawn
    this.refresh();
    return event.buttons === 1;
  }

  /** Lines beside the pointer. @param {Place} at @returns {string[]} */
  readout(at) {
    const { tool, places, drag, target, typed } = this;
    if (typed) return [`${typed}▏`, at.how];
    if (drag?.tip) {
      const change = changeOf(this, drag), values = change?.operations.map(({ value }) => Number(value)) ?? [];
      return [`${short(Math.hypot(...values))} N`];
    }
    if (tool.units && target && places.length) return [tool.title === "Moment" ? "left: positive, right: negative" : `${short(tool.units(target).size)} ${target.kind === "edge" && tool.bars ? "Pa" : tool.bars ? (target.kind === "element" ? "N/m" : "N") : tool.parts ? "K" : "m"}; or type a value`, `on ${target.name}`];
    if (tool.target) return [this.hover ? `on ${this.hover.name}` : tool.hint[0]];
    const from = places.at(-1);
    return [from ? measured(from, at) : `${short(at.x)}, ${short(at.y)} m`, at.how];
  }

  // Keys -----------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event */
  key(event) {
    if (!this.possible || isTyped(event) || event.defaultPrevented || event.altKey) return;
    if (event.ctrlKey || event.metaKey ? !command(this, event.key) : !answer(this, event)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.refresh();
  }

  refresh() {
    if (!this.possible) return;
    const { hint, title, name } = this.tool, page = /** @type {Page} */ (this.page);
    this.actions.hint(`${title}: ${hint[Math.min(this.places.length, hint.length - 1)]}`);
    page.scene.invalidate();
    page.scene.canvas.style.cursor = name === "select" ? (this.tip ? "grab" : "") : "crosshair";
  }
}
