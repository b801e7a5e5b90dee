// Numbers that are written into the file, without the noise of their computation.

/** Significant digits of numbers that are drawn. */
const DIGITS = 9;

/** Number without noise in its last digits. @param {number} value */
export const neat = (value) => (Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(DIGITS)));

/** Coordinates without digits beyond those of the largest number from which they are computed, so that differences become zero.
 * @param {number[]} spot @param {number[]} from numbers from which they are computed */
export function neatSpot(spot, from = []) {
  const size = Math.max(...[...spot, ...from].map(Math.abs));
  if (!(size > 0 && size < Infinity)) return spot;
  const digits = DIGITS - 1 - Math.floor(Math.log10(size));
  return digits >= 0 && digits <= 100 ? spot.map((value) => Number(value.toFixed(digits)) || 0) : spot.map(neat);
}
