// Design tasks that run beside the server: their state, progress and result, shared by all pages.

/** @import { TaskMessage } from "./types.d.ts" */

import { button, el } from "./dom.js";

const PLOT = { width: 300, height: 90, margin: 6 };

/** Objective over the iterations. @param {[number, number][]} history */
function historyPlot(history) {
  const { width, height, margin } = PLOT, values = history.map(([, value]) => value), low = Math.min(...values), high = Math.max(...values), last = history.length - 1;
  const at = (/** @type {number} */ k) => [margin + (k / Math.max(1, last)) * (width - 2 * margin), height - margin - ((values[k] - low) / (high - low || 1)) * (height - 2 * margin)].map((v) => v.toFixed(1)).join(",");
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), line = document.createElementNS(svg.namespaceURI, "polyline"), dot = document.createElementNS(svg.namespaceURI, "circle");
  const [x, y] = at(last).split(",");
  for (const [key, value] of Object.entries({ viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Objective over ${history.length} iterations, now ${values[last]}` })) svg.setAttribute(key, String(value));
  line.setAttribute("points", history.map((_, k) => at(k)).join(" "));
  for (const [key, value] of Object.entries({ cx: x, cy: y, r: 3.5 })) dot.setAttribute(key, String(value));
  svg.append(line, dot);
  return el("figure", { class: "history" }, svg, el("figcaption", {}, el("span", {}, `iteration ${history[last][0]}`), el("span", {}, `objective ${Number(values[last].toPrecision(6))}`)));
}

const STATES = { running: "runs", done: "done", stopped: "stopped", failed: "failed" };

/** Card of a task: progress while it runs, its result afterwards.
 * @param {TaskMessage} task @param {number} revision of the present text @param {{ stop: () => void, open: (task: TaskMessage) => void }} actions */
export function taskCard(task, revision, { stop, open }) {
  const { status, fraction, history, text, page } = task, runs = status === "running";
  const age = revision === task.revision ? "of the present text" : `of revision ${task.revision}; the text has changed since (revision ${revision})`;
  return el("div", { class: `task ${status}`, role: "status" },
    el("div", { class: "head" }, el("strong", {}, `${task.section}: ${STATES[status]}`), el("small", {}, age)),
    runs && (fraction === null ? el("progress", { "aria-label": "Progress" }) : el("progress", { value: fraction, max: 1, "aria-label": "Progress" })),
    history.length > 0 && historyPlot(history),
    text && el("p", { class: "result" }, text),
    el("div", { class: "chips" }, runs && button("Stop", stop, { title: "End the search; its result so far is kept. A second time: end it at once" }), page && button("Show the result", () => open(task), { class: "button primary" })));
}

/** Result of a task in a frame over the desk. */
export class ResultPanel {
  /** @param {(task: TaskMessage, values: Record<string, number>) => void} write */
  constructor(write) {
    this.title = el("strong", {});
    this.adopt = button("Write its parameters into the text", () => this.write(), { class: "button primary" });
    this.frame = el("iframe", { title: "Result of the task" });
    this.bar = el("div", { class: "title-row" }, this.title, this.adopt, button("Close", () => this.close()));
    this.node = /** @type {HTMLDialogElement} */ (el("dialog", { class: "result-panel", "aria-label": "Result" }, this.bar, this.frame));
    document.body.append(this.node);
    /** @type {TaskMessage | null} */
    this.task = null;
    this.onWrite = write;
    this.frame.addEventListener("load", () => this.themed());
  }

  /** @param {TaskMessage} task */
  open(task) {
    this.task = task;
    this.title.textContent = `${task.section}, revision ${task.revision}`;
    this.adopt.hidden = !task.designs.length;
    this.frame.src = task.page;
    this.node.showModal();
  }

  close() { this.node.close(); }

  themed() {
    const root = this.frame.contentDocument?.documentElement;
    if (root && root.dataset.theme !== document.documentElement.dataset.theme) this.frame.contentDocument?.getElementById("theme")?.click();
  }

  /** Write the chosen design. */
  write() {
    const { task } = this, page = /** @type {any} */ (this.frame.contentWindow)?.dalembert;
    if (!task) return;
    const chosen = task.designs.length > 1 ? Math.max(0, page?.choice?.chosen ?? 0) : 0;
    this.close();
    this.onWrite(task, task.designs[Math.min(chosen, task.designs.length - 1)]);
  }
}
