// Numbers that are typed while drawing: a length, a length and an angle, or coordinates.

/** Units of lengths [m] and angles [rad]. */
const LENGTHS = /** @type {Record<string, number>} */ ({ "": 1, m: 1, mm: 1e-3, cm: 1e-2, km: 1e3, in: 0.0254, ft: 0.3048 });
const ANGLES = /** @type {Record<string, number>} */ ({ "": Math.PI / 180, deg: Math.PI / 180, "°": Math.PI / 180, rad: 1 });

/** Characters that begin or continue what is typed. */
export const TYPED = /^[\d.,<\-+ a-z°]$/i;
export const BEGINS = /^[\d.<\-+]$/;

/** Number with a unit; null if it is none. @param {string} text @param {Record<string, number>} units */
function quantity(text, units) {
  const match = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([a-z°]*)\s*$/i.exec(text), factor = match ? units[match[2]] : undefined;
  return match && factor !== undefined ? Number((Number(match[1]) * factor).toPrecision(15)) : null;
}

/** Place that is typed: `0.3` is a length in the direction of the pointer, `0.3<45` a length and an angle, `0.1,0.2` coordinates.
 * @param {string} text @param {{ x: number, y: number } | null} from the place before @param {{ x: number, y: number } | null} toward place of the pointer @returns {{ x: number, y: number } | null} */
export function typedPlace(text, from, toward) {
  const pair = text.split(",");
  if (pair.length === 2) {
    const [x, y] = pair.map((part) => quantity(part, LENGTHS));
    return x === null || y === null ? null : { x, y };
  }
  if (!from) return null;
  const polar = text.split("<"), length = quantity(polar[0], LENGTHS);
  const angle = polar.length === 2 ? quantity(polar[1], ANGLES) : toward && Math.atan2(toward.y - from.y, toward.x - from.x);
  if (length === null || angle === null || polar.length > 2) return null;
  return { x: from.x + length * Math.cos(angle), y: from.y + length * Math.sin(angle) };
}
