// Picture of the model: the page of its analysis in a frame, replaced without a flicker.

/** @import { PictureMessage } from "./types.d.ts" */

import { PictureFrames, fill } from "./picture_frames.js";
import { PictureSettings } from "./picture_settings.js";

/** Time without a press of a key or a button after which a picture is replaced [ms]: a press during the replacement would be lost. */
const CALM = 150;

/** Parts of a page of the report, and the contents of the file that it shows. @typedef {{ player: any, motion: any, scene: any, design?: any, document?: import("./types.d.ts").Document | null }} Page */

/** A picture, the addresses of its data and of its frame. @typedef {{ number: number, live: boolean, page: string, address: string }} Wanted */

export class Pictures {
  /** @param {HTMLElement} stage */
  constructor(stage) {
    this.stage = stage;
    this.frames = new PictureFrames(stage);
    this.settings = new PictureSettings();
    /** The shown frame. @type {HTMLIFrameElement | null} */
    this.frame = null;
    /** The frame that loads. @type {HTMLIFrameElement | null} */
    this.next = null;
    /** Whether it has data. */
    this.filled = false;
    /** The picture that is loaded. @type {Wanted | null} */
    this.wanted = null;
    /** Listeners to a new picture. @type {((page: Page) => void)[]} */
    this.onShow = [];
    this.shown = -1;
    /** Revision of the text that the shown page has made itself. */
    this.own = -1;
    this.live = false;
    /** Whether a button is pressed in the picture, which stays until it is released. */
    this.held = false;
    /** Time of the last press of a key or a button [ms]. */
    this.pressed = -CALM;
    this.listen(window);
  }

  /** Note the presses of keys and buttons; keys that repeat themselves while they are held come again. @param {Window} view */
  listen(view) {
    for (const kind of ["keydown", "pointerdown"]) view.addEventListener(kind, (event) => { if (!(/** @type {KeyboardEvent} */ (event).repeat)) this.pressed = performance.now(); }, true);
    view.addEventListener("keydown", ({ key }) => { if (key === "Enter" || key === "Escape") this.held = false; }, true);  // they end a drag
  }

  /** Note how long a button is pressed in a picture. @param {Window} view */
  watch(view) {
    this.listen(view);
    view.addEventListener("pointerdown", ({ target }) => { this.held = !(/** @type {HTMLElement} */ (target).closest?.("select")); }, true);  // lists take the end of a press
    for (const kind of ["pointerup", "pointercancel"]) view.addEventListener(kind, () => { this.held = false; }, true);
    view.addEventListener("pointermove", ({ buttons }) => { this.held &&= buttons !== 0; }, true);
  }

  /** Whether a press of a key or a button goes on, or may follow at once. */
  get busy() { return this.held || performance.now() - this.pressed < CALM; }

  /** Whether the text that the picture showed last has no picture. */
  get outdated() { return this.stage.classList.contains("outdated"); }

  /** Parts of the shown page. @returns {Page | null} */
  get page() { return partsOf(this.frame); }

  /** @param {PictureMessage} message */
  receive({ number, page, frame, live, revision }) {
    if (revision === this.own) {
      this.shown = number;
      this.stage.classList.remove("outdated");
      return;
    }
    if (page || !live) this.stage.classList.toggle("outdated", !page && (this.frame ?? this.next) !== null);
    if (!page || !frame || number < this.shown || (number === this.shown && this.live)) return;
    const wanted = this.wanted = { number, live, page, address: frame };
    if (!this.next || this.filled || this.next.getAttribute("src") !== frame) {
      this.next?.remove();
      [this.next, this.filled] = [this.frames.take(frame), false];
    }
    void this.load(this.next, wanted);
  }

  /** Load the data of a page, and show it in a frame unless another one is wanted by then. @param {HTMLIFrameElement} frame @param {Wanted} wanted */
  async load(frame, wanted) {
    const { page, address, number, live } = wanted;
    const text = await fetch(page).then((reply) => (reply.ok ? reply.text() : "")).catch(() => "");
    if (wanted !== this.wanted || !text) return;
    this.filled = true;
    await fill(frame, text, document.documentElement.dataset.theme ?? "light");
    this.frames.prepare(address);
    await this.replace(frame, number, live);
  }

  /** @param {HTMLIFrameElement} frame @param {number} number @param {boolean} live */
  async replace(frame, number, live) {
    while (this.busy && frame === this.next) await new Promise((resolve) => setTimeout(resolve, 20));
    const page = partsOf(frame);
    if (frame !== this.next || !page) return;
    const { page: before } = this;
    if (before && this.frame?.contentDocument) this.settings.note(before, this.frame.contentDocument);
    keepView(before, page, number === this.shown);
    setTheme(frame, document.documentElement.dataset.theme ?? "light");
    frame.classList.remove("loading");
    if (document.activeElement === this.frame) window.focus();  // keys reach the drawing by the document
    this.frame?.remove();
    if (frame.contentWindow) this.watch(frame.contentWindow);
    this.held = false;
    [this.frame, this.next, this.shown, this.live] = [frame, null, number, live];
    for (const listener of this.onShow) listener(page);
    if (frame.contentDocument) this.settings.restore(page, frame.contentDocument);
    document.documentElement.dataset.picture = `${number}${live ? " live" : ""}`;
  }

  /** The next picture is that of another file, as it comes. */
  forget() {
    if (this.page) this.page.scene.view.fitted = true;
    this.settings.clear();
  }

  /** @param {string} name */
  setTheme(name) { if (this.frame) setTheme(this.frame, name); }
}

/** Whether one of the places is outside the drawing as it is shown. @param {Page | null} page @param {number[][]} places */
export function isOutside(page, places) {
  if (!page) return false;
  const { view, canvas } = page.scene, spots = places.map((place) => view.screen(place));
  return spots.some((at) => !at || at[0] < 0 || at[1] < 0 || at[0] > canvas.clientWidth || at[1] > canvas.clientHeight);
}

/** @param {HTMLIFrameElement | null} frame @returns {Page | null} */
function partsOf(frame) {
  return /** @type {any} */ (frame?.contentWindow)?.dalembert ?? null;
}

/** @param {HTMLIFrameElement} frame @param {string} name */
function setTheme(frame, name) {
  const root = frame.contentDocument?.documentElement;
  if (root && root.dataset.theme !== name) /** @type {HTMLElement | null} */ (frame.contentDocument?.getElementById("theme"))?.click();
}

/** Same part of the plane, and the same time while the motion is the same.
 * @param {Page | null} before @param {Page} after @param {boolean} same */
function keepView(before, after, same) {
  if (!before) return;
  const [old, view] = [before.scene.view, after.scene.view];
  if ("s" in old && "s" in view && !old.fitted) {
    [view.x, view.y, view.s, view.fitted] = [old.x, old.y, old.s, false];
    view.onChange();
  } else if (old.adopt && view.adopt) {
    const { fitted } = old;
    view.adopt(old);
    if (fitted) after.scene.fit();
  }
  if (same) after.player.seek(before.player.time);
  if (!before.player.playing && before.motion.moves) {
    after.player.pause();
    if (!same) after.player.seek(Math.min(before.player.time, after.motion.end));
  }
}
