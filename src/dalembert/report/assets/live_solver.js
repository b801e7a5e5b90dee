// Worker of a live page: requests, results, cancellation of runs that take long.

/** @import { LiveData, LiveFailure, LiveRequest, LiveResult, LiveSlopes } from "./types.d.ts" */

import { bytesOf, inflated } from "./payload.js";
import { Signal } from "./theme.js";

/** Time after which a run is given up for a newer design [ms]. */
const PATIENCE = 250;

export class Solver {
  /** @param {LiveData} data */
  constructor(data) {
    this.data = data;
    /** @type {Signal<LiveResult>} */
    this.onResult = new Signal();
    /** Gradient of the last result, by the parameters. @type {Signal<LiveSlopes>} */
    this.onSlopes = new Signal();
    /** @type {Signal<LiveFailure>} */
    this.onFailure = new Signal();
    /** @type {Signal<boolean>} */
    this.onBusy = new Signal();
    this.number = 0;
    /** Request that the worker computes, and since when. @type {{ request: LiveRequest, since: number } | null} */
    this.running = null;
    /** @type {LiveRequest | null} */
    this.waiting = null;
    /** @type {Worker | null} */
    this.worker = null;
    this.script = URL.createObjectURL(new Blob([document.getElementById("worker")?.textContent ?? ""], { type: "text/javascript" }));
    this.ready = this.compile();
  }

  async compile() {
    this.module = await WebAssembly.compile(await inflated(bytesOf(this.data.code)));
    this.start();
  }

  start() {
    const { code: _, exact: __, ...data } = this.data;
    this.worker = new Worker(this.script);
    this.worker.postMessage({ module: this.module, data });
    this.worker.onmessage = ({ data: answer }) => this.receive(answer);
    this.worker.onerror = (event) => this.receive({ number: this.number, failure: { outcome: "failed", message: event.message || "the worker of the page failed", time: NaN, residual: NaN, success: false } });
  }

  /** Compute a design; of several waiting ones only the newest. @param {Omit<LiveRequest, "number">} request */
  request(request) {
    this.waiting = { ...request, number: ++this.number };
    if (this.running && performance.now() - this.running.since > PATIENCE) {
      this.worker?.terminate();
      this.running = null;
      this.start();
    }
    this.send();
  }

  send() {
    if (this.running || !this.waiting || !this.worker) return;
    this.running = { request: this.waiting, since: performance.now() };
    this.worker.postMessage(this.waiting);
    this.waiting = null;
    setTimeout(() => this.onBusy.emit(this.running !== null), PATIENCE);
  }

  /** @param {LiveResult | LiveSlopes | LiveFailure} answer */
  receive(answer) {
    if ("table" in answer) { this.onResult.emit(answer); return; }
    this.running = null;
    this.onBusy.emit(false);
    if ("failure" in answer) this.onFailure.emit(answer); else this.onSlopes.emit(answer);
    this.send();
  }
}
