// A photo under the drawing, with a scale, from which a mechanism is traced.

/** @import { Page, Pictures } from "./pictures.js" */

import { ask } from "./ask.js";
import { button, el } from "./dom.js";

/** A photo: its upper left corner [m], metres per pixel, and opacity. @typedef {{ blob: Blob, x: number, y: number, scale: number, opacity: number }} Placed */

/** Part of the picture that a new photo fills. */
const SHARE = 0.8;
/** Time without a change after which the photo is stored [ms]. */
const REST = 300;
/** Units of a distance [m]. @type {Record<string, number>} */
const UNITS = { "": 1, m: 1, cm: 0.01, mm: 0.001, in: 0.0254, ft: 0.3048 };
/** Titles of the controls. */
const OPEN = "Show a photo under the drawing; images can also be dropped on it", SCALE = "Click two points of the photo, and type their distance", MOVE = "Drag the photo";
/** Reason for which they are disabled. */
const PLANAR = "Photos are shown under planar drawings only; this model is spatial.";
const DISTANCE = /^\s*([\d.]+(?:e[+-]?\d+)?)\s*(m|cm|mm|in|ft)?\s*$/i;

export class Photo {
  /** @param {Pictures} pictures @param {HTMLElement} stage @param {(text: string, failed?: boolean) => void} say */
  constructor(pictures, stage, say) {
    this.pictures = pictures;
    this.say = say;
    /** @type {Placed | null} */
    this.placed = null;
    /** @type {ImageBitmap | null} */
    this.image = null;
    /** What the pointer does. @type {"" | "scale" | "move"} */
    this.mode = "";
    /** Places of the scale, or the last one of a move [m]. @type {[number, number][]} */
    this.marks = [];
    /** Name under which the photo is stored. */
    this.name = "";
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.waiting = undefined;
    /** Whether the program has stored the photo as it is shown. */
    this.stored = true;
    this.opacity = el("input", { type: "range", min: "0.05", max: "1", step: "0.05", "aria-label": "Opacity", oninput: () => this.change({ opacity: Number(this.opacity.value) }) });
    this.modes = { scale: button("Scale", () => this.choose("scale"), { title: SCALE }), move: button("Move", () => this.choose("move"), { title: MOVE }) };
    this.panel = el("div", { class: "photo card", role: "group", "aria-label": "Photo", hidden: true }, el("span", {}, "Photo"), this.opacity, ...Object.values(this.modes), button("Remove", () => void this.remove()));
    this.input = el("input", { type: "file", accept: "image/*", hidden: true, "aria-label": "Photo", onchange: () => void this.load(this.input.files?.[0]) });
    /** Button of the bar that chooses an image file. */
    this.opener = button("Photo…", () => this.input.click(), { class: "button drawn", title: OPEN });
    stage.append(this.panel, this.input);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** Allow a photo under planar drawings only. @param {Page} page */
  allow(page) {
    const flat = "s" in page.scene.view;
    if (!flat) this.choose("");
    for (const [node, title] of /** @type {const} */ ([[this.opener, OPEN], [this.opacity, ""], [this.modes.scale, SCALE], [this.modes.move, MOVE]])) {
      node.disabled = !flat;
      node.title = flat ? title : PLANAR;
    }
  }

  /** Show the photo of a file. @param {string} name */
  async show(name) {
    if (name === this.name) return;
    this.name = name;
    const placed = await this.read().catch(() => null);
    if (this.name === name) await this.place(placed).catch(() => this.place(null));
  }

  /** @param {Placed | null} placed */
  async place(placed) {
    this.image = placed && await createImageBitmap(placed.blob);
    this.placed = placed;
    this.panel.hidden = !placed;
    if (placed) this.opacity.value = String(placed.opacity);
    this.choose("");
    this.pictures.page?.scene.invalidate();
  }

  /** @param {Blob | undefined} blob */
  async load(blob) {
    const view = this.pictures.page?.scene.view, canvas = this.pictures.page?.scene.canvas;
    this.input.value = "";
    if (!blob || !view || !("s" in view)) return this.say(PLANAR, true);
    try {
      const image = await createImageBitmap(blob), [w, h] = [canvas.clientWidth, canvas.clientHeight];
      const fit = SHARE * Math.min(w / image.width, h / image.height), [x, y] = view.world([(w - fit * image.width) / 2, (h - fit * image.height) / 2]);
      await this.place({ blob, x, y, scale: fit / view.s, opacity: 0.5 });
      this.keep();
      this.say("Set the scale: click Scale, then two points of the photo.");
    } catch {
      this.say("This file is no image that the browser can show.", true);
    }
  }

  /** @param {Partial<Placed>} values */
  change(values) {
    if (!this.placed) return;
    Object.assign(this.placed, values);
    this.keep();
    this.pictures.page?.scene.invalidate();
  }

  get address() { return `photo?name=${encodeURIComponent(this.name)}`; }

  /** The photo that the program has stored. @returns {Promise<Placed | null>} */
  async read() {
    const reply = await fetch(this.address).catch(() => null), place = JSON.parse(reply?.headers.get("X-Photo-Place") ?? "null");
    return reply?.status === 200 && place ? { ...place, blob: await reply.blob() } : null;
  }

  /** Let the program store the photo, when it does not change for a while. */
  keep() {
    clearTimeout(this.waiting);
    this.stored = false;
    const { address, placed } = this;
    this.waiting = setTimeout(async () => {
      const place = placed && JSON.stringify({ x: placed.x, y: placed.y, scale: placed.scale, opacity: placed.opacity });
      const reply = await fetch(address, place ? { method: "PUT", body: placed.blob, headers: { "X-Photo-Place": place } } : { method: "DELETE" }).catch(() => null);
      this.stored = placed === this.placed && Boolean(reply?.ok);
      if (!reply?.ok) this.say(`The photo is not stored: ${reply ? await reply.text() : "the program does not answer"}.`, true);
    }, REST);
  }

  async remove() {
    await this.place(null);
    this.keep();
  }

  /** @param {"" | "scale" | "move"} mode */
  choose(mode) {
    this.mode = this.mode === mode ? "" : mode;
    this.marks = [];
    for (const [name, node] of Object.entries(this.modes)) node.setAttribute("aria-pressed", String(name === this.mode));
  }

  /** @param {Page} page */
  bind(page) {
    this.allow(page);
    const { canvas, view } = page.scene, inner = /** @type {Window} */ (this.pictures.frame?.contentWindow);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => this.draw(ctx, page));
    inner.addEventListener("dragover", (event) => event.preventDefault());
    inner.addEventListener("drop", (event) => {
      event.preventDefault();
      void this.load(event.dataTransfer?.files[0]);
    });
    if (!("s" in view)) return;
    for (const kind of ["pointerdown", "pointermove", "pointerup"]) inner.addEventListener(kind, (event) => {
      if (!this.mode || event.target !== canvas) return;
      const { left, top } = canvas.getBoundingClientRect(), { clientX, clientY, buttons } = /** @type {PointerEvent} */ (event);
      event.stopImmediatePropagation();
      this.point(kind, view.world([clientX - left, clientY - top]), buttons);
    }, true);
    page.scene.invalidate();
  }

