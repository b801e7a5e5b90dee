// Numbers that are written into the file, without the noise of their computation.

/** Significant digits that a short number has, those that are free of noise, and those of other numbers, so many that redundant joints of a drawing still close. */
const SHORT = 6, CERTAIN = 9, ALL = 12;

/** A number that is short but for noise is rounded to its certain digits. @param {number} value @param {(value: number, digits: number) => string} round */
function rounded(value, round) {
  const certain = Number(round(value, CERTAIN));
  return (certain === Number(round(value, SHORT)) ? certain : Number(round(value, ALL))) || 0;
}

/** Number without noise in its last digits. @param {number} value */
export const neat = (value) => (Math.abs(value) < 1e-12 ? 0 : rounded(value, (x, digits) => x.toPrecision(digits)));

/** Coordinates without digits beyond those of the largest number from which they are computed, so that differences become zero.
 * @param {number[]} spot @param {number[]} from numbers from which they are computed */
export function neatSpot(spot, from = []) {
  const size = Math.max(...[...spot, ...from].map(Math.abs));
  if (!(size > 0 && size < Infinity)) return spot;
  const whole = 1 + Math.floor(Math.log10(size));
  if (SHORT < whole || ALL - whole > 100) return spot.map(neat);
  return spot.map((value) => rounded(value, (x, digits) => x.toFixed(digits - whole)));
}
