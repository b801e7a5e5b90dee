// Elements of the page: creation, buttons, menus.

/** @import { Attributes, Child } from "./types.d.ts" */

/** @param {string} id */
export const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** Element in which an event occurred. @param {Event} event */
export const targetOf = (event) => /** @type {HTMLElement} */ (event.target);

/** @param {Element} node @param {Attributes} attributes @param {Child[]} children */
function fill(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), /** @type {EventListener} */ (value));
    else if (typeof value !== "string" && node instanceof HTMLElement && key in node) Object.assign(node, { [key]: value });
    else node.setAttribute(key, String(value));
  }
  append(node, children);
}

/** @param {Element} node @param {Child} child */
function append(node, child) {
  if (Array.isArray(child)) child.forEach((item) => append(node, item));
  else if (child !== null && child !== undefined && child !== false) node.append(child);
}

/** HTML element: `el("button", { class: "x", onclick: f, "aria-label": "Play" }, "text", child)`.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag @param {Attributes} attributes @param {...Child} children */
export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  fill(node, attributes, children);
  return node;
}

/** SVG element.
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} tag @param {Attributes} attributes @param {...Child} children */
export function shape(tag, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(node, attributes, children);
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
  lock: "M12 2a5 5 0 0 0-5 5v3H5v12h14V10h-2V7a5 5 0 0 0-5-5zm-3 8V7a3 3 0 0 1 6 0v3z",
  undo: "M8 4 2.5 9.5 8 15v-4h6a4 4 0 0 1 0 8h-4v2h4a6 6 0 0 0 0-12H8z",
  redo: "M16 4l5.5 5.5L16 15v-4h-6a4 4 0 0 0 0 8h4v2h-4a6 6 0 0 1 0-12h6z",
  eye: "M12 5C6 5 2.5 12 2.5 12S6 19 12 19s9.5-7 9.5-7S18 5 12 5zm0 11a4 4 0 1 1 0-8 4 4 0 0 1 0 8z",
  edit: "M4 6h10v2H4zM4 11h10v2H4zM4 16h6v2H4zM17 11h2v3h3v2h-3v3h-2v-3h-3v-2h3z",
};

/** @param {keyof typeof ICONS} name */
export const icon = (name) => shape("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, shape("path", { d: ICONS[name] }));

/** @param {keyof typeof ICONS} name @param {string} label @param {() => void} onclick @param {Attributes} more */
export const iconButton = (name, label, onclick, more = {}) =>
  el("button", { type: "button", class: "icon", "aria-label": label, title: label, onclick, ...more }, icon(name));

/** @param {Child} label @param {boolean} pressed @param {(pressed: boolean) => void} onchange @param {Attributes} more */
export function toggleButton(label, pressed, onchange, more = {}) {
  const node = el("button", { type: "button", class: "chip", "aria-pressed": String(pressed), ...more }, label);
  node.addEventListener("click", () => {
    const now = node.getAttribute("aria-pressed") !== "true";
    node.setAttribute("aria-pressed", String(now));
    onchange(now);
  });
  return node;
}

/** A button that opens controls below it; Escape and a click elsewhere close it.
 * @param {Child} name @param {Child[]} rows @param {Attributes} more */
export function menu(name, rows, more = {}) {
  const { class: look = "chip", "aria-label": label, title, ...rest } = more;
  const summary = el("summary", { class: look, "aria-label": label, title }, name);
  const box = el("details", { ...rest, class: "menu", "aria-label": `Menu: ${label ?? (typeof name === "string" ? name : title)}` }, summary, el("div", { class: "menu-box card" }, rows));
  box.addEventListener("keydown", (e) => { if (e.key === "Escape" && box.open) { box.open = false; summary.focus(); } });
  box.addEventListener("click", (e) => { if (targetOf(e).closest(".menu-item") && !targetOf(e).closest("#save-film")) box.open = false; });
  document.addEventListener("pointerdown", (e) => { if (!box.contains(targetOf(e))) box.open = false; });
  return box;
}

/** Save a file. @param {string} name @param {BlobPart} content @param {string} type */
export function download(name, content, type) {
  const url = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A text as part of the name of a file. @param {string} text */
export const fileName = (text) => text.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^-+|-+$/g, "").slice(0, 60) || "dalembert";
