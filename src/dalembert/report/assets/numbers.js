// Numbers: tests, columns, ticks and texts.

/** @import { Column, Range } from "./types.d.ts" */

export const TAU = 2 * Math.PI;

/** @type {(x: number, lo: number, hi: number) => number} */
export const clamp = (x, lo, hi) => Math.min(hi, Math.max(lo, x));

/** The value if it is an array, else an empty one.
 * @template T @param {ArrayLike<T> | null | undefined} x @returns {T[]} */
export const list = (x) => /** @type {T[]} */ (Array.isArray(x) || ArrayBuffer.isView(x) ? x : []);

/** @param {unknown} x @returns {x is number} */
export const isNum = (x) => typeof x === "number" && Number.isFinite(x);

/** The first two numbers of a point, or the origin.
 * @param {unknown} p @returns {Range} */
export const xy = (p) => (Array.isArray(p) && isNum(p[0]) && isNum(p[1]) ? [p[0], p[1]] : [0, 0]);

/** A column of n numbers; missing ones are NaN.
 * @param {Column | undefined} values @param {number} n */
export function floats(values, n) {
  if (values instanceof Float64Array && values.length === n) return values;
  const column = new Float64Array(n).fill(NaN);
  list(values).slice(0, n).forEach((value, i) => { if (typeof value === "number") column[i] = value; });
  return column;
}

/** A column of n numbers; a single number is repeated.
 * @param {Column | number | undefined} value @param {number} n */
export const steady = (value, n) => floats(typeof value === "object" ? value : Array(n).fill(isNum(value) ? value : 0), n);

/** The smallest and the largest number of some columns; null without numbers.
 * @param {ArrayLike<number | null>[]} columns @returns {Range | null} */
export function extent(columns) {
  let lo = Infinity, hi = -Infinity;
  for (const column of columns) {
    for (let i = 0; i < column.length; i++) {
      const v = column[i] ?? NaN;
      if (v < lo) lo = v;
      if (v > hi) hi = v;
    }
  }
  return lo <= hi ? [lo, hi] : null;
}

/** 1, 2 or 5 times a power of ten, at least x. @param {number} x */
export function niceAbove(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  for (const m of [1, 2, 5]) if (m * power >= x * (1 - 1e-9)) return m * power;
  return 10 * power;
}

/** About `count` round numbers of an interval. @param {number} lo @param {number} hi @param {number} count */
export function ticks(lo, hi, count) {
  const step = niceAbove((hi - lo) / Math.max(1, count)), values = [];
  for (let k = Math.ceil(lo / step - 1e-9); k <= Math.floor(hi / step + 1e-9); k++) values.push(k * step);
  return { step, values };
}

/** Ticks of an axis with their texts, in units of a power of ten for large and small numbers.
 * @param {number} lo @param {number} hi @param {number} count */
export function axisTicks(lo, hi, count) {
  const { step, values } = ticks(lo, hi, count), size = Math.max(Math.abs(lo), Math.abs(hi));
  const power = size >= 1e5 || size < 1e-3 ? 3 * Math.floor(Math.log10(size) / 3) : 0;
  const decimals = decimalsOf(step / 10 ** power);
  return { values, texts: values.map((v) => fixed(v / 10 ** power, decimals)), power: power ? `10${superscript(power)}` : "" };
}

/** Text with true minus signs. @param {string} text */
export const minus = (text) => text.replaceAll("-", "\u2212");

/** @param {number} k */
export const superscript = (k) => String(k).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[+c] ?? "⁻");

/** A number with a count of significant digits. @param {unknown} x */
export function number(x, digits = 4) {
  if (!isNum(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) {
    const [m, e] = x.toExponential(digits - 1).split("e");
    return `${minus(m)}·10${superscript(+e)}`;
  }
  const whole = size >= 1 ? Math.floor(Math.log10(size)) + 1 : 0;
  return minus(x.toFixed(clamp(digits - whole, 0, 7)));
}

/** A number without trailing zeros. @param {unknown} x */
export function tidy(x, digits = 6) {
  if (!isNum(x)) return "–";
  const short = +x.toPrecision(digits), size = Math.abs(short);
  return minus(size && (size < 1e-3 || size >= 1e6) ? short.toExponential() : String(short));
}

/** Decimals of the multiples of a step. @param {number} step */
export const decimalsOf = (step) => clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 12);

/** @param {number} x @param {number} decimals */
export function fixed(x, decimals) {
  const text = x.toFixed(decimals);
  return minus(Number(text) === 0 ? text.replace("-", "") : text);
}

/** An instant, with decimals that suit the time span. @param {number} t @param {number} span */
export const clock = (t, span) => fixed(t, span > 0 ? clamp(Math.ceil(3 - Math.log10(span)), 0, 9) : 3);
