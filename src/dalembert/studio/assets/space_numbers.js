// Numbers of a model file: plain ones, with a unit, or simple formulas of parameters.

/** @import { Document } from "./types.d.ts" */

const UNITS = /** @type {Record<string, number>} */ ({ m: 1, mm: 1e-3, cm: 1e-2, km: 1e3, rad: 1, deg: Math.PI / 180, "°": Math.PI / 180, kg: 1, g: 1e-3, N: 1, kN: 1e3 });
const MEASURED = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\W\d]\w*|°)\s*$/;
const TOKEN = /\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([A-Za-z_]\w*)|([-+*/()]))\s*/y;

/** Value of a number of the file in SI units; null where it is no number, or a formula beyond sums and products.
 * @param {unknown} entry @param {Document} document @returns {number | null} */
export function numberOf(entry, document, depth = 0) {
  if (typeof entry === "number") return entry;
  if (typeof entry !== "string" || depth > 8) return null;
  const measured = MEASURED.exec(entry);
  if (measured) return measured[2] in UNITS ? Number(measured[1]) * UNITS[measured[2]] : null;
  return formula(entry, (name) => {
    if (name === "pi") return Math.PI;
    const parameter = document.parameters?.[name] ?? document.derived?.[name], value = typeof parameter === "object" ? parameter?.value ?? parameter?.formula : parameter;
    const scale = typeof value === "number" && typeof parameter === "object" && parameter.unit ? UNITS[parameter.unit] : 1, number = numberOf(value, document, depth + 1);
    return number === null || scale === undefined ? null : number * scale;
  });
}

/** Coordinates of the file; null where one of them has no value. @param {unknown} entry @param {Document} document @returns {number[] | null} */
export function vectorOf(entry, document) {
  const values = Array.isArray(entry) && entry.length === 3 ? entry.map((part) => numberOf(part, document)) : [null];
  return values.every((value) => value !== null) ? /** @type {number[]} */ (values) : null;
}

/** @param {string} text @param {(name: string) => number | null} valueOf @returns {number | null} */
function formula(text, valueOf) {
  /** @type {RegExpExecArray[]} */
  const tokens = [];
  for (TOKEN.lastIndex = 0; TOKEN.lastIndex < text.length;) {
    const token = TOKEN.exec(text);
    if (!token) return null;
    tokens.push(token);
  }
  let at = 0;
  const next = (/** @type {string} */ signs) => (tokens[at]?.[3] && signs.includes(tokens[at][3]) ? tokens[at++][3] : null);
  /** @type {() => number} */
  const atom = () => {
    if (next("-")) return -atom();
    if (next("(")) {
      const value = sum();
      return next(")") ? value : NaN;
    }
    const token = tokens[at++];
    return token?.[1] ? Number(token[1]) : token?.[2] ? valueOf(token[2]) ?? NaN : NaN;
  };
  const chain = (/** @type {() => number} */ part, /** @type {string} */ signs) => {
    let value = part();
    for (let sign = next(signs); sign; sign = next(signs)) {
      const other = part();
      value = sign === "+" ? value + other : sign === "-" ? value - other : sign === "*" ? value * other : value / other;
    }
    return value;
  };
  /** @type {() => number} */
  const sum = () => chain(() => chain(atom, "*/"), "+-");
  const value = sum();
  return at === tokens.length && Number.isFinite(value) ? value : null;
}
