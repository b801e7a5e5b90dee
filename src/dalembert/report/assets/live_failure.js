// Joint that stays open where a mechanism cannot be assembled.

/** @import { LiveRun } from "./live_run.js" */
/** @import { OpenJoint } from "./types.d.ts" */

/** Number of bisections of the way from the nominal design, and the threshold of an open joint, relative to its natural size. */
const BISECTIONS = 30, OPEN = 1e-9;

/** The joint with the largest violation at the last position that can be assembled on the way to a design; null if all are closed.
 * @param {LiveRun} run @param {ArrayLike<number>} parameters @returns {OpenJoint | null} */
export function openJoint(run, parameters) {
  const { anchor, data, engine, base } = run, p = Float64Array.from(parameters), alone = engine.functions.has("assembling"), [closing, gaps] = alone ? ["assembling", "gaps"] : ["closing", "violation"];
  if (!data.joints?.length || !engine.functions.has(gaps)) return null;
  engine.top = base;
  /** @type {[Float64Array, number]} */
  let [y, reached] = [anchor.y.subarray(0, engine.named(gaps).inputs[1]), 0];
  for (let k = 0, step = 1; k < BISECTIONS; k++, step /= 2) {
    const between = anchor.p.map((value, i) => value + (reached + step) * (p[i] - value)), solution = run.closed(y, between, closing);
    if (solution.accepted) { y = solution.y; reached += step; }
    if (reached >= 1) return null;
  }
  const rows = engine.evaluate(gaps, [data.start], y, p)?.[0] ?? [];
  let worst = 0;
  for (let k = 1; k < rows.length; k++) if (Math.abs(rows[k]) > Math.abs(rows[worst])) worst = k;
  const joint = data.joints[worst];
  return joint && Math.abs(rows[worst]) > OPEN ? { ...joint, gap: Math.abs(rows[worst]) * joint.size } : null;
}
