// Payload of the page: packed columns are unpacked, the design named by the address is selected.

/** @import { Head, Payload } from "./types.d.ts" */

import { byId } from "./dom.js";
import { bytesOf, inflated } from "./inflate.js";
import { clamp, list } from "./numbers.js";

/** Column of byte planes of differences; see `report/packing.py`.
 * @param {Head} head @param {Uint8Array} data @param {number} at first byte of the column */
function readColumn({ n, low, step, planes, gaps, order }, data, at) {
  /** @type {number[]} */
  const sums = Array(order).fill(0);
  const values = new Float64Array(n).fill(+low);
  for (let i = 0; planes && i < n; i++) {
    let code = 0;
    for (let k = planes - 1; k >= 0; k--) code = 256 * code + data[at + k * n + i];
    let sum = code % 2 ? -(code + 1) / 2 : code / 2;
    for (let k = 0; k < order; k++) sum = sums[k] += sum;
    values[i] = +low + sum * +step;
  }
  for (const [first, count] of gaps || []) values.fill(NaN, first, first + count);
  return +step === 1 ? Array.from(values) : values;  // integers are indices of other lists
}

/** @param {Payload} data @returns {Promise<Payload>} */
async function unpacked(data) {
  if (!data.columns) return data;
  const { heads, data: text } = data.columns, bytes = await inflated(bytesOf(text));
  let at = 0;
  const columns = heads.map((head) => {
    const column = readColumn(head, bytes, at);
    at += head.n * head.planes;
    return column;
  });
  /** @type {(value: unknown) => unknown} */
  const restored = (value) => {
    if (Array.isArray(value)) return value.map(restored);
    if (!value || typeof value !== "object") return value;
    const entries = Object.entries(value);
    if (entries.length === 1 && entries[0][0] === "column") return columns[entries[0][1]];
    return Object.fromEntries(entries.map(([key, item]) => [key, restored(item)]));
  };
  return /** @type {Payload} */ (restored({ ...data, columns: undefined }));
}

/** The payload with the selected design in place, by default that of the table; `#design=2` selects another.
 * @param {Payload} data @returns {Payload} */
function withSelectedDesign(data) {
  const alternatives = list(data.designs?.alternatives);
  if (!data.designs || !alternatives.length) return data;
  const requested = /^#design=(\d+)$/.exec(location.hash);
  if (requested) data.designs.chosen = clamp(+requested[1], 0, alternatives.length - 1);
  return { ...data, ...alternatives[data.designs.chosen] };
}

/** Data of the page; a page without them waits until the page around it calls `receiveData`. @returns {Promise<Payload>} */
async function pageData() {
  const node = document.getElementById("data");
  if (!node || node.textContent) return JSON.parse(node?.textContent ?? "{}");
  node.textContent = await new Promise((resolve) => { Object.assign(window, { receiveData: resolve }); });
  const data = JSON.parse(node.textContent ?? "{}");
  document.title = byId("title").textContent = data.title || "Report";
  return data;
}

export const payload = withSelectedDesign(await unpacked(await pageData()));
