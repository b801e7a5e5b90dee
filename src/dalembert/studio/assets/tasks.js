// Design tasks that run beside the server: their state, progress and result, shared by all pages.

/** @import { TaskMessage } from "./types.d.ts" */

import { button, el } from "./dom.js";

/** Time between looks whether the sliders of a result are ready [ms]. */
const LOOK = 50;
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

/** Card of a task: progress while it runs, its result afterwards. Its buttons stay while the task proceeds, so that a press or the focus of one is not lost. */
class TaskCard {
  /** @param {Actions} actions */
  constructor({ stop, open }) {
    /** @type {TaskMessage | null} */
    this.task = null;
    this.title = el("strong", {});
    this.age = el("small", {});
    this.progress = el("progress", { "aria-label": "Progress" });
    this.plot = el("div", {});
    this.result = el("p", { class: "result" });
    this.stop = button("Stop", stop);
    this.open = button("Show the result", () => this.task && open(this.task), { class: "button primary" });
    this.node = el("div", { role: "status" }, el("div", { class: "head" }, this.title, this.age), this.progress, this.plot, this.result, el("div", { class: "chips" }, this.stop, this.open));
  }

  /** @param {TaskMessage} task @param {string} title @param {string} digest of the present text */
  show(task, title, digest) {
    const { status, fraction, history, text, page } = this.task = task, runs = status === "running", stops = runs && task.stopping;
    this.node.className = `task ${status}`;
    this.title.textContent = `${title}: ${stops ? "stops and completes its result" : STATES[status]}`;
    this.age.textContent = digest === task.digest ? "of the present text" : "of a former text";
    this.progress.hidden = !runs;
    if (fraction === null) this.progress.removeAttribute("value");
    else this.progress.value = fraction;
    this.plot.replaceChildren(...(history.length ? [historyPlot(history)] : []));
    this.plot.hidden = !history.length;
    this.result.textContent = text;
    this.result.hidden = !text;
    this.stop.hidden = !runs;
    this.stop.textContent = stops ? "End at once" : "Stop";
    this.stop.title = stops ? "Without its result so far" : "End the search; its result so far is kept";
    this.open.hidden = !page;
  }
}

/** @typedef {{ stop: () => void, open: (task: TaskMessage) => void, digest: () => string }} Actions */

/** Cards of tasks, one for each section. */
export class TaskCards {
  /** @param {Actions} actions */
  constructor(actions) {
    this.actions = actions;
    this.node = el("div", { class: "states" });
    /** @type {Map<string, TaskCard>} */
    this.cards = new Map();
  }

  /** @param {TaskMessage[]} tasks @param {(section: string) => string} titleOf */
  show(tasks, titleOf) {
    const nodes = tasks.map((task) => {
      const card = this.cards.get(task.section) ?? new TaskCard(this.actions);
      this.cards.set(task.section, card);
      card.show(task, titleOf(task.section), this.actions.digest());
      return card.node;
    });
    if (nodes.length !== this.node.children.length || nodes.some((node, k) => node !== this.node.children[k])) this.node.replaceChildren(...nodes);
  }
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
    /** Sliders of the page, when they are ready. @type {any} */
    this.design = null;
    /** @type {ReturnType<typeof setInterval> | undefined} */
    this.waiting = undefined;
    this.frame.addEventListener("load", () => {
      this.themed();
      this.listen();
    });
    this.node.addEventListener("close", () => clearInterval(this.waiting));
  }

  /** Offer the values of the sliders as soon as they are moved. */
  listen() {
    clearInterval(this.waiting);
    this.waiting = setInterval(() => {
      const design = /** @type {any} */ (this.frame.contentWindow)?.dalembert?.design;
      if (!design) return;
      clearInterval(this.waiting);
      this.design = design;
      design.onChange.on(() => this.offer(design.changed && design.row() === null));
    }, LOOK);
  }

  /** Offer to write the parameters. @param {boolean} moved whether the sliders have been moved */
  offer(moved) {
    this.adopt.hidden = !moved && !this.task?.designs.length;
    this.adopt.textContent = moved ? "Write the values of the sliders into the text" : "Write its parameters into the text";
  }

  /** @param {TaskMessage} task @param {string} title */
  open(task, title) {
    [this.task, this.design] = [task, null];
    this.title.textContent = title;
    this.offer(false);
    this.frame.src = task.page;
    this.node.showModal();
  }

  close() { this.node.close(); }

  themed() {
    const root = this.frame.contentDocument?.documentElement;
    if (root && root.dataset.theme !== document.documentElement.dataset.theme) this.frame.contentDocument?.getElementById("theme")?.click();
  }

  /** Write the chosen design, or that of the sliders if they have been moved. */
  write() {
    const { task } = this;
    if (!task) return;
    const values = { ...task.designs[this.chosen], ...this.moved };
    this.close();
    this.onWrite(task, values);
  }

  /** Number of the chosen design. */
  get chosen() {
    const chosen = /** @type {any} */ (this.frame.contentWindow)?.dalembert?.choice?.chosen ?? 0;
    return Math.max(0, Math.min(chosen, (this.task?.designs.length ?? 1) - 1));
  }

  /** Values of the sliders that differ from the chosen design. @returns {Record<string, number>} */
  get moved() {
    const { design } = this;
    if (!design?.changed || design.row() !== null) return {};
    /** @type {{ name: string, drawn?: unknown }[]} */
    const parameters = design.parameters, several = (this.task?.designs.length ?? 0) > 1;
    return Object.fromEntries(parameters.flatMap(({ name, drawn }, k) => (drawn || (!several && design.values[k] === design.initial[k]) ? [] : [[name, design.values[k]]])));
  }
}
