// Limits of quantities at values of the parameters: the checks of Python with the same messages.

/** @import { LiveLimit } from "./types.d.ts" */

const USABLE = 1e100;

/** Number with significant digits, as Python writes it by `g`. @param {number} x @param {number} digits */
export function general(x, digits) {
  if (!Number.isFinite(x)) return x !== x ? "nan" : x > 0 ? "inf" : "-inf";
  if (x === 0) return "0";
  const [mantissa, exponent] = x.toExponential(digits - 1).split("e"), power = Number(exponent);
  const shortened = (/** @type {string} */ text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (power >= -4 && power < digits) return shortened(x.toFixed(digits - 1 - power));
  return `${shortened(mantissa)}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}

/** Reason why a number is invalid, or "". @param {number} number @param {LiveLimit} limit */
function wrong(number, { unit, minimum, above }) {
  const size = Math.abs(number), text = general(number, 6), shown = unit ? `${text} ${unit}` : text;
  if (!Number.isFinite(number)) return `its value is ${text}; give a finite number`;
  if (number && !(size >= 1 / USABLE && size <= USABLE)) return `${text} is out of range: products or quotients would overflow; numbers are 0 or 1e-100 to 1e+100 in size: check its unit`;
  if (typeof minimum === "number" && number < minimum) return `is ${shown}, but it must not be ${minimum === 0 ? "negative" : `below ${general(minimum, 6)}`}`;
  if (typeof above === "number" && number <= above) return `is ${shown}, but it must be above ${general(above, 6)}`;
  return "";
}

/** Message about the first quantity outside its limits or violated condition, or "". @param {LiveLimit[]} limits @param {ArrayLike<number>} numbers of all limits, one after the other */
export function invalid(limits, numbers) {
  let at = 0;
  for (const limit of limits) {
    const values = Array.from({ length: limit.size }, (_, k) => numbers[at + k]), { message, count = 0 } = limit;
    at += limit.size;
    if (message && values.slice(0, count).some((value) => !(value >= 0))) {
      let next = count;
      return `${limit.entity}: ${message.replace(/\{(\d*)(?::(?:\.(\d+))?g)?\}/g, (_, place, digits) => general(values[place ? count + Number(place) : next++], Number(digits ?? 6)))}`;
    }
    const text = message ? "" : values.map((value) => wrong(value, limit)).find(Boolean);
    if (text) return `${limit.entity}: ${text}`;
  }
  return "";
}
