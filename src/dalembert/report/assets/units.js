// Units of numbers in texts.

import { TAU, number, superscript, tidy } from "./numbers.js";

/** SI unit → factor and name of the preferred unit. @type {Map<string, [number, string]>} */
const preferred = new Map();

/** @param {Record<string, [number, string]> | undefined} units */
export const preferUnits = (units) => Object.entries(units ?? {}).forEach(([si, unit]) => preferred.set(si, unit));

/** Unit of an item; `"1"` without one. @param {{ unit?: string | null }} item */
export const unitOf = (item) => String(item.unit || "1");

/** m² for m^2. @param {unknown} unit */
export const raised = (unit) => String(unit).replace(/\^(-?\d+)/g, (_, power) => superscript(+power));

/** @param {string} text @param {string | undefined} unit */
export const withUnit = (text, unit) => (unit && unit !== "1" ? `${text} ${raised(unit)}` : text);

/** `name [unit]`. @param {string} name @param {string | undefined} unit */
export const labelled = (name, unit) => (unit && unit !== "1" ? `${name} [${raised(unit)}]` : name);

/** A length with a suitable prefix. @param {number} x */
export function metres(x) {
  const chosen = preferred.get("m");
  if (chosen) return withUnit(tidy(x / chosen[0], 4), chosen[1]);
  /** @type {[number, string]} */
  const [factor, unit] = x >= 1000 ? [1e-3, "km"] : x >= 0.9999 ? [1, "m"] : x >= 0.9999e-3 ? [1e3, "mm"] : [1e6, "µm"];
  return `${+(x * factor).toPrecision(4)} ${unit}`;
}

/** Numbers in their preferred unit; round-off relative to the largest, or to a scale, is zero.
 * @param {number[]} values @param {string} si */
export function inUnits(values, si, { scale = 0, digits = 4 } = {}) {
  const [factor, name] = preferred.get(si) ?? [1, si.replace(" ", "·")], size = Math.max(scale, ...values.map(Math.abs));
  return withUnit(values.map((x) => number(Math.abs(x) < 1e-12 * size ? 0 : x / factor, digits)).join(", "), name);
}

/** @param {number} angle */
export const degrees = (angle) => `${number((angle * 360) / TAU, 4)}°`;
