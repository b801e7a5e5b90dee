// What is typed into a field of a form: a number, a quantity with its unit or a formula, a whole number, or a text.

/** Value of a field, null of an empty one, or what is wrong with it. @typedef {{ value: string | number | null } | { problem: string }} Entered */

/** Quantities such as `45 mm` and formulas such as `pi/4` remain texts, which the program reads.
 * @param {string} text @param {{ whole?: boolean, text?: boolean }} kind @returns {Entered} */
export function entered(text, { whole = false, text: words = false }) {
  const shown = text.trim(), number = Number(shown);
  if (!shown) return { value: null };
  if (words) return { value: shown };
  if (/^[-+]?\d+,\d+$/.test(shown)) return { problem: `Write a decimal point: ${shown.replace(",", ".")}` };
  if (whole) return Number.isInteger(number) ? { value: number } : { problem: `'${shown}' is no whole number` };
  return { value: Number.isFinite(number) ? number : shown };
}
