// Units of numbers in texts.

import { TAU, clamp, isNum, number, superscript, tidy } from "./numbers.js";

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

/** Prefixes of powers of ten. @type {Record<number, string>} */
const PREFIXES = { "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" };

/** Factor and name of the unit for numbers of a size: the preferred one, else with a prefix such as kN or mm.
 * @param {number} size @param {string} unit */
export function prefixed(size, unit) {
  const chosen = preferred.get(unit);
  if (chosen) return { factor: chosen[0], unit: chosen[1], size };
  if (unit === "strain") return { factor: 1e-6, unit: "µm/m", size };
  const power = ["N", "Pa", "J", "m", "N m"].includes(unit) && size > 0 ? clamp(3 * Math.floor(Math.log10(size * (1 + 1e-9)) / 3), -9, 9) : 0;
  return { factor: 10 ** power, unit: PREFIXES[power] + unit, size };
}

/** A number with its unit: 12.3 kN. @param {number | null | undefined} value @param {string} unit */
export function quantity(value, unit, digits = 4) {
  if (!isNum(value)) return "–";
  if (value === 0) return withUnit("0", preferred.get(unit)?.[1] ?? unit);
  const { factor, unit: shown } = prefixed(Math.abs(value), unit);
  return withUnit(number(value / factor, digits), shown);
}
