// Worker of a live page: requests, results, cancellation of runs that take long.

/** @import { LiveAnswer, LiveData, LiveFailure, LiveRequest, LiveResult, LiveSlopes } from "./types.d.ts" */

import { bytesOf, inflated } from "./inflate.js";
import { Signal } from "./theme.js";

/** Time after which a run is given up for a newer design [ms], and longest usual duration of runs that may take half as long again. */
const PATIENCE = 250, USUAL = 1000;

/** @typedef {{ request: LiveRequest, quiet: boolean, since: number, resolve: (answer: LiveAnswer | null) => void }} Task */

export class Solver {
  /** @param {LiveData} data */
  constructor(data) {
    this.data = data;
    /** @type {Signal<LiveResult>} */
    this.onResult = new Signal();
    /** Gradients of the last result, by the parameters. @type {Signal<LiveSlopes>} */
    this.onSlopes = new Signal();
    /** @type {Signal<LiveFailure>} */
    this.onFailure = new Signal();
    /** Time for which the present run takes [ms], null when none takes long. @type {Signal<number | null>} */
    this.onBusy = new Signal();
    /** Duration of the last run [ms]. */
    this.duration = 0;
    this.number = 0;
    /** @type {Task | null} */
    this.running = null;
    /** @type {Task | null} */
    this.waiting = null;
    /** Result whose gradients are still computed. @type {LiveResult | null} */
    this.result = null;
    /** @type {Worker | null} */
    this.worker = null;
    /** Address of the script of the worker. */
    this.script = "";
    /** Resolved when the worker is ready; rejected where the browser does not permit it. */
    this.ready = this.compile();
  }

  async compile() {
    if (typeof WebAssembly === "undefined" || typeof Worker === "undefined") throw new Error("it has no WebAssembly or no workers");
    const script = await inflated(bytesOf(document.getElementById("worker")?.textContent ?? ""));
    this.script = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    this.module = await WebAssembly.compile(await inflated(bytesOf(this.data.code)));
    await this.start();
  }

  /** Start a worker. @returns {Promise<void>} */
  start() {
    const { code: _, exact: __, ...data } = this.data, worker = new Worker(this.script);
    this.worker = worker;
    return new Promise((resolve, reject) => {
      worker.onmessage = ({ data: answer }) => { if ("ready" in answer) resolve(); else if (worker === this.worker) this.receive(answer); };
      worker.onerror = (event) => {
        event.preventDefault();
        reject(new Error(event.message || "its worker cannot start"));
        if (worker === this.worker && this.running) this.receive({ number: this.running.request.number, failure: { outcome: "failed", message: event.message || "the worker of the page failed", time: NaN, residual: NaN, success: false } });
      };
      worker.postMessage({ module: this.module, data });
    });
  }

  /** Compute a design; of several waiting ones only the newest. Resolved with null if a newer one replaces it.
   * @param {Omit<LiveRequest, "number">} request @param {boolean} quiet whether only the promise reports the answer @returns {Promise<LiveAnswer | null>} */
  request(request, quiet = false) {
    this.waiting?.resolve(null);
    return new Promise((resolve) => {
      this.waiting = { request: { ...request, number: ++this.number }, quiet, since: 0, resolve };
      const patience = this.duration < USUAL ? Math.max(PATIENCE, 1.5 * this.duration) : PATIENCE;
      if (this.running && performance.now() - this.running.since > patience) this.cancel();
      this.send();
    });
  }

  /** Give up the present run. */
  cancel() {
    if (!this.running) return;
    this.worker?.terminate();
    this.running.resolve(null);
    this.running = this.result = null;
    this.start().catch(() => {});
    this.onBusy.emit(null);
  }

  send() {
    if (this.running || !this.waiting || !this.worker) return;
    const task = this.waiting;
    [this.running, this.waiting] = [task, null];
    task.since = performance.now();
    this.worker.postMessage(task.request);
    const report = () => {
      if (this.running !== task) return;
      this.onBusy.emit(performance.now() - task.since);
      setTimeout(report, PATIENCE);
    };
    setTimeout(report, PATIENCE);
  }

  /** @param {LiveResult | LiveSlopes | LiveFailure} answer */
  receive(answer) {
    if ("table" in answer) {
      this.result = answer;
      if (!answer.first) this.duration = answer.duration;
      if (!this.running?.quiet) this.onResult.emit(answer);
      return;
    }
    const { running, result } = this;
    this.running = this.result = null;
    this.onBusy.emit(null);
    if ("failure" in answer) {
      if (!running?.quiet) this.onFailure.emit(answer);
      running?.resolve({ failure: answer });
    } else {
      if (!running?.quiet) this.onSlopes.emit(answer);
      running?.resolve(result && { result, slopes: answer.slopes });
    }
    this.send();
  }
}
