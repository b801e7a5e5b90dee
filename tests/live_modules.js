// Runs of live modules in Node: `node live_modules.js FOLDER` reads FOLDER/cases.json and writes FOLDER/results.json.

import { readFileSync, writeFileSync } from "node:fs";
import { inflateSync } from "node:zlib";
import { LIBRARY } from "./live_engine.js";
import { invalid } from "./live_limits.js";
import { responseOf } from "./live_responses.js";
import { RunFailure } from "./live_run.js";
import { checkedStatus, failedStatus } from "./live_status.js";

const folder = process.argv[2];

/** Numbers of JSON, which has no infinities. */
const plain = (values) => Array.from(values, (x) => (Number.isFinite(x) ? x : String(x)));

function outcome({ data: { exact, ...constants }, parameters, weights, responses }, classes) {
  const data = { ...JSON.parse(exact), ...constants }, run = new classes[data.kind](new WebAssembly.Module(inflateSync(Buffer.from(data.code, "base64"))), data);
  try {
    const result = run.run(parameters), { times, table, rows } = result, status = checkedStatus(run, result);
    const reduced = responses.map((response) => responseOf(response, times, (row) => table.subarray(times.length * row, times.length * (row + 1)), result.inside, result.located));
    const samples = [...reduced.map((response) => response.weights), ...weights.map((entries) => new Map(entries.map(([row, values]) => [row, Float64Array.from(values)])))];
    const gradients = samples.map((entries) => run.gradient(result, entries));
    const bytes = run.engine.bytes, again = run.run(parameters);
    for (const entries of samples) run.gradient(again, entries);
    const start = run.first?.(parameters), begins = !start || start.table.every((value, r) => Object.is(value, table[times.length * r]));
    const same = begins && bytes === run.engine.bytes && again.table.every((value, k) => Object.is(value, table[k]));
    return { times: plain(times), table: plain(table), rows, status, values: plain(reduced.map(({ value }) => value)), gradients: gradients.map(plain), same };
  } catch (error) {
    if (error instanceof RunFailure) return { status: failedStatus(run, error) };
    throw error;
  }
}

const { cases, calls, runs, limits } = JSON.parse(readFileSync(`${folder}/cases.json`, "utf8"));
const classes = {};
for (const [kind, [module, name]] of Object.entries(runs)) classes[kind] = (await import(`./${module}`))[name];
const results = Object.fromEntries(Object.entries(cases).map(([name, entry]) => [name, outcome(entry, classes)]));
const values = calls.map(([name, ...columns]) => columns[0].map((_, k) => LIBRARY[name](...columns.map((column) => Number(column[k])))));
writeFileSync(`${folder}/results.json`, JSON.stringify({ results, values: values.map(plain), messages: limits.map(([rows, numbers]) => invalid(rows, numbers.map(Number))) }));