  /** @param {string} kind @param {[number, number]} at @param {number} buttons */
  point(kind, at, buttons) {
    const { placed } = this;
    if (!placed) return;
    if (this.mode === "move") {
      const last = this.marks[0];
      if (kind === "pointermove" && last && buttons) this.change({ x: placed.x + at[0] - last[0], y: placed.y + at[1] - last[1] });
      this.marks = kind === "pointerup" ? [] : [at];
    } else if (kind === "pointerdown") this.marks = [...this.marks, at].slice(0, 2);
    else if (kind === "pointerup" && this.marks.length === 2) void this.scale();  // the press itself moves the focus to the picture
    this.pictures.page?.scene.invalidate();
  }

  /** Scale the photo about the first of two places, which stays. */
  async scale() {
    const [from, to] = this.marks, shown = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const reply = shown > 0 ? await ask("Scale of the photo", "Distance of the two points, with a unit such as mm; metres without one.", { scale: "Scale" }, { name: "Distance", value: "" }) : null;
    const match = DISTANCE.exec(reply?.value ?? ""), distance = match ? Number(match[1]) * UNITS[(match[2] ?? "").toLowerCase()] : 0;
    this.choose("");
    if (reply && !(distance > 0)) this.say(`'${reply.value}' is no distance; type a positive number and a unit, such as 300 mm.`, true);
    if (!(distance > 0) || !this.placed) return;
    const { x, y, scale } = this.placed, factor = distance / shown;
    this.change({ x: from[0] + (x - from[0]) * factor, y: from[1] + (y - from[1]) * factor, scale: scale * factor });
  }

  /** @param {CanvasRenderingContext2D} ctx @param {Page} page */
  draw(ctx, page) {
    const { view } = page.scene, { placed, image } = this;
    if (!placed || !image || !("s" in view) || typeof ctx.drawImage !== "function") return;
    const [u, v] = view.screen([placed.x, placed.y]), size = placed.scale * view.s;
    ctx.save();
    ctx.globalCompositeOperation = "destination-over";
    ctx.globalAlpha = placed.opacity;
    ctx.drawImage(image, u, v, image.width * size, image.height * size);
    ctx.restore();
    for (const mark of this.mode === "scale" ? this.marks : []) {
      const [a, b] = view.screen(mark);
      ctx.beginPath();
      ctx.arc(a, b, 5, 0, 2 * Math.PI);
      ctx.lineWidth = 2;
      ctx.strokeStyle = "#d9480f";
      ctx.stroke();
    }
  }
}
