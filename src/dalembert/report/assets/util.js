// Numbers, ticks, colours, DOM.

const TAU = 2 * Math.PI;
const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));
const list = (x) => (Array.isArray(x) || ArrayBuffer.isView(x) ? x : []);
const isNum = (x) => typeof x === "number" && Number.isFinite(x);
const xy = (p) => (Array.isArray(p) && isNum(p[0]) && isNum(p[1]) ? [p[0], p[1]] : [0, 0]);

// A column of n numbers; what is missing becomes NaN.
function floats(values, n) {
  if (values instanceof Float64Array && values.length === n) return values;
  const out = new Float64Array(n).fill(NaN);
  const given = list(values);
  for (let i = 0; i < Math.min(n, given.length); i++) {
    if (typeof given[i] === "number") out[i] = given[i];
  }
  return out;
}

// The same of one number that stays.
const steady = (value, n) => floats(list(value).length ? value : Array(n).fill(isNum(value) ? value : 0), n);

// The smallest and largest of some columns, or null when there is no number.
function extent(columns) {
  let lo = Infinity, hi = -Infinity;
  for (const column of columns) {
    for (const v of column) {
      if (v < lo) lo = v;
      if (v > hi) hi = v;
    }
  }
  return lo <= hi ? [lo, hi] : null;
}

// 1, 2 or 5 times a power of ten, at least x.
function niceAbove(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  for (const m of [1, 2, 5]) if (m * power >= x * (1 - 1e-9)) return m * power;
  return 10 * power;
}

function ticks(lo, hi, count) {
  const step = niceAbove((hi - lo) / Math.max(1, count));
  const out = [];
  for (let k = Math.ceil(lo / step - 1e-9); k <= Math.floor(hi / step + 1e-9); k++) out.push(k * step);
  return { step, values: out };
}

const minus = (text) => text.replaceAll("-", "\u2212");
const superscript = (k) => minus(String(k)).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");

function number(x, digits = 4) {
  if (!isNum(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) {
    const [m, e] = x.toExponential(digits - 1).split("e");
    return `${minus(m)}·10${superscript(+e)}`;
  }
  const whole = size >= 1 ? Math.floor(Math.log10(size)) + 1 : 0;
  return minus(x.toFixed(clamp(digits - whole, 0, 7)));
}

function tidy(x, digits = 6) {
  if (!isNum(x)) return "–";
  const short = +x.toPrecision(digits), size = Math.abs(short);
  return minus(size && (size < 1e-3 || size >= 1e6) ? short.toExponential() : String(short));
}

const decimalsOf = (step) => clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 12);
const fixed = (x, decimals) => {
  const text = x.toFixed(decimals);
  return minus(Number(text) === 0 ? text.replace("-", "") : text);
};

// Time with just the decimals that the span asks for.
const clock = (t, span) => fixed(t, span > 0 ? clamp(Math.ceil(3 - Math.log10(span)), 0, 9) : 3);

// SI unit → [factor, name] of the unit chosen for it.
const chosenUnits = new Map();
const chooseUnits = (units) => Object.entries(units || {}).forEach(([si, told]) => chosenUnits.set(si, told));

function metres(x) {
  if (chosenUnits.has("m")) {
    const [factor, name] = chosenUnits.get("m");
    return withUnit(tidy(x / factor, 4), name);
  }
  const [k, unit] = x >= 1000 ? [1e-3, "km"] : x >= 0.9999 ? [1, "m"] : x >= 0.9999e-3 ? [1e3, "mm"] : [1e6, "µm"];
  return `${+(x * k).toPrecision(4)} ${unit}`;
}

// Numbers in the unit chosen for theirs; what is round-off beside the largest or a scale is zero.
function inUnits(values, si, { scale = 0, digits = 4 } = {}) {
  const [factor, name] = chosenUnits.get(si) ?? [1, si.replace(" ", "·")], size = Math.max(scale, ...values.map(Math.abs));
  return withUnit(values.map((x) => number(Math.abs(x) < 1e-12 * size ? 0 : x / factor, digits)).join(", "), name);
}

const degrees = (a) => `${number((a * 360) / TAU, 4)}°`;
const unitOf = (item) => (item.unit === undefined || item.unit === null || item.unit === "" ? "1" : String(item.unit));
// m² for m^2.
const raised = (unit) => String(unit).replace(/\^(-?\d+)/g, (_, power) => superscript(+power));
const withUnit = (text, unit) => (unit && unit !== "1" ? `${text} ${raised(unit)}` : text);

