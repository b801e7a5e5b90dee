// Convex hull of points in a plane.

/** @typedef {[number, number]} Pair */

/** Twice the area of a triangle. @param {Pair} o @param {Pair} a @param {Pair} b */
export const cross = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);

/** @param {Pair[]} points */
export function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (/** @type {Pair[]} */ order) => {
    /** @type {Pair[]} */
    const chain = [];
    for (const p of order) {
      while (chain.length > 1 && cross(chain[chain.length - 2], chain[chain.length - 1], p) <= 0) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
