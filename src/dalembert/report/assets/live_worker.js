// Worker of a live page: runs the newest request and reports its result, then gradients.

/** @import { LiveRun } from "./live_run.js" */
/** @import { LiveData, LiveRequest } from "./types.d.ts" */

import { openJoint } from "./live_failure.js";
import { responseOf } from "./live_responses.js";
import { RunFailure } from "./live_run.js";
import { checkedStatus, failedStatus } from "./live_status.js";

/** @type {LiveRun} */
let run;
/** @type {LiveRequest | null} */
let waiting = null;

/** @param {LiveRequest} request */
function answer({ number, parameters, responses, gradients, point, first = false }) {
  const begin = performance.now();
  try {
    const start = first ? run.first?.(parameters) : null;
    if (start) {
      const [numbers] = run.engine.evaluate("numbers", parameters) ?? [], status = { outcome: "completed", message: "", time: 0, residual: 0, success: true };
      postMessage({ number, first, ...start, values: [], numbers, status, duration: performance.now() - begin, parameters });
      postMessage({ number, slopes: [], jacobian: null });
      return;
    }
    const result = /** @type {any} */ (run.run(parameters)), { times, table, rows } = result, n = times.length;
    const reduced = responses.map((response) => responseOf(response, times, (row) => table.subarray(n * row, n * (row + 1)), result.inside, result.located));
    const [numbers] = run.engine.evaluate("numbers", parameters) ?? [], status = checkedStatus(run, result), [from, to] = result.inside ?? [0, n], copy = new Float64Array(rows * (to - from));  // gradients need the table
    for (let r = 0; r < rows; r++) copy.set(table.subarray(n * r + from, n * r + to), (to - from) * r);
    postMessage({ number, times: times.slice(from, to), table: copy, rows, drawn: result.drawn?.map((/** @type {number} */ k) => k - from), peaks: result.peaks, located: result.located && new Map([...result.located].map(([key, numbers]) => [key, numbers.map((/** @type {number} */ k) => k - from)])), values: reduced.map(({ value }) => value), numbers, status, duration: performance.now() - begin, parameters }, { transfer: [copy.buffer] });
    const slopes = reduced.map(({ weights }, k) => (gradients.includes(k) ? run.gradient(result, weights) : null));
    const at = (/** @type {number} */ k) => new Map([[k, Float64Array.from({ length: n }, (_, i) => Number(i === point?.instant))]]);
    postMessage({ number, slopes, jacobian: point ? point.rows.map((k) => run.gradient(result, at(k))) : null });
  } catch (error) {
    if (!(error instanceof RunFailure)) throw error;
    postMessage({ number, failure: failedStatus(run, error), open: openJoint(run, parameters) });
  }
}

/** Answer the messages of the page. @param {new (module: WebAssembly.Module, data: LiveData) => LiveRun} Run class of the runs */
export function serve(Run) {
  addEventListener("message", ({ data }) => {
    if (data.module) {
      run = new Run(data.module, data.data);
      postMessage({ ready: true });
      return;
    }
    if (!waiting) setTimeout(() => { const request = waiting; waiting = null; if (request) answer(request); });
    waiting = data;  // of several requests only the newest is answered
  });
}
