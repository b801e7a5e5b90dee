// Planar structures in the studio: drawing tools, selection, dragging of nodes, vertices and loads.

/** @import { Completion } from "./completion.js" */
/** @import { Page, Pictures } from "./pictures.js" */
/** @import { Change, Operation } from "./operations.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Handle, Loop, Spot, Target } from "./structure_plan.js" */
/** @import { Tip } from "./structure_tips.js" */
/** @import { Document } from "./types.d.ts" */

import { measured, short } from "./overlay.js";
import { valuesAfter } from "./preview.js";
import { gridStep, placed, snap } from "./snapping.js";
import { drawStructure } from "./structure_overlay.js";
import { StructurePalette } from "./structure_palette.js";
import { Plan, circle } from "./structure_plan.js";
import { StructureProperties } from "./structure_properties.js";
import { tipAt, tipChange } from "./structure_tips.js";
import { STRUCTURE_TOOLS, drawnVector, typedVector } from "./structure_tools.js";
import { neat } from "./transforms.js";
import { BEGINS, TYPED, typedPlace } from "./typed_numbers.js";

/** Distance within which the pointer takes hold [px], and up to which a press is a click. */
const REACH = 10, STILL = 3;

/** What is dragged: handles with the nodes that follow, the tip of a load, or a rectangle of selection.
 * @typedef {{ kind: "handle" | "tip" | "box", handles: Handle[], tip: Tip | null, from: Place, to: Place, moved: boolean, values: number[] }} Drag */
/** @typedef {{ section: string, name: string }} Part */

