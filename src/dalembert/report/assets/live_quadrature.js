// Integrals over unevenly spaced samples.

/** Simpson's rule for the integral from each sample to the next, by a parabola through three neighbours, as SciPy's `cumulative_simpson`.
 * @param {Float64Array} t times of the samples @returns {[number, number][][]} numbers and weights of the samples of each interval */
export function simpson(t) {
  const n = t.length, h = t.slice(1).map((end, k) => end - t[k]);
  /** Weights on the samples `i`, `j`, `k` of the integral from `i` to `j`. @param {number} i @param {number} j @param {number} k @param {number} a @param {number} b @returns {[number, number][]} */
  const parabola = (i, j, k, a, b) => {
    const over = a / (a + b), curved = (over * a) / b;
    return [[i, (a / 6) * (3 - over)], [j, (a / 6) * (3 + curved + over)], [k, (-a / 6) * curved]];
  };
  if (n === 2) return [[[0, h[0] / 2], [1, h[0] / 2]]];
  return Array.from(h, (_, k) => (k % 2 || k === n - 2 ? parabola(k + 1, k, k - 1, h[k], h[k - 1]) : parabola(k, k + 1, k + 2, h[k], h[k + 1])));
}
