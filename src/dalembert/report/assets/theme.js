// Colours of light, dark and printed pages.

/** Colours of series and bodies after Okabe and Ito. */
export const PALETTE = {
  light: ["#0072b2", "#d55e00", "#009e73", "#b0508a", "#b07a00", "#3a9ad9", "#5b6470"],
  dark: ["#56b4e9", "#ff8a3d", "#2fc79a", "#e08fbf", "#f0c245", "#8fb4ff", "#b4bec9"],
};

/** @param {string} hex */
const channels = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** Mixture of two colours: t = 0 is a, t = 1 is b. @param {string} a @param {string} b @param {number} t */
export function mix(a, b, t) {
  const [p, q] = [channels(a), channels(b)];
  return "#" + p.map((v, i) => Math.round(v + (q[i] - v) * t).toString(16).padStart(2, "0")).join("");
}

/** Listeners to a change. @template [T=void] */
export class Signal {
  constructor() {
    /** @type {((value: T) => void)[]} */
    this.listeners = [];
  }

  /** @param {(value: T) => void} listener */
  on(listener) { this.listeners.push(listener); }

  /** @param {T} value */
  emit(value) { for (const listener of this.listeners) listener(value); }
}

const COLOURS = /** @type {const} */ (["bg", "surface", "ink", "muted", "line", "grid", "accent", "force", "moment", "error"]);

/** Colours in use, from the style sheet. */
export const Theme = {
  name: /** @type {"light" | "dark"} */ ("light"),
  font: "sans-serif",
  bg: "", surface: "", ink: "", muted: "", line: "", grid: "", accent: "", force: "", moment: "", error: "",
  /** @type {Signal} */
  listeners: new Signal(),

  read() {
    const style = getComputedStyle(document.documentElement);
    this.name = document.documentElement.dataset.theme === "dark" ? "dark" : "light";
    for (const key of COLOURS) this[key] = style.getPropertyValue(`--${key}`).trim();
    this.font = style.getPropertyValue("--font").trim() || "sans-serif";
  },

  /** @param {"light" | "dark"} name */
  set(name) {
    document.documentElement.dataset.theme = name;
    this.read();
    this.listeners.emit();
  },

  /** Colour of the i-th series. @param {number} i */
  colour(i) {
    const colours = PALETTE[this.name];
    return colours[i % colours.length];
  },
};
