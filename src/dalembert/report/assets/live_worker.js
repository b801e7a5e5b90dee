// Worker of a live page: runs the newest request and reports its result, with gradients.

/** @import { LiveData, LiveRequest } from "./types.d.ts" */

import { samplesWeights, valueOf } from "./live_responses.js";
import { LiveRun, RunFailure } from "./live_run.js";

/** @type {LiveRun} */
let run;
/** @type {LiveRequest | null} */
let waiting = null;

/** @param {LiveRequest} request */
function answer({ number, parameters, responses, gradient }) {
  const begin = performance.now();
  try {
    const result = run.run(parameters), { times, table, rows } = result, n = times.length;
    const row = (/** @type {number} */ k) => table.subarray(n * k, n * (k + 1));
    const values = responses.map((response) => valueOf(response, times, row(response.row)));
    const chosen = gradient === null ? null : responses[gradient];
    const slopes = chosen && run.gradient(result, new Map([[chosen.row, samplesWeights(chosen, times, row(chosen.row))]]));
    postMessage({ number, times, table, rows, values, slopes, duration: performance.now() - begin }, { transfer: [table.buffer] });
  } catch (error) {
    if (!(error instanceof RunFailure)) throw error;
    postMessage({ number, failure: error.message, residual: error.residual, loop: error.loop });
  }
}

addEventListener("message", ({ data }) => {
  if (data.module) { run = new LiveRun(data.module, /** @type {LiveData} */ (data.data)); return; }
  if (!waiting) setTimeout(() => { const request = waiting; waiting = null; if (request) answer(request); });
  waiting = data;  // of several requests only the newest is answered
});