const channels = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
// t = 0 gives a, t = 1 gives b.
function mix(a, b, t) {
  const [p, q] = [channels(a), channels(b)];
  return "#" + p.map((v, i) => Math.round(v + (q[i] - v) * t).toString(16).padStart(2, "0")).join("");
}

// Colours for series and bodies after Okabe and Ito, for light and dark ground.
const PALETTE = {
  light: ["#0072b2", "#d55e00", "#009e73", "#b0508a", "#b07a00", "#3a9ad9", "#5b6470"],
  dark: ["#56b4e9", "#ff8a3d", "#2fc79a", "#e08fbf", "#f0c245", "#8fb4ff", "#b4bec9"],
};
const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

class Signal {
  constructor() { this.listeners = []; }
  on(listener) { this.listeners.push(listener); }
  emit(...args) { for (const listener of this.listeners) listener(...args); }
}

const Theme = {
  name: "light",
  listeners: new Signal(),
  read() {
    const style = getComputedStyle(document.documentElement);
    this.name = document.documentElement.dataset.theme === "dark" ? "dark" : "light";
    for (const key of ["bg", "surface", "ink", "muted", "line", "grid", "accent", "force", "moment", "error"]) {
      this[key] = style.getPropertyValue(`--${key}`).trim();
    }
    this.font = style.getPropertyValue("--font").trim() || "sans-serif";
  },
  colour(i) {
    const colours = PALETTE[this.name];
    return colours[i % colours.length];
  },
};

// el("button", {class: "x", onclick: f, "aria-label": "Play"}, "text", child)
function el(tag, props = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key in node && typeof value !== "string") node[key] = value;
    else node.setAttribute(key, value);
  }
  node.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return node;
}

const ICONS = {
  play: "M8 5.5v13l10.5-6.5z",
  pause: "M7 5h3.6v14H7zM13.4 5H17v14h-3.6z",
  back: "M17 6v12l-8.5-6zM6 6h2v12H6z",
  next: "M7 6v12l8.5-6zM16 6h2v12h-2z",
  loop: "M7 7h9.5V4l4.5 4-4.5 4V9H9v4H7zM17 17H7.5v3L3 16l4.5-4v3H15v-4h2z",
  plus: "M11 5h2v6h6v2h-6v6h-2v-6H5v-2h6z",
  minus: "M5 11h14v2H5z",
  fit: "M4 4h6v2H6v4H4zM14 4h6v6h-2V6h-4zM4 14h2v4h4v2H4zM18 14h2v6h-6v-2h4z",
  close: "M6.4 5 12 10.6 17.6 5 19 6.4 13.4 12l5.6 5.6-1.4 1.4-5.6-5.6L6.4 19 5 17.6 10.6 12 5 6.4z",
  save: "M11 4h2v8.2l3.1-3.1 1.4 1.4L12 16l-5.5-5.5 1.4-1.4 3.1 3.1zM5 18h14v2H5z",
  theme: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zm0 2.2v13.6a6.8 6.8 0 0 1 0-13.6z",
  print: "M7 4h10v4H7zM5 9h14a2 2 0 0 1 2 2v6h-4v3H7v-3H3v-6a2 2 0 0 1 2-2zm4 6v3h6v-3z",
  cross: "M4 4h2v14h14v2H4zM8 13l4-5 3 3 4-5 1.6 1.2L15 14l-3-3-2.4 3z",
  edit: "M4 6h10v2H4zM4 11h10v2H4zM4 16h6v2H4zM17 11h2v3h3v2h-3v3h-2v-3h-3v-2h3z",
};

function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(svg.namespaceURI, "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

const iconButton = (name, label, onclick, more = {}) =>
  el("button", { type: "button", class: "icon", "aria-label": label, title: label, onclick, ...more }, icon(name));

function toggleButton(label, pressed, onchange, more = {}) {
  const node = el("button", { type: "button", class: "chip", "aria-pressed": String(pressed), ...more }, label);
  node.addEventListener("click", () => {
    const now = node.getAttribute("aria-pressed") !== "true";
    node.setAttribute("aria-pressed", String(now));
    onchange(now);
  });
  return node;
}

// Gives the canvas as many device pixels as it needs; returns its size in CSS pixels.
function fitCanvas(canvas, ratio = window.devicePixelRatio || 1) {
  const { clientWidth: w, clientHeight: h } = canvas;
  const [pw, ph] = [Math.max(1, Math.round(w * ratio)), Math.max(1, Math.round(h * ratio))];
  if (canvas.width !== pw || canvas.height !== ph) [canvas.width, canvas.height] = [pw, ph];
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, w, h);
  return { ctx, w, h };
}


function download(name, text, type) {
  const url = URL.createObjectURL(text instanceof Blob ? text : new Blob([text], { type }));
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
