// Spatial models in the studio: selection, gizmo, drawing tools.

/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Change } from "./operations.js" */
/** @import { Pose } from "./space_poses.js" */
/** @import { Pixel, SpacePlace } from "./space_places.js" */
/** @import { Choice } from "./space_targets.js" */
/** @import { Setting } from "./space_tools.js" */
/** @import { Grip, Handle } from "./space_gizmo.js" */
/** @import { Document } from "./types.d.ts" */

import { isSpatialMechanism } from "./model_dimension.js";
import { ModelTree } from "./model_tree.js";
import { sectionOf } from "./selection.js";
import { isTyped, takePointer } from "./picture_events.js";
import { isOutside } from "./pictures.js";
import { AXES } from "./space_math.js";
import { grip, handleAt, handles, pulled } from "./space_gizmo.js";
import { answer } from "./space_keys.js";
import { drawOver } from "./space_overlay.js";
import { SpacePalette } from "./space_palette.js";
import { previewPull, writePull } from "./space_pull.js";
import { settleAtStart, spaceSnap } from "./space_places.js";
import { Poses, stillPoses } from "./space_poses.js";
import { axesOf, isStated, poseOf, rotates } from "./space_targets.js";
import { SPACE_TOOLS } from "./space_tools.js";

/** Movement of the pointer up to which a press is a click [px]. */
const STILL = 4;

