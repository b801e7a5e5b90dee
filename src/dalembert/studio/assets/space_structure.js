// Spatial structures in the studio: drawing tools on working planes, selection, nodes moved by a gizmo.

/** @import { Completion } from "./completion.js" */
/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Pixel, SpacePlace } from "./space_places.js" */
/** @import { Grip, Handle } from "./space_gizmo.js" */
/** @import { Vec } from "./space_math.js" */
/** @import { SpaceTarget } from "./space_plan.js" */
/** @import { Part } from "./structure.js" */
/** @import { Document } from "./types.d.ts" */

import { neat } from "./neat.js";
import { isTyped, takePointer } from "./picture_events.js";
import { isOutside } from "./pictures.js";
import { valuesAfter } from "./preview.js";
import { grip, handleAt, handles, pulled } from "./space_gizmo.js";
import { AXES, minus, size, times } from "./space_math.js";
import { spaceSnap } from "./space_places.js";
import { SpacePlan } from "./space_plan.js";
import { answer, command } from "./space_structure_keys.js";
import { drawSpaceStructure } from "./space_structure_overlay.js";
import { SpaceStructurePalette } from "./space_structure_palette.js";
import { SPACE_STRUCTURE_TOOLS, typedForce } from "./space_structure_tools.js";
import { StructureProperties } from "./structure_properties.js";

/** Movement of the pointer up to which a press is a click, and distance at which it takes hold [px]. */
const STILL = 4, REACH = 11;
const NO_ROTATION = "Moment: a node of a solid has no rotation; draw forces in pairs, or a beam that ends at the solid";

