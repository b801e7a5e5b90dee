// Functions of an exported module: simulation, responses and gradients for parameter values by name.

/** @import { LiveRun } from "./live_run.js" */
/** @import { LiveData, LiveResponse, ModuleData } from "./types.d.ts" */

/** @typedef {new (module: WebAssembly.Module, data: LiveData) => LiveRun} Run */

import { bytesOf, inflated } from "./inflate.js";
import { responseOf } from "./live_responses.js";
import { RunFailure } from "./live_run.js";
import { checkedStatus, failedStatus } from "./live_status.js";

/** An analysis of a model. */
class Analysis {
  /** @param {Run} Run @param {WebAssembly.Module} module @param {ModuleData} data */
  constructor(Run, module, data) {
    this.data = data;
    this.live = new Run(module, data.live);
    this.names = data.parameters.map(({ name }) => name);
  }

  /** Values of all parameters. @param {Record<string, number>} values some of them by name */
  vector(values) {
    for (const [name, value] of Object.entries(values)) {
      if (!this.names.includes(name)) throw new RangeError(`unknown parameter ${name}; there are ${this.names.join(", ")}`);
      if (!Number.isFinite(value)) throw new RangeError(`parameter ${name} is ${value}; give a finite number`);
    }
    return this.data.parameters.map(({ name, value }) => values[name] ?? value);
  }

  /** @param {string} label @returns {LiveResponse} */
  response(label) {
    const response = this.data.responses.find((one) => one.label === label);
    if (response) return response;
    throw new RangeError(`unknown response ${label}; there are ${this.data.responses.map((one) => one.label).join(", ") || "none"}`);
  }

  /** Run of the analysis with its status, which is that of Python. @param {number[]} parameters */
  run(parameters) {
    try {
      const run = this.live.run(parameters);
      return { run, status: checkedStatus(this.live, run) };
    } catch (error) {
      if (error instanceof RunFailure) return { run: null, status: failedStatus(this.live, error) };
      throw error;
    }
  }

  /** @param {Record<string, number>} values */
  simulate(values) {
    const { run, status } = this.run(this.vector(values)), n = run?.times.length ?? 0;
    const outputs = this.data.measures.map(([name, , row]) => [name, run?.table.slice(n * row, n * (row + 1)) ?? new Float64Array()]);
    return { ...Object.fromEntries(outputs), time: run?.times.slice() ?? new Float64Array(), status: status.outcome, message: status.message };
  }

  /** Value and gradient of a response. @param {string} label @param {Record<string, number>} values */
  reduce(label, values) {
    const response = this.response(label), { run, status } = this.run(this.vector(values));
    if (!run || !status.success) throw new Error(`${status.outcome}: ${status.message}`);
    const n = run.times.length, { inside, located } = /** @type {any} */ (run);
    return { run, ...responseOf(response, run.times, (row) => run.table.subarray(n * row, n * (row + 1)), inside, located) };
  }

  /** @param {string} label @param {Record<string, number>} values */
  gradient(label, values) {
    const { run, weights } = this.reduce(label, values), slopes = this.live.gradient(run, weights);
    return Object.fromEntries(this.names.map((name, k) => [name, slopes[k]]));
  }
}

/** @param {Run} Run class of the runs @param {ModuleData} data */
export async function loaded(Run, data) {
  return new Analysis(Run, await WebAssembly.compile(await inflated(bytesOf(data.live.code))), data);
}