export class Space {
  /** @param {Pictures} pictures @param {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void, commands: import("./command_queue.js").CommandQueue }} actions @param {HTMLElement} stage */
  constructor(pictures, actions, stage) {
    /** The shown picture, if it is spatial. @type {Page | null} */
    this.boundPage = null;
    this.pictures = pictures;
    this.actions = actions;
    this.tool = SPACE_TOOLS[0];
    /** @type {Document | null} */
    this.document = null;
    /** Poses of the shown picture. @type {Poses | null} */
    this.poses = null;
    /** Places clicked so far, and that under the pointer. @type {SpacePlace[]} */
    this.places = [];
    /** @type {SpacePlace | null} */
    this.now = null;
    /** @type {Choice | null} */
    this.selected = null;
    /** Names of hidden bodies. @type {Set<string>} */
    this.hidden = new Set();
    /** Whether the gizmo has the axes of the element. */
    this.local = false;
    /** Handle under the pointer, and the one that is held. @type {Handle | null} */
    this.hover = null;
    /** @type {Grip | null} */
    this.held = null;
    /** Poses and parameters when the gizmo was taken. @type {{ poses: Poses, values: number[] } | null} */
    this.still = null;
    /** Pixel of the last press. @type {Pixel | null} */
    this.pressed = null;
    /** Characters typed as coordinates of the next place. */
    this.typed = "";
    this.tree = new ModelTree({
      select: (choice) => this.select(choice), edit: (label, operations) => actions.change({ label, operations }),
      hide: (name) => this.hide([...this.hidden].includes(name) ? [...this.hidden].filter((other) => other !== name) : [...this.hidden, name]),
      isolate: (name) => this.hide(Object.keys(this.document?.bodies ?? {}).filter((other) => other !== name)), showAll: () => this.hide([]),
    });
    this.palette = new SpacePalette(stage, { choose: (name) => this.choose(name), change: () => this.refresh(), through: () => this.pose?.p ?? null });
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @returns {Page | null} */
  get page() { return this.pictures.page; }

  /** Whether the picture is a spatial mechanism that can be drawn on. */
  get possible() { return Boolean((!this.document || isSpatialMechanism(this.document)) && this.poses && this.poses.page === this.boundPage && !this.boundPage?.motion.mesh && !this.boundPage?.motion.swings); }

  /** Whether the picture shows the position at the start, to which the file refers. */
  get resting() { return Boolean(this.boundPage && !this.boundPage.player.playing && this.boundPage.player.time === this.boundPage.motion.start); }

  /** Pose of the selected element. @returns {Pose | null} */
  get pose() { return this.poses && this.document && this.selected ? poseOf(this.poses, this.document, this.selected) : null; }

  /** Handles of the gizmo. */
  get handles() {
    const pose = this.pose, { document, selected } = this;
    return pose && document && selected ? handles(pose, rotates(document, selected), this.local ? axesOf(pose) : Object.values(AXES)) : [];
  }

  /** @returns {Setting} */
  get setting() {
    const { plane, axis, kind } = this.palette, face = this.places[0]?.normal ?? this.now?.normal;
    return { poses: /** @type {Poses} */ (this.poses), document: this.document ?? {}, normal: plane.normal, axis: axis ?? face ?? plane.normal, kind };
  }

  /** The contents of the last text. @param {Document | null} document */
  show(document) {
    this.document = document;
    const { selected } = this;
    if (document && selected && !isStated(document, selected)) this.selected = null;
    this.offer();
    this.refresh();
  }

  /** Show the tools where one can draw: not while the text is already a structure. */
  offer() {
    this.palette.node.hidden = !this.possible;
    window.document.documentElement.dataset.space = String(this.possible);
  }

  /** @param {Page} page */
  bind(page) {
    const isSpatial = /** @type {unknown} */ (this.document?.kind) !== "structure" && page.motion.dimension === 3 && !page.motion.mesh && !page.motion.swings;
    this.boundPage = isSpatial ? page : null;
    this.poses = isSpatial ? new Poses(page, this.hidden) : null;
    [this.held, this.hover] = [null, null];
    this.offer();
    if (!isSpatial) return this.refresh();
    settleAtStart(page);
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    takePointer(page, view, () => this.boundPage === page && this.possible, () => this.held !== null, {
      pointerdown: (event, at) => this.down(event, at), pointermove: (event, at) => this.over(event, at), pointerup: (event, at) => this.up(event, at),
      dblclick: () => this.tool.name !== "select",
    });
    view.addEventListener("pointercancel", () => this.revert(), true);
    view.addEventListener("keydown", (event) => this.key(event), true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => drawOver(this, ctx));
    if (this.tool.name !== "select" || this.selected) this.rest();
    this.refresh();
  }

  rest() {
    this.boundPage?.player.pause();
    this.boundPage?.player.seek(this.boundPage.motion.start);
  }

  /** @param {string} name */
  choose(name) {
    this.tool = SPACE_TOOLS.find((tool) => tool.name === name) ?? SPACE_TOOLS[0];
    [this.places, this.now, this.typed] = [[], null, ""];
    if (this.tool.name !== "select") {
      this.selected = null;
      this.rest();
    }
    this.palette.show(this.tool.name);
    this.refresh();
  }

  /** @param {Choice | null} choice */
  select(choice) {
    this.selected = choice;
    if (choice) {
      if (this.tool.name !== "select") this.choose("select");
      this.selected = choice;
      this.rest();
      this.actions.select(choice.section === "ground" ? "ground" : choice.section, choice.name);
    }
    this.refresh();
  }

  /** @param {string[]} names of the bodies to hide, and no others */
  hide(names) {
    this.hidden.clear();
    for (const name of names) this.hidden.add(name);
    this.refresh();
  }

  // Pointer --------------------------------------------------------------------------------------

  /** @param {PointerEvent} event @param {Pixel} at */
  down(event, at) {
    this.pressed = event.button === 0 ? at : null;
    const page = this.boundPage, { pose } = this, handle = page && pose && this.resting && event.button === 0 ? handleAt(page, pose, this.handles, at) : null;
    if (!page || !pose || !handle) return false;
    this.held = grip(page, pose, handle, at);
    page.scene.view.fitted = false;  // the drawing stays below the pointer
    this.still = this.poses && { poses: stillPoses(this.poses), values: [...(page.design?.values ?? [])] };
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
      previewPull(this);
      return true;
    }
    if (this.tool.name === "select") {
      const { pose, hover } = this;
      this.hover = pose && this.resting && !event.buttons ? handleAt(page, pose, this.handles, at) : null;
      if (hover !== this.hover) this.refresh();
      return this.hover !== null;
    }
    if (!event.buttons) this.now = this.placeAt(event, at) ?? this.now;
    this.refresh();
    return false;
  }

