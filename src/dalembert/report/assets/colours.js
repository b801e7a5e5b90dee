// Colours of the values of a field.

/** @import { Range } from "./types.d.ts" */

import { clamp, isNum } from "./numbers.js";
import { mix } from "./theme.js";

/** After viridis for one sign; blue over white to red for both. */
const RAMPS = {
  one: ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6dcd59", "#b4de2c", "#fde725"],
  both: ["#0a3a70", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b", "#76001f"],
};
const SHADES = 256;

export class Ramp {
  /** @param {Range} range */
  constructor([lo, hi]) {
    this.lo = lo;
    this.hi = hi;
    const stops = lo < 0 && hi > 0 ? RAMPS.both : RAMPS.one;
    this.steps = Array.from({ length: SHADES }, (_, k) => {
      const x = (k / (SHADES - 1)) * (stops.length - 1), i = Math.min(Math.floor(x), stops.length - 2);
      return mix(stops[i], stops[i + 1], x - i);
    });
  }

  /** Colour of a value; null without one. @param {number | undefined} value */
  colour(value) {
    return isNum(value) ? this.steps[clamp(Math.round(((SHADES - 1) * (value - this.lo)) / (this.hi - this.lo)), 0, SHADES - 1)] : null;
  }
}
