// Small motions of a mechanism about a state: matrices from the module, reduced to the directions of its constraints.

/** @import { Matrix } from "./live_matrix.js" */
/** @import { LiveRun } from "./live_run.js" */

import { matrixOf, product, spaces, transposed } from "./live_matrix.js";
import { RunFailure } from "./live_run.js";

/** Results of a function for all unit vectors of the state, as matrices in natural sizes.
 * @param {LiveRun} run @param {string} name @param {Float64Array} x @param {Float64Array} p @param {ArrayLike<number>[]} sizes of the rows of each result @returns {Matrix[] | null} null where they are not determined */
export function columnsOf({ engine, data }, name, x, p, sizes) {
  const { states } = /** @type {{ states: number[] }} */ (data.sizes), n = x.length, mark = engine.top, unit = new Float64Array(n * n);
  for (let k = 0; k < n; k++) unit[(n + 1) * k] = states[k];
  const from = [[data.start], x, p, unit].map((values) => engine.put(values)), { done, to } = engine.call(name, n, from, new Set([0, 1, 2]));
  const matrices = to.map((at, k) => matrixOf(engine.view(at, sizes[k].length * n), sizes[k].length));
  engine.top = mark;
  matrices.forEach((matrix, k) => matrix.forEach((row, i) => row.forEach((value, j) => { row[j] = value / sizes[k][i]; })));
  return done === n && matrices.every((matrix) => matrix.every((row) => row.every(Number.isFinite))) ? matrices : null;
}

/** State of a mechanism near a position, its matrices `J` and `G`, and `A = Bᵀ J B` on the basis `B` of the directions that the constraints permit.
 * @param {LiveRun} run @param {Float64Array} near @param {Float64Array} p */
export function smallMotions(run, near, p) {
  const { states, rows } = /** @type {{ states: number[], rows: number[] }} */ (run.data.sizes), [x] = run.engine.evaluate("state", [run.data.start], near, p) ?? [];
  if (!x) throw new RunFailure("the initial speeds are not determined", undefined, undefined, "singular position");
  const matrices = columnsOf(run, "tangent", x, p, [states, rows]);
  if (!matrices) throw new RunFailure("the mechanism cannot be linearised", undefined, undefined, "singular position");
  const [j, g] = matrices, { free: basis, bound } = spaces(g, x.length), a = product(transposed(basis, basis[0]?.length ?? 0), product(j, basis));
  return { x, j, g, basis, bound, a };
}
