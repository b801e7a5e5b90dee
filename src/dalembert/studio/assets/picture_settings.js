// What is chosen in a picture: shown parts, colours, section, scale, speed, traced points. The next picture has it too.

/** @import { Page } from "./pictures.js" */

/** @typedef {HTMLButtonElement | HTMLSelectElement | HTMLInputElement} Control */

const CONTROLS = "#stage button[aria-pressed], #stage select, #stage input[type=range]:not(#scrub, #scale)";
/** Key of the scale of displacements, and its value where displacements have their true size. */
const SCALE = "scale", TRUE = "1 : 1";

export class PictureSettings {
  constructor() {
    /** Key of a control → value that was chosen. @type {Map<string, string>} */
    this.chosen = new Map();
    /** Values of the shown picture as it came, and as it was shown. @type {Map<string, string>} */
    this.initial = new Map();
    /** @type {Map<string, string>} */
    this.shown = new Map();
  }

  /** Leave all as the next picture comes, which is that of another file. */
  clear() { [this.chosen, this.initial, this.shown] = [new Map(), new Map(), new Map()]; }

  /** Note what was chosen in the shown picture. @param {Page} page @param {Document} root */
  note(page, root) {
    for (const [key, value] of values(page, root)) {
      if (!this.shown.has(key) || value === this.shown.get(key)) continue;
      if (value === this.initial.get(key)) this.chosen.delete(key);
      else this.chosen.set(key, value);
    }
  }

  /** Choose it in the next one. @param {Page} page @param {Document} root */
  restore(page, root) {
    this.initial = values(page, root);
    for (const control of controlsOf(root)) {
      const key = keyOf(control), value = this.chosen.get(key);
      if (value !== undefined && value !== this.initial.get(key)) set(page, control, value);
    }
    const scale = this.chosen.get(SCALE), moving = movingOf(page);
    if (scale !== undefined && moving) {
      moving.factor = scale === TRUE ? 1 / moving.automatic : Number(scale);
      page.motion.onState.emit();
    }
    this.shown = values(page, root);
  }
}

/** @param {Document} root @returns {Control[]} */
const controlsOf = (root) => [...root.querySelectorAll(CONTROLS)].map((node) => /** @type {Control} */ (node)).filter((control) => keyOf(control));

/** @param {Control} control */
const keyOf = ({ id, title }) => id || title;

/** Displacements of a structure, or of modes. @param {Page} page */
const movingOf = ({ motion }) => motion.mesh ?? motion.swing ?? null;

/** Values of all controls. @param {Page} page @param {Document} root @returns {Map<string, string>} */
function values(page, root) {
  const all = new Map(controlsOf(root).map((control) => [keyOf(control), valueOf(page, control)])), moving = movingOf(page);
  if (moving) all.set(SCALE, !moving.relative && moving.factor !== 1 && Math.abs(moving.scale - 1) < 1e-9 ? TRUE : String(moving.factor));
  return all;
}

/** @param {Page} page @param {Control} control */
function valueOf(page, control) {
  if (control.tagName === "BUTTON") return control.getAttribute("aria-pressed") ?? "";
  if (control.tagName === "SELECT") return /** @type {HTMLSelectElement} */ (control).selectedOptions[0]?.text ?? "";
  if (control.id !== "section-place") return control.value;
  const { middle, radius } = extentOf(page, control);
  return String(middle + Number(control.value) * radius);
}

/** @param {Page} page @param {Control} control @param {string} value */
function set(page, control, value) {
  if (control.tagName === "BUTTON") return control.click();
  if (control.tagName === "SELECT") {
    const option = [.../** @type {HTMLSelectElement} */ (control).options].find(({ text }) => text === value);
    if (!option) return;
    control.value = option.value;
  } else {
    const { middle, radius } = extentOf(page, control);
    control.value = control.id === "section-place" ? String((Number(value) - middle) / radius) : value;
  }
  for (const type of ["input", "change"]) control.dispatchEvent(new Event(type));
}

/** Extent of the drawing across a section: its position in space is kept. @param {Page} page @param {Control} control */
function extentOf({ scene: { view } }, control) {
  const axis = /** @type {HTMLSelectElement | null} */ (control.ownerDocument.getElementById("section-axis"))?.value ?? "x";
  return { middle: view.centre?.[axis] ?? 0, radius: view.radius ?? 1 };
}