export class Structure {
  /** @param {Pictures} pictures @param {{ change: (change: Change) => void, hint: (text: string) => void, select: (section: string, name: string) => void, refuse: (text: string) => void }} actions @param {HTMLElement} stage @param {() => Completion | null} completion */
  constructor(pictures, actions, stage, completion) {
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
    this.properties = new StructureProperties(stage, this, completion);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @returns {Page | null} */
  get page() { return this.pictures.page; }

  /** Whether the text is a planar structure, and its picture can be drawn on. */
  get possible() {
    const view = this.page?.scene.view;
    return Boolean(this.plan?.isPlanar && view && "s" in view);
  }

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
    if (!this.possible) return;
    const { scene, player } = page, { canvas } = scene, view = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    const grid = /** @type {HTMLElement | null | undefined} */ (this.pictures.frame?.contentDocument?.getElementById("grid"));
    if (grid && !scene.show.grid) grid.click();
    if (!page.motion.mesh && scene.view.fitted) [scene.view.x, scene.view.y, scene.view.s, scene.view.fitted] = [2, 0.5, Math.max(60, canvas.clientWidth / 7), false];
    if (!this.moving.length) player.pause();
    const on = (/** @type {string} */ kind, /** @type {(event: PointerEvent, at: Spot) => boolean} */ act) => view.addEventListener(kind, (event) => {
      if ((event.target !== canvas && !this.drag) || this.page !== page || !this.possible) return;
      const { clientX, clientY } = /** @type {PointerEvent} */ (event), { left, top } = canvas.getBoundingClientRect();
      if (act(/** @type {PointerEvent} */ (event), [clientX - left, clientY - top])) event.stopImmediatePropagation();
    }, true);
    on("pointerdown", (event, at) => this.down(event, at));
    on("pointermove", (event, at) => this.over(event, at));
    on("pointerup", (event) => this.up(event));
    on("dblclick", () => this.tool.name !== "select");
    view.addEventListener("keydown", (event) => {
      this.key(event);
      const { key, ctrlKey, metaKey, shiftKey } = event;
      if (!(ctrlKey || metaKey) || event.defaultPrevented) return;
      const outer = new KeyboardEvent("keydown", { key, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true });
      if (!document.dispatchEvent(outer)) event.preventDefault();  // such as undo, while the picture has the focus
    }, true);
    scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => { if (this.possible && this.page === page) drawStructure(ctx, this); });
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
    const typed = this.typed && !this.tool.units ? typedPlace(this.typed, from, place) : null;
    return typed ? { ...placed(typed.x, typed.y), how: "typed" } : place;
  }

  /** @param {Spot} pixel @returns {Spot} */
  world(pixel) { return /** @type {Page} */ (this.page).scene.view.world(pixel); }

  /** Distance within which the pointer takes hold [m]. */
  get reach() { return REACH / /** @type {Page} */ (this.page).scene.view.s; }

  /** @param {PointerEvent} event @param {Spot} pixel */
  down(event, pixel) {
    if (event.button !== 0) return false;
    this.pictures.held = true;  // another picture would lose the end of the press
    if (this.tool.name === "select") return this.grasp(event, pixel);
    this.put(this.placeAt(event, pixel), this.world(pixel));
    return true;
  }

  /** Add a place to what is being drawn. @param {Place} place @param {Spot} [at] */
  put(place, at = [place.x, place.y]) {
    const { tool, plan, page } = this, first = this.places[0];
    if (!plan || !page) return;
    if (tool.target && !this.places.length) {
      this.target = plan.targetAt(at, this.reach, tool.bars);
      if (!this.target) return this.actions.refuse(`${tool.title}: ${tool.hint[0]}`);
    }
    const closes = tool.clicks === 0 && this.places.length > 2 && Math.hypot(place.x - first.x, place.y - first.y) * page.scene.view.s < 8;
    if (!closes) this.places.push(place);
    if (closes || this.places.length === tool.clicks) this.finish();
    this.typed = "";
    this.refresh();
  }

  finish() {
    const { places, tool, target } = this, [from, to] = places;
    this.places = tool.chain ? places.slice(-1) : [];
    /** @type {Spot | null} */
    let vector = null;
    if (tool.units && from && to) {
      const { size, units } = tool.units(target);
      vector = this.typed ? typedVector(this.typed, units, [to.x - from.x, to.y - from.y]) : drawnVector(from, to, size);
    }
    const change = tool.make(places, this.setting, target, vector);
    if (change) this.send(change);
    else this.actions.refuse(`${tool.title}: ${tool.hint.join("; ")}`);
    this.target = null;
  }

  /** @param {Change} change */
  send(change) {
    const view = this.page?.scene.view;
    if (view) view.fitted = false;  // the view stays while one draws
    this.actions.change(change);
  }

  /** Begin to drag, or select. @param {PointerEvent} event @param {Spot} pixel */
  grasp(event, pixel) {
    const page = /** @type {Page} */ (this.page), plan = /** @type {Plan} */ (this.plan), at = this.world(pixel), values = [...(page.design?.values ?? [])];
    const begin = (/** @type {Drag["kind"]} */ kind, /** @type {Handle[]} */ handles, /** @type {Tip | null} */ tip, /** @type {Spot} */ [x, y]) => {
      page.scene.view.fitted = false;  // the drawing stays below the pointer
      this.drag = { kind, handles, tip, from: placed(x, y), to: placed(x, y), moved: false, values };
    };
    const tip = this.document && tipAt(page, this.document, pixel);
    if (tip) {
      this.select([{ section: "points", name: tip.node }], plan.targetAt(plan.nodes.get(tip.node) ?? at, this.reach));
      begin("tip", [], tip, at);
      return true;
    }
    const handle = plan.handles.filter((one) => Math.hypot(one.at[0] - at[0], one.at[1] - at[1]) < this.reach).sort((a, b) => Math.hypot(a.at[0] - at[0], a.at[1] - at[1]) - Math.hypot(b.at[0] - at[0], b.at[1] - at[1]))[0];
    const target = plan.targetAt(at, this.reach * 0.7, true), region = plan.regionAt(at);
    const seen = handle || target ? null : page.motion.mesh?.hit(pixel, page.scene.seen()), pictured = seen?.kind === "element" ? String(page.motion.mesh.elements[seen.item]).split("[")[0] : "";
    const part = handle ? { section: "points", name: handle.name } : target?.kind === "edge" ? { section: "edges", name: target.name } : target ? { section: "elements", name: target.name } : region ? { section: "meshes", name: region.name } : ["elements", "meshes"].filter((section) => this.document?.[section]?.[pictured]).map((section) => ({ section, name: pictured }))[0] ?? null;
    const has = (/** @type {Part} */ one) => this.selection.some(({ section, name }) => section === one.section && name === one.name);
    if (!part && (event.pointerType === "touch" || event.altKey)) return false;  // pans
    if (event.shiftKey && part) this.select(has(part) ? this.selection.filter(({ name }) => name !== part.name) : [...this.selection, part]);
    else if (part && !(has(part) && this.selection.length > 1)) this.select([part], target);
    else if (!part && !event.shiftKey) this.select([]);
    const points = this.selection.filter(({ section }) => section === "points").map(({ name }) => name);
    if (handle) begin("handle", points.includes(handle.name) ? plan.handles.filter(({ name }) => points.includes(name)) : [handle], null, handle.at);
    else if (!part) begin("box", [], null, at);
    return true;
  }

  /** @param {PointerEvent} event @param {Spot} pixel */
  over(event, pixel) {
    if (event.buttons > 1) return false;
    if (!event.buttons) this.pictures.held = false;
    const { drag, tool, plan } = this, page = /** @type {Page} */ (this.page);
    const place = this.placeAt(event, pixel), [x, y] = this.world(pixel);
    this.now = place;
    if (drag) {
      drag.to = drag.kind === "handle" ? place : placed(x, y);
      drag.moved ||= Math.hypot(x - drag.from.x, y - drag.from.y) * page.scene.view.s > STILL;
      if (drag.moved && drag.kind !== "box") this.preview(drag);
    } else if (tool.name === "select") {
      const tip = event.buttons || !this.document ? null : tipAt(page, this.document, pixel), changed = tip?.index !== this.tip?.index;
      this.tip = tip;
      if (changed) this.refresh();
      return false;
    } else this.hover = tool.target && !this.places.length ? plan?.targetAt([x, y], this.reach, tool.bars) ?? null : null;
    page.scene.pointer = null;  // no tip over what is drawn
    this.refresh();
    return event.buttons === 1;
  }

  /** @param {PointerEvent} event */
  up(event) {
    const { drag, plan } = this;
    this.drag = null;
    this.pictures.held = false;
    if (!drag || !plan) return this.tool.name !== "select";
    if (drag.kind === "box") {
      const { from: p, to: q } = drag, inside = (/** @type {Spot} */ [x, y]) => (x - p.x) * (x - q.x) <= 0 && (y - p.y) * (y - q.y) <= 0;
      const parts = [...plan.handles.filter(({ kind, at }) => kind !== "radius" && inside(at)).map(({ name }) => ({ section: "points", name })), ...plan.bars.filter(({ ends }) => ends.every(inside)).map(({ name }) => ({ section: "elements", name }))];
      this.select([...(event.shiftKey ? this.selection : []), ...(drag.moved ? parts : [])]);
    } else if (drag.moved) {
      const change = this.changeOf(drag);
      if (change) this.send(change);
    }
    this.refresh();
    return true;
  }

  // Dragging -------------------------------------------------------------------------------------

  /** Change of the file by what is dragged. @param {Drag} drag @returns {Change | null} */
  changeOf({ kind, handles, tip, from, to }) {
    const page = /** @type {Page} */ (this.page);
    if (kind === "tip") return tip && this.document && tipChange(this.document, tip, this.world(page.scene.view.screen([to.x, to.y])), page);
    return moved(handles, [to.x - from.x, to.y - from.y], [to.x, to.y]);
  }

  /** Let a live page compute what is dragged. @param {Drag} drag */
  preview(drag) {
    const { page, document } = this, design = page?.design;
    if (!page || !document || !design || design.parameters.length !== drag.values.length) return;
    const change = this.changeOf(drag), next = change && valuesAfter(page, document, drag.values, change.operations);
    if (next) design.replace(next, "drawing");
  }

  /** Place of a handle while others are dragged. @param {Spot} p @returns {Spot} */
  shifted(p) {
    const { drag } = this, held = drag?.kind === "handle" && drag.moved && drag.handles.find(({ at, kind }) => kind !== "radius" && at[0] === p[0] && at[1] === p[1]);
    return held && drag ? [p[0] + drag.to.x - drag.from.x, p[1] + drag.to.y - drag.from.y] : p;
  }

  /** Loops of a region while handles are dragged. @param {Loop[]} loops @returns {Spot[][]} */
  loopsNow(loops) {
    const { drag } = this, held = drag?.kind === "handle" && drag.moved ? drag.handles.find(({ kind }) => kind === "radius") : null;
    return loops.map(({ spots, center, radius }) => {
      if (!center || radius === undefined) return spots.map((p) => this.shifted(p));
      const grows = held && drag && held.of === center;
      return circle(this.shifted(center), grows ? Math.hypot(drag.to.x - center[0], drag.to.y - center[1]) : radius);
    });
  }

  /** Lines beside the pointer. @param {Place} at @returns {string[]} */
  readout(at) {
    const { tool, places, drag, target, typed } = this;
    if (typed) return [`${typed}▏`, at.how];
    if (drag?.tip) {
      const change = this.changeOf(drag), values = change?.operations.map(({ value }) => Number(value)) ?? [];
      return [`${short(Math.hypot(...values))} N`];
    }
    if (tool.units && target && places.length) return [tool.title === "Moment" ? "left: positive, right: negative" : `${short(tool.units(target).size)} ${target.kind === "edge" && tool.bars ? "Pa" : tool.bars ? (target.kind === "element" ? "N/m" : "N") : "m"}; or type a value`, `on ${target.name}`];
    if (tool.target) return [this.hover ? `on ${this.hover.name}` : tool.hint[0]];
    const from = places.at(-1);
    return [from ? measured(from, at) : `${short(at.x)}, ${short(at.y)} m`, at.how];
  }

  // Keys -----------------------------------------------------------------------------------------

  /** @param {KeyboardEvent} event */
  key(event) {
    const typing = /** @type {HTMLElement} */ (event.target)?.closest?.("input, select, textarea, .cm-editor, dialog");
    if (!this.possible || typing || event.defaultPrevented || event.altKey) return;
    if (event.ctrlKey || event.metaKey ? !this.command(event.key) : !this.answer(event)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.refresh();
  }

  /** Keys with Ctrl. @param {string} key */
  command(key) {
    if (key !== "a" || !this.plan) return false;
    this.select([...this.plan.handles.filter(({ kind }) => kind !== "radius").map(({ name }) => ({ section: "points", name })), ...this.plan.bars.map(({ name }) => ({ section: "elements", name }))]);
    return true;
  }

  /** Carry out a key; returns whether it has a meaning. @param {KeyboardEvent} event */
  answer({ key, shiftKey }) {
    const { tool } = this, page = /** @type {Page} */ (this.page), step = gridStep(page.scene.view.s) * (shiftKey ? 0.1 : 1);
    const way = /** @type {Record<string, Spot>} */ ({ ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] })[key];
    if (this.typing(key)) return true;
    if (key === "Escape") {
      if (this.drag) page.design?.replace(this.drag.values, "drawing");
      if (this.places.length || this.drag) [this.places, this.drag, this.target] = [[], null, null];
      else if (tool.name !== "select") this.choose("select");
      else this.select([]);
    } else if (key === "Enter" && tool.clicks === 0 && this.places.length > 2) this.finish();
    else if (key === "Enter" && tool.chain && this.places.length) this.places = [];
    else if ((key === "Delete" || key === "Backspace") && this.selection.length) this.properties.removeSelection();
    else if (way && this.selection.length) {
      const points = new Set(this.selection.map(({ name }) => name)), change = moved((this.plan?.handles ?? []).filter(({ name }) => points.has(name)), way, null);
      if (change) this.send(change);
    } else {
      const next = STRUCTURE_TOOLS.find((item) => item.key === key);
      if (!next) return false;
      this.choose(next.name);
    }
    return true;
  }

  /** Keys of numbers that are typed while drawing. @param {string} key */
  typing(key) {
    const { tool, now } = this, from = this.places.at(-1) ?? null;
    if (tool.name === "select" || !this.page || (tool.target && !this.places.length)) return false;
    if (key === "Enter" && this.typed) {
      const place = tool.units ? this.typedTarget() : typedPlace(this.typed, from, now);
      if (place) this.put({ ...placed(place.x, place.y), how: "typed" });
      else this.actions.refuse(`${this.typed}: ${tool.units ? "type a value 5 kN, with an angle 5 kN<-90, or components 0, -5000" : "type a length 0.3, a length and an angle 0.3<45, or coordinates 0.1,0.2"}`);
    } else if (key === "Backspace" && this.typed) this.typed = this.typed.slice(0, -1);
    else if (key === "Escape" && this.typed) this.typed = "";
    else if (this.typed ? TYPED.test(key) : BEGINS.test(key)) this.typed += key;
    else return false;
    const place = this.typed && !tool.units ? typedPlace(this.typed, from, now) : null;
    if (place) this.now = { ...placed(place.x, place.y), how: "typed" };
    return true;
  }

  /** Place toward which a typed load points. */
  typedTarget() {
    const { tool, places: [from], now, target } = this;
    if (!from) return null;
    const toward = now ?? from, way = /** @type {Spot} */ ([toward.x - from.x, toward.y - from.y]);
    return tool.units && typedVector(this.typed, tool.units(target).units, way) ? { x: toward.x, y: toward.y } : null;
  }

  refresh() {
    if (!this.possible) return;
    const { hint, title, name } = this.tool, page = /** @type {Page} */ (this.page);
    this.actions.hint(`${title}: ${hint[Math.min(this.places.length, hint.length - 1)]}`);
    page.scene.invalidate();
    page.scene.canvas.style.cursor = name === "select" ? (this.tip ? "grab" : "") : "crosshair";
  }
}

/** Change that moves handles; a radius goes to a place. @param {Handle[]} handles @param {Spot} way @param {Spot | null} to @returns {Change | null} */
function moved(handles, [dx, dy], to) {
  const operations = handles.flatMap(({ keys, kind, at: [x, y], of }) => {
    if (kind === "radius") return to && of ? [{ op: "set", keys, value: neat(Math.hypot(to[0] - of[0], to[1] - of[1])) }] : [];
    return [dx, dy].flatMap((shift, k) => (shift ? [{ op: "set", keys: [...keys, k], value: neat([x, y][k] + shift) }] : []));
  });
  return operations.length ? { label: `move ${handles.length > 1 ? `${handles.length} points` : handles[0].name}`, operations: /** @type {Operation[]} */ (operations) } : null;
}

