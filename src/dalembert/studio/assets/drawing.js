// Drawing on the picture: tools, dragging, keys.

/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { CommandQueue } from "./command_queue.js" */
/** @import { Change } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { controlAt, moveControl } from "./controls.js";
import { transform } from "./editing.js";
import { isSpatialMechanism } from "./model_dimension.js";
import { move } from "./operations.js";
import { drawOverlay } from "./overlay.js";
import { isTyped, takePointer } from "./picture_events.js";
import { isOutside } from "./pictures.js";
import { stillPage, valuesAfter } from "./preview.js";
import { bodiesAmong, namesIn, sectionOf, within } from "./selection.js";
import { SelectionKeys } from "./selection_keys.js";
import { elementAt, inBody, namedPlaces, placed, snap, typedAt } from "./snapping.js";
import { TOOLS } from "./tools.js";
import { shift } from "./transforms.js";
import { BEGINS, TYPED, typedPlace } from "./typed_numbers.js";

/** What is being dragged: a point, bodies, a control point, or a rectangle of selection; the page before, and the values of its parameters; `late` if the picture was not yet that of the text.
 * @typedef {{ kind: "point" | "body" | "box" | "control", control: ReturnType<typeof controlAt>, from: Place, to: Place, moved: boolean, late: boolean, still: Page, values: number[] }} Drag */
/** @typedef {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void, onTool: (name: string) => void, onSelect: (names: string[]) => void, rename: (name: string) => void, commands: CommandQueue }} Actions */

export class Drawing {
  /** @param {Pictures} pictures @param {Actions} actions */
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
    /** @type {Drag | null} */
    this.drag = null;
    /** Names of selected elements. @type {Set<string>} */
    this.selection = new Set();
    /** Numbers that are being typed. */
    this.typed = "";
    /** Degrees of freedom and redundant constraints. */
    this.status = "";
    /** Names before elements were pasted, until the file has the copies. @type {Set<string> | null} */
    this.before = null;
    this.keys = new SelectionKeys(this);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @returns {Page | null} */
  get page() { return this.pictures.page; }

  /** The contents of the last text; what was pasted is selected. @param {Document | null} document */
  show(document) {
    this.document = document;
    if (this.page) this.page.document = document;
    const { before } = this, added = before && document ? namesIn(document).filter((name) => !before.has(name)) : [];
    if (added.length) this.select(added);
  }

  /** Picture for snapping. */
  get snapPage() { return this.page; }

  /** Place from which lengths and directions are measured. @returns {Place | null} */
  get from() { return (this.tool.fromFirst ? this.places[0] : this.places.at(-1)) ?? null; }

  /** The selected element, if it is one. @returns {string | null} */
  get selected() { return this.selection.size === 1 ? [...this.selection][0] : null; }

  /** Whether the picture is a planar mechanism that can be drawn on. */
  get possible() {
    const view = this.page?.scene.view;
    return Boolean(view && "s" in view && !this.page?.motion.mesh && !this.page?.motion.swings && /** @type {unknown} */ (this.document?.kind) !== "structure" && !isSpatialMechanism(this.document));
  }

  /** @param {string} name */
  choose(name) {
    this.tool = TOOLS.find((tool) => tool.name === name) ?? TOOLS[0];
    [this.places, this.drag, this.typed] = [[], null, ""];
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
    page.document = this.document;
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    takePointer(page, view, () => this.possible, () => this.drag !== null, {
      pointerdown: (event, at) => this.down(event, at), pointermove: (event, at) => this.over(event, at), pointerup: (event, at) => this.up(event, at),
      dblclick: () => this.tool.name !== "select",
    });
    view.addEventListener("keydown", (event) => {
      this.key(event);
      const { key, ctrlKey, metaKey, shiftKey } = event;
      if (!(ctrlKey || metaKey) || event.defaultPrevented) return;
      const outer = new KeyboardEvent("keydown", { key, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true });
      if (!document.dispatchEvent(outer)) event.preventDefault();  // such as undo, while the picture has the focus
    }, true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => { if (this.possible) drawOverlay(ctx, this); });
    if (this.tool.name !== "select") this.rest();
    this.refresh();
  }

