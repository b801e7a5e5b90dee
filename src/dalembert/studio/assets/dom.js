// Elements of the page.

/** @import { Attributes, Child } from "./types.d.ts" */

/** Element of the page that exists. @param {string} id @returns {HTMLElement} */
export const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** New element: attributes, listeners (`onclick`) and children.
 * @template {keyof HTMLElementTagNameMap} K @param {K} name @param {Attributes} attributes @param {...(Child | Child[])} children @returns {HTMLElementTagNameMap[K]} */
export function el(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(key.slice(2), value);
    else if (value === true) node.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) node.setAttribute(key, String(value));
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** Button with a text. @param {string} text @param {() => void} act @param {Attributes} attributes */
export const button = (text, act, attributes = {}) => el("button", { type: "button", class: "button", onclick: act, ...attributes }, text);
