// Sheet "Synthesis": the targets, and the candidates as moving cards.

/** @import { Card, Document, TaskMessage } from "./types.d.ts" */

import { numberField } from "./analysis.js";
import { titleOf } from "./design.js";
import { button, el } from "./dom.js";
import { accept } from "./field_values.js";
import { CHART, chartScale, drawChart } from "./function_chart.js";
import { SIX_BARS, linkageFields } from "./six_bars.js";
import { COLUMNS, addedFunctionPoint, movedFunctionPoint, removedRow, synthesisOf, targetOf, typed } from "./target_edits.js";
import { TaskCards } from "./tasks.js";

/** Time of a revolution on a card [ms]. */
const TURN = 3000;
const CARD = { width: 168, height: 128, margin: 10 };
const LINKAGES = ["FourBar", "SliderCrank", ...Object.keys(SIX_BARS), "own"];
const TYPES = { path: "Path of a point", motion: "Poses of a body", function: "Function of the crank" };
const SORTS = { error: "error", distance: "largest distance", marks: "defects" };

export class SynthesisSheet {
  /** @param {{ start: (section: string) => void, stop: () => void, open: (task: TaskMessage) => void, edit: (label: string, operations: Record<string, unknown>[]) => void, draw: (tool: string) => void, mark: (entry: number) => void, fit: () => void, digest: () => string }} actions */
  constructor(actions) {
    this.actions = actions;
    /** @type {Document | null} */
    this.document = null;
    /** @type {TaskMessage | null} */
    this.task = null;
    /** Last task of the other sheet, which does not run beside a search. @type {TaskMessage | null} */
    this.other = null;
    /** @type {keyof typeof SORTS} */
    this.sort = "error";
    this.form = el("div", { class: "form" });
    this.states = new TaskCards(actions);
    this.cards = el("div", { class: "candidates" });
    this.node = el("section", { class: "sheet synthesis" }, this.form, this.states.node, this.cards);
    /** Canvases of the cards. @type {{ canvas: HTMLCanvasElement, card: Card }[]} */
    this.drawn = [];
    const draw = (/** @type {number} */ time) => {
      requestAnimationFrame(draw);
      if (this.drawn.length && this.node.offsetParent) for (const { canvas, card } of this.drawn) drawCard(canvas, card, matchMedia("(prefers-reduced-motion: reduce)").matches ? 0.15 : (time / TURN) % 1);
    };
    requestAnimationFrame(draw);
    this.render();
  }

  /** @param {Document | null} document */
  show(document) {
    if (document) this.document = document;
    this.render();
  }

  /** @param {TaskMessage} task */
  receive(task) {
    if (task.section !== "synthesis") {
      this.other = task;
      return this.renderState();
    }
    const fresh = this.task?.number !== task.number || this.task.status !== task.status;
    this.task = task;
    this.renderState();
    if (fresh) this.renderCards();
  }

  /** @param {string} label @param {Record<string, unknown>} fields */
  set(label, fields) { this.actions.edit(label, [{ op: "section", section: "synthesis", fields }]); }

  render() {
    const table = synthesisOf(this.document), type = /** @type {keyof typeof TYPES} */ (table.type ?? "path");
    const focused = /** @type {HTMLInputElement | null} */ (this.form.querySelector(":focus"))?.name;
    const choose = (/** @type {string} */ key, /** @type {Record<string, string>} */ options, /** @type {string} */ value, /** @type {string} */ label) => {
      const select = el("select", { name: key, onchange: () => this.set(`set ${key}`, key === "linkage" || (key === "type" && SIX_BARS[table.linkage]) ? { type, [key]: select.value, ...linkageFields(key === "linkage" ? select.value : table.linkage, key === "type" ? select.value : type, targetOf(this.document).points.filter((point) => point.every(Number.isFinite))) } : { type, [key]: select.value }) }, Object.entries(options).map(([name, text]) => el("option", { value: name }, text)));
      select.value = value;
      return el("label", { class: "field" }, el("span", {}, label), select);
    };
    const closed = el("input", { type: "checkbox", name: "closed", onchange: () => this.set("set closed", { type, closed: closed.checked }) });
    closed.checked = table.closed === true;
    this.form.replaceChildren(...[
      el("p", { class: "muted" }, "Targets are clicked on the drawing, or written here; linkages that reach them are searched."),
      el("div", { class: "fields" }, choose("type", TYPES, type, "Target"), choose("linkage", Object.fromEntries(LINKAGES.map((name) => [name, name === "own" ? "the drawn mechanism" : name])), table.linkage ?? "FourBar", "Linkage"),
        numberField({ key: "starts", label: "Starts", whole: true }, table.starts, (value) => this.set("set starts", { type, starts: value })),
        type === "path" && el("label", { class: "field check" }, closed, "closed path"),
        table.linkage === "own" && numberField({ key: "point", label: "Point", text: true }, table.point, (value) => this.set("set point", { type, point: value }))),
      type === "function" ? this.functionTarget() : el("div", { class: "chips" }, button(type === "path" ? "Click points (⇧T)" : "Click poses (⇧P)", () => this.actions.draw(type === "path" ? "target" : "pose"), { class: "button" })),
      this.entries(table, type),
      el("div", { class: "chips" }, button("Search linkages", () => this.actions.start("synthesis"), { class: "button primary", id: "start-synthesis", disabled: !this.count(table, type) })),
    ].filter((node) => node instanceof Node));
    if (focused) /** @type {HTMLElement | null} */ (this.form.querySelector(`[name="${CSS.escape(focused)}"]`))?.focus();
    this.renderState();
  }

