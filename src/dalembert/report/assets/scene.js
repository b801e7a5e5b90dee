// Scene of a page: what is drawn in a view of the plane or of space, and the object under the pointer.

/** @import { Point, LoadKind } from "./types.d.ts" */
/** @import { Dimension, DrawnArrow, Hit, Item, Link, Painter, Paper, Part, Pixel, Shape, View } from "./scene_types.d.ts" */
/** @import { Motion } from "./motion.js" */

import { newSizes } from "./loads.js";
import { Marks } from "./marks.js";
import { TAU, clamp } from "./numbers.js";
import { Theme } from "./theme.js";
import { boxOf, diagonal, distance } from "./timeline.js";
import { drawTip } from "./tip.js";

/** Limits of the numbers of bodies, or nodes, whose names are shown at first. */
const NAMED_PARTS = 12;
/** Number of teeth of the smaller gear. */
const TEETH = 20;

export class Scene {
  /** @param {Motion} motion @param {HTMLCanvasElement} canvas @param {HTMLElement} tip @param {Dimension} dimension */
  constructor(motion, canvas, tip, { View, Painter, structure = undefined }) {
    this.motion = motion;
    this.structure = structure;
    this.canvas = canvas;
    this.tip = tip;
    /** Resolution while printing. @type {number | undefined} */
    this.ratio = undefined;
    const few = motion.mesh ? motion.mesh.nodes.length <= NAMED_PARTS : motion.bodies.filter(({ label }) => label).length <= NAMED_PARTS;
    /** Parts that are drawn. @type {Record<string, boolean>} */
    this.show = { labels: few, forces: false, grid: !motion.mesh, ghosts: true, rest: true, loads: true, supports: true, mesh: true, values: false };
    /** Factors of the lengths of arrows. */
    this.sizes = newSizes();
    /** Largest load of each kind. @type {Record<LoadKind, number>} */
    this.greatest = { force: 0, moment: 0, load: 0, twist: 0 };
    /** Arrows of the last drawing. @type {DrawnArrow[]} */
    this.arrows = [];
    /** Further drawings over the marks. @type {((paper: Paper) => void)[]} */
    this.overlays = [];
    /** @type {Pixel | null} */
    this.pointer = null;
    /** @type {Hit | null} */
    this.hover = null;
    /** Whether it is drawn in the next frame, and whether it was drawn before that frame. */
    this.pending = this.early = false;
    /** @type {Point[]} */
    this.cloud = [];
    /** Size of the scene, and half the width of a bar [m]. */
    this.size = 1;
    this.unit = 1;
    /** Body that the view follows, and its last position. @type {Part | null} */
    this.followed = null;
    /** @type {Point | null} */
    this.position = null;
    /** @type {View} */
    this.view = new View(canvas, () => this.invalidate());
    /** @type {Painter} */
    this.painter = new Painter(this);
    this.marks = new Marks(this);
    this.build();
    const once = motion.moves ? diagonal(motion.cloud([{ i: 0, f: 0 }])) : 0;
    this.follow(/** @type {Part | null} */ (motion.traveller(this.size, once)));
    motion.onState.on(() => { this.scaleLoads(); this.invalidate(); });
    this.bindPointer();
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  get hint() { return this.view.hint; }
  get keys() { return this.view.keys; }

  /** Read sizes and scales off the motion, and build its parts. */
  build() {
    const { motion } = this;
    motion.mesh?.update(motion.cursor, motion.mesh.scale);
    this.cloud = [...this.cloud, ...motion.cloud()];
    this.size = diagonal(this.cloud);
    const start = motion.dimension === 3 && motion.moves ? diagonal(motion.cloud([{ i: 0, f: 0 }])) : 0;
    this.unit = symbolSize(motion, Math.min(this.size, 2 * start || Infinity));  // small also where bodies go far
    for (const mesh of motion.joints) if (mesh.mesh.length === 2) cutTeeth(motion, mesh);
    measureLinks(motion);
    motion.chooseTraces(this.size);
    this.scaleLoads();
    this.view.enclose(this.cloud, motion.gravity);
    this.painter.build();
  }

  /** Draw another design, with the same traces. @param {Set<string>} traced names of points */
  renew(traced) {
    this.cloud = boxOf(this.cloud);
    this.build();
    for (const point of this.motion.points) point.traced = traced.has(point.name);
    this.painter.restyle();
    if (this.view.fitted) this.fit(); else this.invalidate();
  }

  /** Draw the same parts at other places and with other dimensions. */
  refit() {
    this.painter.refit();
    this.invalidate();
  }

  // Loads ----------------------------------------------------------------------------------------

  /** Joints and supports with reactions. */
  get loaded() { return [...this.motion.joints, ...this.motion.reactions].filter(({ force, moment }) => force || moment); }

  /** Applied forces and moments. */
  get applied() { return this.motion.symbols.filter(({ force, moment }) => force || moment); }

  /** Largest loads of the motion, or of the chosen state of a structure. */
  scaleLoads() {
    const { motion, loaded, applied } = this, instants = motion.swings ? [motion.chosen] : [...Array(motion.n).keys()];
    const largest = (/** @type {Item[]} */ items, /** @type {"force" | "moment"} */ key) => {
      let most = 0;
      for (const { [key]: columns } of items) {
        for (const i of columns ? instants : []) {
          let square = 0;
          for (const column of columns ?? []) square += column[i] * column[i];
          if (square > most) most = square;
        }
      }
      return Math.sqrt(most);
    };
    this.greatest = { force: largest(loaded, "force"), moment: largest(loaded, "moment"), load: largest(applied, "force"), twist: largest(applied, "moment") };
  }

  /** Bodies that are drawn behind the others: of other designs or runs, and at rest. */
  get pale() { return [...this.show.ghosts ? this.motion.ghosts : [], ...this.show.rest ? this.motion.resting : []]; }

  // View -----------------------------------------------------------------------------------------

  /** @param {Point} place @returns {Pixel | null} */
  screen(place) { return this.view.screen(place); }

  /** Legend and buttons that cover the drawing. @returns {NodeListOf<HTMLElement>} */
  get panels() { return /** @type {HTMLElement} */ (this.canvas.parentElement).querySelectorAll(".ramp-box, .zoom"); }

  /** Positions on the canvas, and depths, of the vertices of a mesh. */
  seen(places = this.motion.mesh?.places ?? new Float64Array(0)) { return this.view.project(places); }

  fit() {
    const { motion, canvas: { clientWidth: w, clientHeight: h } } = this, cloud = this.followed || motion.mesh ? motion.cloud(this.followed ? [motion.cursor] : undefined) : this.cloud;
    this.position = null;
    const room = motion.mesh ? Math.min(110, (w < 760 ? 0.16 : 0.2) * Math.min(w, h)) : Math.min(60, 0.09 * w);
    const legend = motion.mesh && w < 1000 ? this.canvas.parentElement?.querySelector(".ramp-box")?.clientWidth ?? 0 : 0;
    const tools = w < 560 && motion.dimension === 3 ? 40 : 0;
    this.view.fit(cloud, { side: room, top: (motion.mesh ? room : 44) + tools, bottom: motion.mesh ? room : 58 - 14 * Number(motion.dimension === 3), left: legend });
  }

  /** @param {number} factor */
  zoom(factor) { this.view.zoom(factor); }

  /** Let the view follow a body; null lets it stand. @param {Part | null} body */
  follow(body) {
    this.followed = body;
    this.fit();
  }

  /** Move the view with the followed body. */
  keepUp() {
    const place = this.followed && this.motion.at(this.followed, this.motion.point(null)), before = this.position;
    if (place && before) this.view.carry(place.map((v, k) => v - before[k]));
    this.position = place;
  }

  resize() { if (this.view.fitted) this.fit(); else this.invalidate(); }

  // Drawing --------------------------------------------------------------------------------------

  restyle() {
    this.painter.restyle();
    this.invalidate();
  }

  /** @param {{ index: number }} point */
  pointColour({ index }) { return Theme.colour(index + 3); }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    if (this.early) return;  // the frame is requested
    requestAnimationFrame(() => {
      const { pending } = this;
      this.pending = this.early = false;
      if (pending) this.draw();
    });
  }