  /** @param {{ altKey: boolean }} event @param {[number, number]} at @returns {Place} */
  placeAt(event, at) {
    const page = /** @type {Page} */ (this.page), ignore = this.drag?.kind === "point" ? this.drag.from.names : [];
    const { from } = this, place = snap(page, at, { from, free: event.altKey, ignore });
    const typed = this.typed ? typedPlace(this.typed, from, place) : null;
    if (typed) return typedAt(page, typed);
    if (!place.names.length && this.tool.onBody && (!this.places.length || this.tool.onBody === "all")) {
      const hit = elementAt(page, at);
      if (hit && this.document?.bodies?.[hit.name]) return { ...place, body: hit.name, local: inBody(page, hit.name, place.x, place.y), how: `on ${hit.name}` };
    }
    return place;
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  down(event, at) {
    if (event.button !== 0) return false;
    if (this.tool.name === "select") return this.grasp(event, at);
    this.put(this.placeAt(event, at));
    return true;
  }

  /** Add a place to what is being drawn. @param {Place} place */
  put(place) {
    const first = this.places[0], { clicks } = this.tool;
    const closes = clicks === 0 && this.places.length > 2 && Math.hypot(place.x - first.x, place.y - first.y) * /** @type {Page} */ (this.page).scene.view.s < 8;
    if (!closes) this.places.push(place);
    this.typed = "";
    if (closes || this.places.length === clicks) this.finish();
    this.refresh();
  }

  /** Begin to drag a point, bodies or a rectangle; select an element. @param {PointerEvent} event @param {[number, number]} at */
  grasp(event, at) {
    const page = /** @type {Page} */ (this.page), control = this.document && controlAt(page, this.document, this.selected, at);
    if (control) {
      this.rest();
      const from = placed(control.x, control.y);
      this.drag = { kind: "control", control, from, to: from, moved: false, late: this.isLate, still: stillPage(page), values: [] };
      return true;
    }
    const resting = !page.player.playing && page.player.time === page.motion.start, place = snap(page, at), hit = elementAt(page, at);
    const name = hit && this.document && sectionOf(this.document, hit.name) ? hit.name : null, several = name !== null && this.selection.size > 1 && this.selection.has(name);
    if (event.shiftKey && name) {
      this.select(this.selection.has(name) ? [...this.selection].filter((other) => other !== name) : [...this.selection, name]);
      return true;
    }
    if (!name && !place.names.length && (event.pointerType === "touch" || event.altKey)) return false;  // pans
    if (!several && !event.shiftKey) this.select(name ? [name] : []);
    const kind = place.names.length && !several ? "point" : name ? "body" : "box";
    if (kind !== "box") this.rest();
    const exact = kind === "box" ? { ...place, ...worldAt(page, at) } : place;
    if (kind === "box" || resting) this.drag = { kind, control: null, from: exact, to: exact, moved: false, late: this.isLate, still: stillPage(page), values: [...(page.design?.values ?? [])] };
    this.refresh();
    return true;
  }

  /** @param {Iterable<string>} names */
  select(names) {
    this.selection = new Set(names);
    this.before = null;
    const { document, selected } = this, section = selected && document && sectionOf(document, selected);
    if (section && selected) this.actions.select(section, selected);
    this.actions.onSelect([...this.selection]);
    this.refresh();
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  over(event, at) {
    if (event.buttons > 1) return false;
    const place = this.placeAt(event, at), { drag, page } = this;
    this.now = place;
    if (drag && page) {
      drag.to = drag.kind === "box" ? { ...place, ...worldAt(page, at) } : place;
      drag.moved ||= Math.hypot(place.x - drag.from.x, place.y - drag.from.y) * page.scene.view.s > (drag.kind === "point" ? 0 : 3);
      if (drag.moved && drag.kind !== "box") this.preview(drag);
    } else if (this.tool.name === "select") return false;
    this.refresh();
    return event.buttons === 1;
  }

  /** Keep the view while one draws, although the motion may leave it. @param {boolean} [fits] whether it is fitted to what was drawn outside it */
  keepView(fits = false) { if (this.page) this.page.scene.view.fitted = fits; }

  /** Change of the file by what is dragged; none at its own place. @param {Drag} drag @returns {Change | null} */
  changeOf({ kind, control, from, to, still }) {
    if (!this.document || kind === "box") return null;
    if (control) return moveControl(still, this.document, control, to);
    if (from.x === to.x && from.y === to.y) return null;
    if (kind === "point") return move(still, this.document, from, to);
    const names = bodiesAmong(this.document, this.selection);
    return transform(still, this.document, this.selection, shift(to.x - from.x, to.y - from.y), `move ${names.length > 1 ? `${names.length} bodies` : names[0]}`);
  }

  /** @param {PointerEvent} event @param {[number, number]} at */
  up(event, at) {
    const { drag, page, document } = this;
    this.drag = null;
    if (!drag || !page || !document) return this.tool.name !== "select";
    if (drag.moved && drag.kind !== "box") this.keepView();
    if (drag.kind === "box") this.select([...(event.shiftKey ? this.selection : []), ...(drag.moved ? within(page, document, drag.from, drag.to) : [])]);
    else if (drag.moved && drag.late) this.actions.commands.do(() => this.attempt(() => this.changeOf(this.renewed(drag))), true);
    else if (drag.moved) this.attempt(() => this.changeOf(drag));
    this.refresh();
    return true;
  }

  /** Whether the picture of the last change is still to come. */
  get isLate() { return !this.actions.commands.isReady(true); }

  /** A drag that began on an outdated picture, from the place in the present one. @param {Drag} drag @returns {Drag} */
  renewed(drag) {
    const page = /** @type {Page} */ (this.page), place = drag.kind === "point" ? namedPlaces(page).find(({ names }) => names.includes(drag.from.names[0])) : null;
    return { ...drag, still: stillPage(page), from: { ...drag.from, ...place && { x: place.x, y: place.y, names: place.names } } };
  }

  /** Carry out a change, or say why it is not possible. @param {() => Change | null} make @param {string} [refusal] */
  attempt(make, refusal = "") {
    this.before = null;
    try {
      const change = make();
      if (change) this.actions.change(change);
      else if (refusal) this.actions.refuse(refusal);
    } catch (error) {
      this.actions.refuse(/** @type {Error} */ (error).message);
    }
  }

  /** Let a live page compute the position to which a point or a body is dragged. @param {Drag} drag */
  preview(drag) {
    const { page, document } = this, design = page?.design;
    if (!page || !document || design?.parameters.length !== drag.values.length) return;
    try {
      const next = valuesAfter(page, document, drag.values, this.changeOf(drag)?.operations ?? []);
      if (next) design.replace(next, "drawing");
    } catch { /* the reason is shown when it is released */ }
  }

  finish() {
    const { places, tool } = this;
    this.places = [];
    this.actions.commands.do(() => {
      if (tool.group !== "Select") this.keepView(isOutside(this.page, places.map(({ x, y }) => [x, y])));
      this.attempt(() => tool.make(places, this), `${tool.title}: ${tool.hint[0]}`);
    }, false);
    this.refresh();
  }

  /** Keys of numbers that are typed while drawing. @param {string} key @returns {boolean} */
  typing(key) {
    if (this.tool.name === "select" || !this.page) return false;
    if (key === "Enter" && this.typed) {
      const place = typedPlace(this.typed, this.from, this.now);
      if (place) this.put(typedAt(this.page, place));
      else this.actions.refuse(`${this.typed}: type a length 0.3, a length and an angle 0.3<45, or coordinates 0.1,0.2`);
    } else if (key === "Backspace" && this.typed) this.typed = this.typed.slice(0, -1);
    else if (key === "Escape" && this.typed) this.typed = "";
    else if (this.typed ? TYPED.test(key) : BEGINS.test(key)) this.typed += key;
    else return false;
    const place = this.typed ? typedPlace(this.typed, this.from, this.now) : null;
    if (place) this.now = typedAt(this.page, place);
    return true;
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (!this.possible || isTyped(event) || event.defaultPrevented) return;
    const { key } = event;
    if (event.ctrlKey || event.metaKey) {
      if (!this.keys.command(event)) return;
    } else if (event.altKey) return;
    else if (this.typing(key)) { /* typed */ }
    else if (key === "Escape") {
      if (this.drag) this.page?.design?.replace(this.drag.values, "drawing");
      if (this.places.length || this.drag) [this.places, this.drag] = [[], null];
      else if (this.tool.name !== "select") this.choose("select");
      else this.select([]);
    } else if (key === "Enter" && this.tool.clicks === 0 && this.places.length > 1) this.finish();
    else if (!(this.tool.name === "select" && this.keys.edits(event))) {
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
}

/** Place of the plane at a pixel. @param {Page} page @param {[number, number]} pixel */
function worldAt(page, pixel) {
  const [x, y] = page.scene.view.world(pixel);
  return { x, y };
}