  /** @param {PointerEvent} event @param {Pixel} at */
  up(event, at) {
    const { held, pressed } = this, still = pressed && Math.hypot(at[0] - pressed[0], at[1] - pressed[1]) < STILL;
    this.pressed = null;
    if (held) writePull(this, held);
    else if (still && this.tool.name === "select") this.select(this.elementAt(at));
    else if (still) {
      const place = this.placeAt(event, at);
      if (place) this.add(place);
    }
    return held !== null;
  }

  /** @param {{ altKey: boolean, shiftKey: boolean }} event @param {Pixel} at */
  placeAt(event, at) {
    const page = /** @type {Page} */ (this.boundPage), from = this.places.at(-1)?.p ?? null, lift = this.places.length === this.tool.lift || (event.shiftKey && from !== null);
    const first = this.places[0]?.p, { plane } = this.palette, k = "xyz".indexOf(plane.axis), through = first && !this.tool.onBody ? { ...plane, origin: plane.origin.map((v, i) => (i === k ? first[k] : v)) } : plane;
    return spaceSnap(page, at, through, { free: event.altKey, onBody: this.tool.onBody, from, lift });
  }

  /** @param {Pixel} at @returns {Choice | null} */
  elementAt(at) {
    const hit = this.boundPage?.scene.painter.hit(at), { document } = this;
    if (!hit || !document) return null;
    if (hit.kind === "point") {
      const { body, name } = hit.item, key = name.slice(name.lastIndexOf(".") + 1);
      return body.fixed ? { section: "ground", name: "ground", part: "points", key } : { section: "bodies", name: body.name, part: "points", key };
    }
    const name = hit.item.of?.name ?? hit.item.name, section = sectionOf(document, name);
    return section ? { section, name } : null;
  }

  // Changes --------------------------------------------------------------------------------------

  /** @param {SpacePlace} place */
  add(place) {
    this.places.push(place);
    this.typed = "";
    if (this.places.length === this.tool.clicks) this.finish();
    this.refresh();
  }

  finish() {
    const { places, tool, setting: { axis } } = this, fits = isOutside(this.boundPage, places.map(({ p }) => p));
    this.actions.commands.do(() => {
      const change = tool.make(places, { ...this.setting, axis });
      if (change) this.send(change, fits);
      else this.actions.refuse(`${tool.title}: ${tool.onBody && !places.some(({ body }) => body) ? "no body is there; " : ""}${tool.hint.join("; then ")}`);
    }, false);
    this.places = [];
  }

  /** @param {Change} change @param {boolean} [fits] whether the view is fitted to what was drawn outside it */
  send(change, fits = false) {
    const view = this.boundPage?.scene.view;
    if (view) view.fitted = fits;  // the view stays while one draws
    this.actions.change(change);
  }

  /** A change was refused: the picture shows the text again. */
  revert() {
    this.poses?.moved.clear();
    if (this.still) this.boundPage?.design?.replace(this.still.values, "drawing");
    this.still = null;
    this.held = null;
    this.refresh();
  }

  // Keys -----------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event */
  key(event) {
    if (!this.possible || isTyped(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!answer(this, event.key)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.refresh();
  }

  // Drawing --------------------------------------------------------------------------------------

  refresh() {
    this.tree.show(this.document, this.selected, this.hidden, this.possible);
    if (!this.possible) return;
    const { hint } = this.tool, step = Math.min(this.places.length, hint.length - 1), page = /** @type {Page} */ (this.boundPage);
    this.actions.hint(this.typed ? `${this.tool.title}: ${this.typed}` : this.selected && this.tool.name === "select" && this.pose ? `${this.selected.key ?? this.selected.name}: drag an arrow, a plane or a ring; type a value while dragging; G turns to ${this.local ? "the axes of space" : "its own axes"}` : `${this.tool.title}: ${hint[step]}`);
    page.scene.invalidate();
    page.scene.canvas.style.cursor = this.held ? "grabbing" : this.hover ? "grab" : this.tool.name === "select" ? "" : "crosshair";
  }
}