  /** Number of entries of the target. @param {Record<string, any>} table @param {string} type */
  count(table, type) { return (type === "function" ? table.outputs : table.points)?.length ?? 0; }

  /** List of the entries. @param {Record<string, any>} table @param {string} type */
  entries(table, type) {
    const count = this.count(table, type), columns = COLUMNS[type];
    if (!count) return el("p", { class: "muted" }, "No entries yet.");
    const heads = type === "function" ? ["crank [rad]", "output [rad]"] : type === "motion" ? ["x [m]", "y [m]", "angle [rad]"] : ["x [m]", "y [m]"];
    const cell = (/** @type {number} */ row, /** @type {string} */ key, /** @type {number | null} */ part) => {
      const item = table[key]?.[row], old = (part === null ? item : item?.[part]) ?? "";
      const input = el("input", { name: `${key}-${row}-${part}`, value: String(old), title: "number, number with a unit, or formula", "aria-label": `${key} ${row + 1}`, spellcheck: "false", autocomplete: "off",
        onchange: () => accept(input, { required: "A target needs this number; × removes the entry" }, old, (value) => this.actions.edit("move target", typed(key, row, part, value))) });
      return el("td", {}, input);
    };
    return el("div", { class: "entries" }, el("table", {}, el("thead", {}, el("tr", {}, ["", ...heads, ""].map((text) => el("th", { scope: "col" }, text)))), el("tbody", {}, Array.from({ length: count }, (_, row) =>
      el("tr", { onmouseenter: () => this.actions.mark(row), onmouseleave: () => this.actions.mark(-1) }, el("th", { scope: "row" }, String(row + 1)), columns.flatMap(([key, parts]) => parts.map((part) => cell(row, key, part))), el("td", {}, button("×", () => this.actions.edit("remove target", removedRow(this.document, row)), { class: "button quiet", "aria-label": `Remove entry ${row + 1}` })))))));
  }

