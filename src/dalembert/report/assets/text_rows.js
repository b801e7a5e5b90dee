// Texts side by side in rows, without overlap.

import { clamp } from "./numbers.js";
import { Theme } from "./theme.js";

/** Upper limit of the number of rows. */
const MOST_ROWS = 4;
/** Lower limit of the space between two texts of a row [px]. */
const BETWEEN = 8;
/** Limits of the number of letters, tried in this order. */
const LIMITS = [60, 24, 18, 14, 10, 7, 5, 3];

const pen = document.createElement("canvas").getContext("2d");

/** Width of a text [px]. @param {string} text @param {string} font */
export function widthOf(text, font) {
  if (!pen) return 7 * text.length;
  pen.font = `${font} ${Theme.font}`;
  return pen.measureText(text).width;
}

/** @typedef {{ text: string, x: number, row: number }} Placed */

/** Texts centred at positions, clear of each other and of the edges: in as few rows as possible, shortened where rows are not enough.
 * @param {number[]} at positions [px] @param {(k: number, limit: number) => string} textOf text with a limited number of letters
 * @param {number} width of the drawing @param {string} font @returns {{ texts: Placed[], rows: number }} */
export function inRows(at, textOf, width, font) {
  /** @type {Placed[]} */
  let texts = [];
  for (const limit of LIMITS) for (let rows = 1; rows <= Math.min(MOST_ROWS, Math.max(1, at.length)); rows++) {
    const sizes = at.map((_, k) => widthOf(textOf(k, limit), font));
    const lefts = at.map((x, k) => clamp(x - sizes[k] / 2, 2, Math.max(2, width - 2 - sizes[k])));
    texts = at.map((_, k) => ({ text: textOf(k, limit), x: lefts[k] + sizes[k] / 2, row: k % rows }));
    if (at.every((_, k) => k < rows || lefts[k] >= lefts[k - rows] + sizes[k - rows] + BETWEEN)) return { texts, rows };
  }
  return { texts, rows: MOST_ROWS };
}
