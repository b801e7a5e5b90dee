// Worker of a live page: runs the newest request and reports its result, then a gradient.

/** @import { LiveData, LiveRequest } from "./types.d.ts" */

import { samplesWeights, valueOf } from "./live_responses.js";
import { LiveKinematics } from "./live_kinematics.js";
import { LiveRun, RunFailure } from "./live_run.js";
import { checkedStatus, failedStatus } from "./live_status.js";

/** Kind of an analysis → class of its runs. */
const RUNS = { dynamics: LiveRun, kinematics: LiveKinematics };

/** @type {LiveRun} */
let run;
/** @type {LiveRequest | null} */
let waiting = null;

/** @param {LiveRequest} request */
function answer({ number, parameters, responses, gradient, point }) {
  const begin = performance.now();
  try {
    const result = run.run(parameters), { times, table, rows } = result, n = times.length;
    const row = (/** @type {number} */ k) => table.subarray(n * k, n * (k + 1));
    const values = responses.map((response) => valueOf(response, times, row(response.row)));
    const weights = gradient === null ? null : new Map([[responses[gradient].row, samplesWeights(responses[gradient], times, row(responses[gradient].row))]]);
    const [numbers] = run.engine.evaluate("numbers", parameters) ?? [];
    const status = checkedStatus(run, result);
    postMessage({ number, times, table, rows, values, numbers, status, duration: performance.now() - begin }, { transfer: [table.buffer] });
    const at = (/** @type {number} */ k) => new Map([[k, Float64Array.from({ length: n }, (_, i) => Number(i === point?.instant))]]);
    const jacobian = point ? point.rows.map((k) => run.gradient(result, at(k))) : null;
    postMessage({ number, slopes: weights && run.gradient(result, weights), jacobian });
  } catch (error) {
    if (!(error instanceof RunFailure)) throw error;
    postMessage({ number, failure: failedStatus(run, error), loop: error.loop });
  }
}

addEventListener("message", ({ data }) => {
  if (data.module) { run = new RUNS[/** @type {LiveData} */ (data.data).kind](data.module, data.data); return; }
  if (!waiting) setTimeout(() => { const request = waiting; waiting = null; if (request) answer(request); });
  waiting = data;  // of several requests only the newest is answered
});