  /** Draw before the next frame, which then is not late; at most once. */
  drawEarly() {
    if (!this.pending || this.early) return;
    this.early = true;
    this.pending = false;
    this.draw();
  }

  /** Draw on the canvas, or on paper of the same size. @param {Paper["ctx"] & { w: number, h: number }} [paper] */
  draw(paper) {
    const { motion, canvas, painter } = this;
    if (!canvas.clientWidth) return;
    for (const mesh of [motion.mesh, motion.otherMesh]) mesh?.update(motion.cursor, motion.share * (motion.mesh?.scale ?? 1));
    this.keepUp();
    const sheet = painter.paint(paper ? { ctx: paper, w: paper.w, h: paper.h } : null);
    this.marks.draw(sheet);
    for (const draw of this.overlays) draw(sheet);
    if (!paper) this.point();
  }

  // Under the pointer ------------------------------------------------------------------------------

  bindPointer() {
    const { canvas } = this;
    const leave = () => { this.pointer = null; this.invalidate(); };
    for (const type of ["pointerdown", "pointermove"]) canvas.addEventListener(type, (event) => {
      const { clientX, clientY } = /** @type {PointerEvent} */ (event), { left, top } = canvas.getBoundingClientRect();
      this.pointer = [clientX - left, clientY - top];
      this.invalidate();
    });
    canvas.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") leave(); });
    canvas.addEventListener("dblclick", () => this.fit());
    document.addEventListener("pointerdown", (event) => { if (event.target !== canvas && this.pointer) leave(); });
  }

