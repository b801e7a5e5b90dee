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

/** Card of a task: progress while it runs, its result afterwards.
 * @param {TaskMessage} task @param {string} title @param {string} digest of the present text @param {{ stop: () => void, open: (task: TaskMessage) => void }} actions */
function taskCard(task, title, digest, { stop, open }) {
  const { status, fraction, history, text, page } = task, runs = status === "running";
  const age = digest === task.digest ? "of the present text" : "of a former text";
  return el("div", { class: `task ${status}`, role: "status" },
    el("div", { class: "head" }, el("strong", {}, `${title}: ${STATES[status]}`), el("small", {}, age)),
    runs && (fraction === null ? el("progress", { "aria-label": "Progress" }) : el("progress", { value: fraction, max: 1, "aria-label": "Progress" })),
    history.length > 0 && historyPlot(history),
    text && el("p", { class: "result" }, text),
    el("div", { class: "chips" }, runs && button("Stop", stop, { title: "End the search; its result so far is kept. A second time: end it at once" }), page && button("Show the result", () => open(task), { class: "button primary" })));
}

/** Show the cards of tasks. The buttons of a running task stay in the page while its progress changes, so that they can be clicked.
 * @param {HTMLElement} parent @param {TaskMessage[]} tasks @param {(section: string) => string} titleOf @param {string} digest of the present text @param {{ stop: () => void, open: (task: TaskMessage) => void }} actions */
export function showTasks(parent, tasks, titleOf, digest, actions) {
  const former = [.../** @type {HTMLCollectionOf<HTMLElement>} */ (parent.children)];
  const cards = tasks.map((task) => {
    const card = taskCard(task, titleOf(task.section), digest, actions), buttons = ".chips";
    card.dataset.task = [task.section, task.number, task.status].join();
    const shown = task.status === "running" ? former.find((other) => other.dataset.task === card.dataset.task) : undefined, kept = shown?.querySelector(buttons);
    if (!shown || !kept) return card;
    for (const part of [...shown.children]) if (part !== kept) part.remove();
    kept.before(...[...card.children].filter((part) => !part.matches(buttons)));
    return shown;
  });
  if (cards.length !== former.length || cards.some((card, k) => card !== former[k])) parent.replaceChildren(...cards);
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