  /** Chart on which points of a function are clicked. */
  functionTarget() {
    const canvas = el("canvas", { class: "function", ...CHART, tabindex: "0", role: "img", "aria-label": "Output over crank angle; a click adds a point" }), { crank, outputs } = targetOf(this.document), scale = chartScale(outputs);
    const at = (/** @type {PointerEvent} */ event) => { const box = canvas.getBoundingClientRect(); return [((event.clientX - box.left) / box.width) * CHART.width, ((event.clientY - box.top) / box.height) * CHART.height]; };
    const values = (/** @type {PointerEvent} */ event) => scale.values(at(event)).map((value) => Number(value.toPrecision(4)));
    let dragged = -1, moved = /** @type {number[] | null} */ (null);
    const style = getComputedStyle(document.documentElement), draw = () => drawChart(/** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")), scale, crank.map((x, k) => (k === dragged && moved ? moved : [x, outputs[k]])), (name) => style.getPropertyValue(`--${name}`).trim());
    canvas.addEventListener("pointerdown", (event) => {
      const [u, v] = at(event);
      dragged = crank.findIndex((x, k) => { const [a, b] = scale.pixel([x, outputs[k]]); return Math.hypot(a - u, b - v) < 16; });
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (dragged < 0 || !event.buttons) return;
      moved = values(event);
      draw();
    });
    canvas.addEventListener("pointerup", (event) => {
      const operations = dragged < 0 ? addedFunctionPoint(this.document, values(event)) : moved ? movedFunctionPoint(this.document, dragged, moved) : [];
      if (operations.length) this.actions.edit(dragged < 0 ? "add function point" : "move function point", operations);
      [dragged, moved] = [-1, null];
      draw();  // formulas are not moved
    });
    draw();
    return el("figure", {}, canvas, el("figcaption", { class: "muted" }, "A click adds a point, a drag moves one: output [rad, m] over the crank angle."));
  }

  renderState() {
    const tasks = [this.task, this.other?.status === "running" ? this.other : null];
    this.states.show(tasks.flatMap((task) => task ?? []), titleOf);
  }

  renderCards() {
    const cards = [...(this.task?.cards ?? [])], { sort } = this;
    cards.sort((a, b) => (sort === "marks" ? a.marks.length - b.marks.length || a.error - b.error : a[sort] - b[sort]));
    this.drawn = [];
    if (!cards.length) return this.cards.replaceChildren();
    const order = el("select", { name: "sort", "aria-label": "Order of the candidates", onchange: () => { this.sort = /** @type {keyof typeof SORTS} */ (order.value); this.renderCards(); } }, Object.entries(SORTS).map(([value, text]) => el("option", { value }, text)));
    order.value = sort;
    this.cards.replaceChildren(el("label", { class: "field wide" }, el("span", {}, `${cards.length} candidates, sorted by`), order), ...cards.map((card, k) => {
      const canvas = el("canvas", { width: 2 * CARD.width, height: 2 * CARD.height, role: "img", "aria-label": `Motion of candidate ${k + 1}` });
      this.drawn.push({ canvas, card });
      const sizes = Object.entries(card.dimensions).filter(([, value]) => value).map(([name, value]) => `${name} ${Number(value.toPrecision(4))}`).join(", ");
      return el("article", { class: "candidate", title: sizes }, canvas, el("div", {}, el("b", {}, `error ${Number(card.error.toPrecision(3))}`), el("small", {}, `max. ${Number(card.distance.toPrecision(3))}`)),
        el("div", { class: "defects" }, card.marks.length ? card.marks.map((text) => el("span", { class: "defect" }, text)) : el("span", { class: "good" }, "no defects")),
        card.operations || card.parameters ? button("Insert", () => this.insert(card), { title: card.operations ? "Add the linkage to the text" : "Write its parameters into the text" }) : el("small", { class: "muted" }, "shown only"));
    }));
  }

  /** @param {Card} card */
  insert(card) {
    if (card.operations) {
      this.actions.fit();
      this.actions.edit("insert linkage", card.operations);
    }
    else if (card.parameters) this.actions.edit("set parameters", Object.entries(card.parameters).map(([name, value]) => ({ op: "parameter", name, value })));
  }
}

/** A candidate at a phase of its motion. @param {HTMLCanvasElement} canvas @param {Card} card @param {number} phase */
function drawCard(canvas, { lines, curve, target }, phase) {
  const ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")), places = [...lines.flat(2), ...curve, ...target];
  if (!places.length) return;
  const [x0, x1, y0, y1] = [0, 1].flatMap((k) => [Math.min(...places.map((p) => p[k])), Math.max(...places.map((p) => p[k]))]);
  const s = Math.min((CARD.width - 2 * CARD.margin) / (x1 - x0 || 1), (CARD.height - 2 * CARD.margin) / (y1 - y0 || 1));
  const at = (/** @type {number[]} */ [x, y]) => /** @type {[number, number]} */ ([CARD.width / 2 + (x - (x0 + x1) / 2) * s, CARD.height / 2 - (y - (y0 + y1) / 2) * s]);
  const style = getComputedStyle(document.documentElement), colour = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
  ctx.setTransform(2, 0, 0, 2, 0, 0);
  ctx.clearRect(0, 0, CARD.width, CARD.height);
  const draw = (/** @type {number[][]} */ points, /** @type {string} */ stroke, /** @type {number} */ width) => {
    ctx.beginPath();
    for (const point of points) ctx.lineTo(...at(point));
    [ctx.strokeStyle, ctx.lineWidth, ctx.lineJoin, ctx.lineCap] = [stroke, width, "round", "round"];
    ctx.stroke();
  };
  draw(curve, colour("accent"), 1.2);
  lines.forEach((frames, k) => {
    const points = frames[Math.floor(phase * frames.length) % frames.length];
    draw(points, colour(k ? "muted" : "ink"), k ? 1.5 : 3);
    if (k) return;
    ctx.fillStyle = colour("surface");
    for (const point of points) {
      ctx.beginPath();
      ctx.arc(...at(point), 2.6, 0, 2 * Math.PI);
      ctx.fill();
      ctx.lineWidth = 1.2;
      ctx.stroke();
    }
  });
  ctx.fillStyle = colour("error");
  for (const point of target) {
    ctx.beginPath();
    ctx.arc(...at(point), 2.2, 0, 2 * Math.PI);
    ctx.fill();
  }
}
