// Preview of a drag: the page computes the change before it is written into the text.

/** @import { Page } from "./pictures.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

/** The page with its parts and poses of the shown instant, which previews do not change: they replace the parts of the shown motion. @param {Page} page @returns {Page} */
export function stillPage(page) {
  return { ...page, motion: Object.assign(Object.create(Object.getPrototypeOf(page.motion)), page.motion) };
}

/** Values of the parameters of a live page after the operations of a change; null where the page cannot compute it.
 * @param {Page} page @param {Document} document @param {number[]} before @param {Operation[]} operations */
export function valuesAfter({ design }, document, before, operations) {
  if (!design) return null;
  const values = [...before], { parameters } = design;
  const set = (/** @type {(string | number)[]} */ keys, /** @type {unknown} */ value) => {
    const old = keys.reduce((/** @type {any} */ entry, key) => entry?.[key], document), place = JSON.stringify(keys);
    const k = parameters.findIndex((/** @type {any} */ { name, drawn }) => (drawn ? JSON.stringify(drawn) === place : name === old));
    if (k >= 0 && typeof value === "number") values[k] = value;
    return k >= 0;
  };
  const known = operations.every(({ op, keys, value }) => op === "set" && Array.isArray(keys) && (Array.isArray(value) ? value.every((part, i) => set([...keys, i], part)) : set(keys, value)));
  return known ? values : null;
}
