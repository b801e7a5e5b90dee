// What is drawn over the picture of a planar mechanism, chosen by buttons and the keys 1 to 9.

/** @import { Ghosts } from "./ghosts.js" */
/** @import { Page, Pictures } from "./pictures.js" */

import { button, el } from "./dom.js";
import { OVERLAYS, drawOverlays } from "./overlays.js";

/** Series of a plot by the name of its button. @type {Record<string, RegExp>} */
const PLOTS = { Power: /\.power$|^input_power$/, Energies: /^(kinetic_energy|potential_energy|energy|input_energy|dissipated_energy)$/ };

export class OverlayBar {
  /** @param {Pictures} pictures @param {Ghosts} ghosts @param {() => Set<string>} selected @param {() => boolean} draws whether digits belong to what is drawn @param {(text: string) => void} say shows a text below the drawing */
  constructor(pictures, ghosts, selected, draws, say) {
    this.say = say;
    this.selected = selected;
    this.draws = draws;
    this.pictures = pictures;
    this.ghosts = ghosts;
    /** Names of the drawn overlays. @type {Set<string>} */
    this.shown = new Set();
    /** Place under the pointer, and whether a button holds it. @type {[number, number] | null} */
    this.pointer = null;
    this.buttons = new Map(OVERLAYS.map(({ name, title, key, note }) => [name, button(`${title} `, () => this.toggle(name), { class: "pick", "aria-pressed": "false", title: `${note} (key ${key})`, "data-overlay": name })]));
    this.reactions = button("Joint reactions", () => this.toggleReactions(), { class: "pick", "aria-pressed": "false", title: "Reaction forces and moments at the joints (key 8)" });
    this.values = el("p", { class: "muted", role: "status" });
    this.node = el("fieldset", { class: "overlays" }, el("legend", {}, "On the picture"), el("div", { class: "picks" }, [...this.buttons.values()], this.reactions, ghosts.button),
      el("div", { class: "picks" }, Object.keys(PLOTS).map((name) => button(`Plot: ${name.toLowerCase()}`, () => this.plot(name), { class: "pick" }))), this.values, ghosts.node);
    pictures.onShow.push((page) => this.bind(page));
  }

  /** @param {Page} page */
  bind(page) {
    const view = /** @type {Window} */ (this.pictures.frame?.contentWindow), { canvas } = page.scene;
    view.addEventListener("keydown", (event) => this.key(event), true);
    view.addEventListener("pointermove", (event) => {
      const { left, top } = canvas.getBoundingClientRect();
      this.pointer = event.target === canvas ? [event.clientX - left, event.clientY - top] : null;
      if (this.shown.size) page.scene.invalidate();
    }, true);
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => this.draw(ctx, page));
    if (this.reactions.getAttribute("aria-pressed") === "true") this.setReactions(true);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const typing = /** @type {HTMLElement} */ (event.target)?.closest?.("input, select, textarea, .cm-editor, dialog");
    if (typing || this.draws() || event.ctrlKey || event.metaKey || event.altKey) return;
    const overlay = OVERLAYS.find(({ key }) => key === event.key);
    if (overlay) this.toggle(overlay.name);
    else if (event.key === "8") {
      this.toggleReactions();
      if (this.values.textContent) this.say(this.values.textContent);  // its sheet may be hidden
    }
    else if (event.key === "9") this.ghosts.toggle();
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  /** @param {string} name */
  toggle(name) {
    if (!this.shown.delete(name)) this.shown.add(name);
    this.buttons.get(name)?.setAttribute("aria-pressed", String(this.shown.has(name)));
    this.pictures.page?.scene.invalidate();
  }

  toggleReactions() { this.setReactions(this.reactions.getAttribute("aria-pressed") !== "true"); }

  /** Arrows of the report at the joints. @param {boolean} on */
  setReactions(on) {
    const { page, frame } = this.pictures, toggle = /** @type {HTMLElement | null} */ (frame?.contentDocument?.getElementById("reactions"));
    this.reactions.setAttribute("aria-pressed", String(on));
    this.values.textContent = on && page && !toggle ? "This analysis has no reactions; choose dynamics or inverse dynamics." : "";
    if (toggle && page && page.scene.show.forces !== on) toggle.click();
  }

  /** Add a plot to the page. @param {string} name */
  plot(name) {
    const { page } = this.pictures, board = /** @type {any} */ (page)?.board, names = (page?.motion.series ?? []).map((/** @type {{ name: string }} */ series) => series.name).filter((/** @type {string} */ series) => PLOTS[name].test(series));
    this.values.textContent = board && names.length ? "" : `This analysis has no ${name.toLowerCase()}; choose dynamics${name === "Power" ? " of a driven mechanism" : ""}.`;
    if (board && names.length) {
      board.add(names);
      board.plots.at(-1).node.scrollIntoView({ block: "nearest" });
    }
  }

  /** @param {CanvasRenderingContext2D} ctx @param {Page} page */
  draw(ctx, page) {
    if (!this.shown.size || !("s" in page.scene.view) || page.motion.mesh || page.motion.swings) return;
    drawOverlays(ctx, page, this.shown, this.pointer, this.selected());
  }
}