  /** Find and describe the object under the pointer. */
  point() {
    const { canvas, motion, painter, pointer } = this, moving = canvas.classList.contains("grabbing");
    const hover = pointer && !moving ? (motion.mesh?.hit(pointer, this.seen()) ?? painter.hit(pointer)) : null;
    if (hover?.item !== this.hover?.item) {
      painter.highlight(hover?.item ?? null);
      this.invalidate();
    }
    this.hover = hover;
    drawTip(this);
  }
}

/** Half the width of a bar, small against the scene and against the bars [m]. @param {Motion} motion @param {number} whole */
function symbolSize({ bodies, dimension }, whole) {
  const lengths = bodies.flatMap(({ shapes }) => shapes.filter(({ kind }) => kind === "bar").map(({ from, to }) => distance(from, to))).sort((a, b) => a - b);
  const typical = lengths.length ? lengths[Math.floor(0.3 * lengths.length)] : Infinity;
  return clamp(Math.min(0.0115 * whole, (dimension === 3 ? 0.12 : 0.16) * typical), 0.003 * whole, whole);
}

/** Mean lengths of links over the motion; links between the same points lie beside each other. @param {Motion} motion */
function measureLinks(motion) {
  const place = (/** @type {Link["i"]} */ { body, point }) => `${body.name}@${point.map((v) => v.toPrecision(6))}`, frames = motion.frames(60);
  /** @type {Map<string, Link[]>} */
  const bundles = new Map();
  for (const link of motion.links) {
    const key = [place(link.i), place(link.j)].sort().join("|");
    bundles.set(key, [...bundles.get(key) ?? [], link]);
    const lengths = frames.map((cursor) => {
      const p = motion.at(link.i.body, link.i.point, cursor), q = motion.at(link.j.body, link.j.point, cursor);
      return p && q ? distance(p, q) : NaN;
    }).filter(Number.isFinite);
    link.rest = lengths.reduce((sum, v) => sum + v, 0) / (lengths.length || 1);
  }
  for (const links of bundles.values()) links.forEach((link, k) => { link.offset = k - (links.length - 1) / 2; });
}

/** Give the discs of two gears in mesh teeth of one pitch. @param {Motion} motion @param {Item} item */
function cutTeeth(motion, { mesh, internal }) {
  const start = { i: 0, f: 0 }, places = mesh.map(({ body, point }) => motion.at(body, point, start));
  const discs = mesh.map(({ body, point, radius }) => body.shapes.find((shape) => shape.kind === "disc" && distance(shape.center, point) < 1e-6 * radius && Math.abs(shape.radius - radius) < 1e-6 * radius));
  const [p, q] = places, [first, second] = discs;
  if (!p || !q || !first || !second) return;
  const cut = [first, second].findIndex(({ teeth }) => teeth), smaller = Math.min(mesh[0].radius, mesh[1].radius);
  const pitch = cut < 0 ? (TAU * smaller) / TEETH : (TAU * mesh[cut].radius) / /** @type {NonNullable<Shape["teeth"]>} */ ([first, second][cut].teeth).count;
  [first, second].forEach((disc, k) => {
    const { body, radius } = mesh[k], ring = internal && radius > smaller;
    if (disc.teeth) return;
    // In a ring, both wheels touch beyond the smaller one.
    const sign = (k ? -1 : 1) * (internal && !ring ? -1 : 1), toward = q.map((v, axis) => sign * (v - p[axis]));
    disc.teeth = { count: Math.max(6, Math.round((TAU * radius) / pitch)), toward: motion.turnedBack(body, toward, start), gap: Boolean(k), ring };
  });
}
