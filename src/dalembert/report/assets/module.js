// Functions of an exported module: simulation, responses and gradients for parameter values by name.

/** @import { LiveResponse, ModuleData } from "./types.d.ts" */

import { bytesOf, inflated } from "./inflate.js";
import { responseOf } from "./live_responses.js";
import { LiveRun, RunFailure } from "./live_run.js";

/** An analysis of a model. */
class Analysis {
  /** @param {WebAssembly.Module} module @param {ModuleData} data */
  constructor(module, data) {
    this.data = data;
    this.live = new LiveRun(module, data.live);
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

  /** @param {Record<string, number>} values */
  simulate(values) {
    const parameters = this.vector(values);
    /** @type {Record<string, unknown>} */
    const result = {};
    try {
      const { times, table } = this.live.run(parameters), n = times.length;
      this.data.measures.forEach(([name], k) => { result[name] = table.slice(n * k, n * (k + 1)); });
      return { ...result, time: times.slice(), status: "completed" };
    } catch (error) {
      if (!(error instanceof RunFailure)) throw error;
      for (const [name] of this.data.measures) result[name] = new Float64Array();
      const residual = error.residual === undefined ? "" : `; residual ${error.residual.toPrecision(3)}`;
      return { ...result, time: new Float64Array(), status: `${error.message}${residual}` };
    }
  }

  /** Value and gradient of a response. @param {string} label @param {Record<string, number>} values */
  reduce(label, values) {
    const response = this.response(label), run = this.live.run(this.vector(values)), n = run.times.length;
    return { run, ...responseOf(response, run.times, (row) => run.table.subarray(n * row, n * (row + 1))) };
  }

  /** @param {string} label @param {Record<string, number>} values */
  gradient(label, values) {
    const { run, weights } = this.reduce(label, values), slopes = this.live.gradient(run, weights);
    return Object.fromEntries(this.names.map((name, k) => [name, slopes[k]]));
  }
}

/** @param {ModuleData} data */
export async function loaded(data) {
  return new Analysis(await WebAssembly.compile(await inflated(bytesOf(data.live.code))), data);
}
