// What is typed into a field of a form: a number, a quantity with its unit or a formula, a whole number, or a text.

/** Kind of the values of a field: counts have a least value, and fields that cannot be empty a reason. @typedef {{ whole?: boolean, least?: number, text?: boolean, required?: string }} FieldKind */
/** Value of a field, null of an empty one, or what is wrong with it; `isEmpty` where nothing was entered. @typedef {{ value: string | number | null } | { problem: string, isEmpty?: boolean }} Entered */

/** Quantities such as `45 mm` and formulas such as `pi/4` remain texts, which the program reads.
 * @param {string} text @param {FieldKind} kind @returns {Entered} */
export function entered(text, { whole = false, least = whole ? 1 : -Infinity, text: words = false, required = "" }) {
  const shown = text.trim(), number = Number(shown);
  if (!shown) return required ? { problem: required, isEmpty: true } : { value: null };
  if (words) return { value: shown };
  if (/^[-+]?\d+,\d+$/.test(shown)) return { problem: `Write a decimal point: ${shown.replace(",", ".")}` };
  if (whole && !Number.isInteger(number)) return { problem: `'${shown}' is no whole number` };
  if (number < least) return { problem: `'${shown}' is less than ${least}` };
  return { value: Number.isFinite(number) ? number : shown };
}

/** Event of a field that bubbles to the page; its detail states why the text was refused. */
export const REFUSAL = "refused";

/** Carry out what was typed into a field, or state what is wrong with it. A field that cannot be empty shows its former text again.
 * @param {HTMLInputElement} input @param {FieldKind} kind @param {unknown} former value in the file @param {(value: string | number | null) => void} act */
export function accept(input, kind, former, act) {
  const typed = entered(input.value, kind), problem = "problem" in typed ? typed.problem : "", isRestored = "isEmpty" in typed && former !== undefined && former !== "";
  if (isRestored) input.value = String(former);
  input.setAttribute("aria-invalid", String(Boolean(problem) && !isRestored));
  input.setCustomValidity(isRestored ? "" : problem);
  if ("value" in typed) return act(typed.value);
  if (!isRestored) input.reportValidity();
  input.dispatchEvent(new CustomEvent(REFUSAL, { bubbles: true, detail: problem }));
}
