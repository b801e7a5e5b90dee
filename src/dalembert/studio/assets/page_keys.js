// Keys of the whole page, and keys of the drawing that wait for the first picture of a model of another kind.

/** @import { CommandQueue } from "./command_queue.js" */
/** @import { StudioPage } from "./studio.js" */

import { byId } from "./dom.js";
import { isTyped } from "./picture_events.js";

/** Keys with names that the drawing has. */
const NAMED = /^(Enter|Escape|Backspace|Delete|Arrow(Left|Right|Up|Down))$/;

/** Keys pressed while the picture is still that of the model before, a planar one of a spatial model for example: the drawing gets them with its first picture. */
export class PostponedKeys {
  /** @param {{ possible: boolean }[]} surfaces that are drawn on @param {CommandQueue} commands @param {() => number} opened number of the open file */
  constructor(surfaces, commands, opened) {
    this.surfaces = surfaces;
    this.commands = commands;
    this.opened = opened;
    /** @type {{ target: EventTarget, key: string, shiftKey: boolean, opened: number }[]} */
    this.waiting = [];
  }

  /** Let a key wait where nothing can be drawn on. @param {KeyboardEvent} event */
  take(event) {
    const { key, shiftKey, target } = event, onButton = /** @type {HTMLElement | null} */ (target)?.closest?.("button, a, summary, [role=separator]");
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || isTyped(event) || key === "?" || !(NAMED.test(key) || [...key].length === 1)) return;
    if (!target || (onButton && /^(Enter| |Arrow.*)$/.test(key)) || this.surfaces.some(({ possible }) => possible)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    this.waiting.push({ target, key, shiftKey, opened: this.opened() });
    if (this.waiting.length === 1) this.commands.do(() => this.repeat(), true);
  }

  /** Give the keys to the drawing, unless another file was opened or it has no picture. */
  repeat() {
    const keys = this.waiting.splice(0).filter(({ opened }) => opened === this.opened());
    if (!this.surfaces.some(({ possible }) => possible)) return;
    for (const { target, key, shiftKey } of keys) target.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey, bubbles: true, cancelable: true }));
  }
}

/** Let the parts of the page listen to keys. @param {StudioPage} studio */
export function bindKeys(studio) {
  const { space, spaceStructure, structure, drawing, insight } = studio, surfaces = [space, spaceStructure, structure, drawing];
  const postponed = new PostponedKeys(surfaces, studio.commands, () => studio.file.opened);
  document.addEventListener("keydown", (event) => postponed.take(event));
  // Overlays come last: their keys are digits, which are typed numbers while one draws.
  for (const listening of [...surfaces, insight.overlays]) document.addEventListener("keydown", (event) => listening.key(event));
  document.addEventListener("keydown", (event) => pageKey(studio, event));
  studio.pictures.onShow.push(() => studio.pictures.frame?.contentWindow?.addEventListener("keydown", (event) => pageKey(studio, event)));
}

/** Keys of files, undo and help. @param {StudioPage} studio @param {KeyboardEvent} event */
function pageKey(studio, event) {
  if (event.defaultPrevented || byId("ask").hasAttribute("open")) return;
  const typing = /** @type {HTMLElement} */ (event.target)?.closest?.("input, textarea, .cm-editor");
  if (event.key === "?" && !typing) return studio.help();
  if (!(event.ctrlKey || event.metaKey)) return;
  const { saving } = studio, act = { s: () => (event.shiftKey ? saving.saveAs() : saving.save()), o: () => studio.request("files"), z: () => (event.shiftKey ? studio.redo() : studio.undo()), y: () => studio.redo() }[event.key.toLowerCase()];
  if (!act) return;
  event.preventDefault();
  act();
}