export class SpaceStructure {
  /** @param {Pictures} pictures @param {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void, commands: import("./command_queue.js").CommandQueue }} actions @param {HTMLElement} stage @param {HTMLElement} writing @param {() => Completion | null} completion */
  constructor(pictures, actions, stage, writing, completion) {
    this.pictures = pictures;
    this.actions = actions;
    this.tool = SPACE_STRUCTURE_TOOLS[0];
    /** The shown picture, if it is spatial. @type {Page | null} */
    this.boundPage = null;
    /** @type {Document | null} */
    this.document = null;
    /** @type {SpacePlan | null} */
    this.plan = null;
    /** Nodes that were added since the last text. @type {Map<string, Vec>} */
    this.claimed = new Map();
    /** Places clicked so far, and that under the pointer. @type {SpacePlace[]} */
    this.places = [];
    /** @type {SpacePlace | null} */
    this.now = null;
    /** What the first click was on, and what is under the pointer. @type {SpaceTarget | null} */
    this.target = null;
    /** @type {SpaceTarget | null} */
    this.hover = null;
    /** @type {Part[]} */
    this.selection = [];
    /** Handle of the gizmo under the pointer, and the one that is held. @type {Handle | null} */
    this.handle = null;
    /** @type {Grip | null} */
    this.held = null;
    /** Parameters when the gizmo was taken. @type {number[]} */
    this.values = [];
    /** Pixel of the last press. @type {Pixel | null} */
    this.pressed = null;
    /** Numbers that are being typed. */
    this.typed = "";
    this.palette = new SpaceStructurePalette(stage, { choose: (name) => this.choose(name), change: () => this.refresh(), through: () => this.pose?.p ?? null });
    this.properties = new StructureProperties(writing, /** @type {any} */ (this), completion);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** Whether the text is a spatial structure; before its first picture it is drawn by keys, without a `boundPage`. */
  get possible() { return Boolean(this.plan && this.pictures.page); }

  /** Place of the selected node. */
  get pose() {
    const [part] = this.selection, p = this.selection.length === 1 && part.section === "points" ? this.plan?.nodes.get(part.name) : null;
    return p ? { p, q: [1, 0, 0, 0] } : null;
  }

  /** Handles of the gizmo: arrows and planes. */
  get handles() { return this.pose ? handles(this.pose, false, Object.values(AXES)) : []; }

  /** @returns {import("./space_structure_tools.js").SpaceSetting} */
  get setting() { return { ...this.palette.settings, plane: this.palette.plane, plan: /** @type {SpacePlan} */ (this.plan), document: this.document ?? {}, claimed: this.claimed }; }

  /** The contents of the last text. @param {Document | null} document */
  show(document) {
    this.document = document && /** @type {unknown} */ (document.kind) === "structure" && SpacePlan.isSpatial(document) ? document : null;
    this.plan = this.document && new SpacePlan(this.document, this.boundPage);
    this.claimed.clear();
    this.selection = this.selection.filter(({ section, name }) => (section === "points" ? this.plan?.nodes.has(name) : this.document?.[section]?.[name] !== undefined));
    this.palette.node.hidden = !this.possible;
    this.properties.show();
    this.refresh();
  }

  /** @param {Page} page */
  bind(page) {
    this.boundPage = page.motion.dimension === 3 && !("s" in page.scene.view) ? page : null;
    if (this.document) this.plan = new SpacePlan(this.document, this.boundPage);
    this.palette.node.hidden = !this.possible;
    [this.held, this.handle] = [null, null];
    this.properties.show();
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    view.addEventListener("keydown", (event) => this.key(event), true);
    if (!this.boundPage) return;
    takePointer(page, view, () => this.boundPage === page && this.possible, () => this.held !== null, {
      pointerdown: (event, at) => this.down(event, at), pointermove: (event, at) => this.over(event, at), pointerup: (event, at) => this.up(event, at),
      dblclick: () => this.tool.name !== "select",
    });
    view.addEventListener("pointercancel", () => this.revert(), true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => { if (this.possible && this.boundPage === page) drawSpaceStructure(ctx, this); });
    if (this.possible && this.document && !page.motion.mesh) page.scene.show.grid = true;
    this.refresh();
  }

  /** @param {string} name */
  choose(name) {
    this.tool = SPACE_STRUCTURE_TOOLS.find((tool) => tool.name === name) ?? SPACE_STRUCTURE_TOOLS[0];
    [this.places, this.now, this.typed, this.target, this.hover] = [[], null, "", null, null];
    if (this.tool.name !== "select") this.select([]);
    this.palette.show(this.tool.name);
    this.refresh();
  }

  /** @param {Part[]} parts */
  select(parts) {
    this.selection = parts;
    const [part] = parts;
    if (parts.length === 1) this.actions.select(part.section === "points" ? "nodes" : part.section, part.name);
    this.properties.show();
    this.refresh();
  }

  // Pointer --------------------------------------------------------------------------------------

  /** @param {{ altKey: boolean, shiftKey: boolean }} event @param {Pixel} at @returns {SpacePlace | null} */
  placeAt(event, at) {
    const page = /** @type {Page} */ (this.boundPage), plan = /** @type {SpacePlan} */ (this.plan), from = this.places.at(-1)?.p ?? null, { plane } = this.palette, k = "xyz".indexOf(plane.axis);
    const through = from ? { ...plane, origin: plane.origin.map((v, i) => (i === k ? from[k] : v)) } : plane;
    return spaceSnap(plan.asPage(page), at, through, { free: event.altKey, from, lift: event.shiftKey && from !== null });
  }

  /** @param {PointerEvent} event @param {Pixel} at */
  down(event, at) {
    this.pressed = event.button === 0 ? at : null;
    const page = this.boundPage, { pose } = this, handle = page && pose && event.button === 0 ? handleAt(page, pose, this.handles, at) : null;
    if (!page || !pose || !handle) return false;
    this.held = grip(page, pose, handle, at);
    this.values = [...(page.design?.values ?? [])];
    page.scene.view.fitted = false;  // the drawing stays below the pointer
    page.scene.canvas.setPointerCapture?.(event.pointerId);
    this.refresh();
    return true;
  }

  /** @param {PointerEvent} event @param {Pixel} at */
  over(event, at) {
    const page = this.boundPage;
    if (!page) return false;
    if (this.held) {
      this.held = pulled(page, this.held, at, event.altKey);
      this.preview();
      return true;
    }
    if (this.tool.name === "select") {
      const { pose, handle } = this;
      this.handle = pose && !event.buttons ? handleAt(page, pose, this.handles, at) : null;
      if (handle !== this.handle) this.refresh();
      return this.handle !== null;
    }
    if (!event.buttons) {
      this.now = this.placeAt(event, at) ?? this.now;
      this.hover = this.tool.target && !this.places.length ? this.plan?.targetAt(page, at, REACH, this.tool.target, true) ?? null : null;
    }
    this.refresh();
    return false;
  }

  /** @param {PointerEvent} event @param {Pixel} at */
  up(event, at) {
    const { held, pressed } = this, still = pressed && size([at[0] - pressed[0], at[1] - pressed[1]]) < STILL;
    this.pressed = null;
    if (held) this.release(held);
    else if (still && this.tool.name === "select") this.pick(event, at);
    else if (still) this.put(this.placeAt(event, at), at);
    return held !== null;
  }

  /** @param {PointerEvent} event @param {Pixel} at */
  pick(event, at) {
    const target = this.plan?.targetAt(/** @type {Page} */ (this.boundPage), at, REACH, "both"), part = target && { section: target.kind === "node" ? "points" : "elements", name: target.name };
    const has = part && this.selection.some(({ section, name }) => section === part.section && name === part.name);
    if (!part) return event.shiftKey || this.select([]);
    this.select(event.shiftKey ? (has ? this.selection.filter(({ name }) => name !== part.name) : [...this.selection, part]) : [part]);
  }

  // Changes --------------------------------------------------------------------------------------

  /** Add a place to what is being drawn. @param {SpacePlace | null} place @param {Pixel} [at] */
  put(place, at) {
    const { tool, plan, boundPage } = this;
    if (!place || !plan) return;
    if (tool.target && !this.places.length) {
      const pixel = at ?? boundPage?.scene.view.screen(place.p), exact = at || tool.target === "bars" ? null : plan.targetAtPlace(place.p);
      this.target = exact ?? (boundPage && pixel ? plan.targetAt(boundPage, pixel, REACH, tool.target, true) : null);
      if (this.target?.solid && tool.name === "torque") return this.actions.refuse(NO_ROTATION);
      if (!this.target) return this.actions.refuse(`${tool.title}: ${tool.hint[0]}`);
      if (this.target.kind === "element") place = { ...place, p: this.middle(this.target) };
      else place = { ...place, p: this.target.spots[0] };
    }
    this.places.push(place);
    if (this.places.length === tool.clicks) this.finish();
    this.typed = "";
    this.refresh();
  }

  /** @param {SpaceTarget} target */
  middle({ spots: [from, to] }) { return from.map((v, k) => (v + to[k]) / 2); }

  finish() {
    const { places, tool, target, typed } = this, [from, to] = places, { size: usual, units } = tool.units?.(target) ?? { size: 1, units: {} };
    this.places = tool.chain ? places.slice(-1) : [];
    const way = to && !tool.scalar && size(minus(to.p, from.p)) > 0 ? minus(to.p, from.p) : tool.scalar ? [0, 0, 1] : times(this.palette.plane.normal, -1), along = times(way, 1 / size(way));
    const vector = tool.units && typed ? typedForce(typed, units, along) : times(along, usual);
    const fits = isOutside(this.boundPage, places.map(({ p }) => p));
    this.actions.commands.do(() => {
      const change = vector && tool.make(places, this.setting, target, vector.map((v) => (Math.abs(v) < 1e-12 * size(vector) ? 0 : v)));
      if (change) this.send(change, fits);
      else this.actions.refuse(`${tool.title}: ${tool.hint.join("; ")}`);
    }, false);
    this.target = null;
  }

  /** @param {Change} change @param {boolean} [fits] whether the view is fitted to what was drawn outside it */
  send(change, fits = false) {
    const view = this.boundPage?.scene.view;
    if (view) view.fitted = fits;  // the view stays while one draws
    this.actions.change(change);
  }

  /** Change by a movement of the selected node. @param {Grip} held @returns {Change | null} */
  moved({ before, after }) {
    const [part] = this.selection, operations = after.p.flatMap((v, k) => (v === before.p[k] ? [] : [{ op: "set", keys: ["nodes", part.name, k], value: neat(v) }]));
    return operations.length ? { label: `move ${part.name}`, operations } : null;
  }

  /** Let a live page compute what is moved. */
  preview() {
    const { held, document, boundPage: page, values } = this, design = page?.design;
    if (page && document && design && held && design.parameters.length === values.length) {
      const next = valuesAfter(page, document, values, this.moved(held)?.operations ?? []);
      if (next) design.replace(next, "drawing");
    }
    this.refresh();
  }

  /** Write a movement into the text. @param {Grip} held */
  release(held) {
    const change = this.moved(held);
    [this.held, this.pressed] = [null, null];
    if (change) this.send(change);
    this.refresh();
  }

  /** What is held is given up. */
  revert() {
    if (this.held) this.boundPage?.design?.replace(this.values, "drawing");
    this.held = null;
    this.refresh();
  }

  // Keys -----------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event */
  key(event) {
    if (!this.possible || isTyped(event) || event.altKey || event.defaultPrevented) return;
    if (event.ctrlKey || event.metaKey ? !command(this, event.key) : !answer(this, event.key)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.refresh();
  }

  refresh() {
    if (!this.possible) return;
    const { hint, title, name } = this.tool, page = this.boundPage;
    this.actions.hint(this.typed ? `${title}: ${this.typed}` : `${title}: ${hint[Math.min(this.places.length, hint.length - 1)]}`);
    if (!page) return;
    page.scene.invalidate();
    page.scene.canvas.style.cursor = this.held ? "grabbing" : this.handle ? "grab" : name === "select" ? "" : "crosshair";
  }
}
