// Runs of live modules in Node: `node live_modules.js FOLDER` reads FOLDER/cases.json and writes FOLDER/results.json.

import { readFileSync, writeFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { LIBRARY } from "./live_engine.js";
import { LiveEquilibrium } from "./live_equilibrium.js";
import { LiveKinematics } from "./live_kinematics.js";
import { LiveModes } from "./live_modes.js";
import { LiveRun, RunFailure } from "./live_run.js";
import { LiveStatics, LiveVibration } from "./live_structures.js";
import { checkedStatus, failedStatus } from "./live_status.js";

const KINDS = { dynamics: LiveRun, kinematics: LiveKinematics, equilibrium: LiveEquilibrium, modes: LiveModes, statics: LiveStatics, vibration: LiveVibration };
const folder = process.argv[2];

/** Numbers of JSON, which has no infinities. */
const plain = (values) => Array.from(values, (x) => (Number.isFinite(x) ? x : String(x)));

function outcome({ data: { exact, ...constants }, parameters, weights }) {
  const data = { ...JSON.parse(exact), ...constants }, run = new KINDS[data.kind](new WebAssembly.Module(inflateSync(Buffer.from(data.code, "base64"))), data);
  try {
    const result = run.run(parameters), { times, table, rows } = result, status = checkedStatus(run, result);
    const gradients = weights.map((entries) => run.gradient(result, new Map(entries.map(([row, values]) => [row, Float64Array.from(values)]))));
    const bytes = run.engine.bytes, again = run.run(parameters);
    for (const entries of weights) run.gradient(again, new Map(entries.map(([row, values]) => [row, Float64Array.from(values)])));
    const same = bytes === run.engine.bytes && again.table.every((value, k) => Object.is(value, table[k]));
    return { times: plain(times), table: plain(table), rows, status, gradients: gradients.map(plain), same };
  } catch (error) {
    if (error instanceof RunFailure) return { status: failedStatus(run, error) };
    throw error;
  }
}

const { cases, calls } = JSON.parse(readFileSync(`${folder}/cases.json`, "utf8"));
const results = Object.fromEntries(Object.entries(cases).map(([name, entry]) => [name, outcome(entry)]));
const values = calls.map(([name, ...columns]) => columns[0].map((_, k) => LIBRARY[name](...columns.map((column) => Number(column[k])))));
writeFileSync(`${folder}/results.json`, JSON.stringify({ results, values: values.map(plain) }));
