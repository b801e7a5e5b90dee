// Charts of the cards: axes and curves, drawn anew in the size of their card.

/** @import { CurvesView, Line, View } from "./types.d.ts" */
/** @import { Choice } from "./choice.js" */
/** @import { Motion } from "./motion.js" */

import { el, shape } from "./dom.js";
import { axisTicks, extent, isNum, list, minus, superscript, tidy } from "./numbers.js";

/** @typedef {(v: number) => number} Map1 */
/** @typedef {{ left: number, top: number, right: number, bottom: number }} Box */

/** @param {number} x @param {number} y @param {string} text @param {import("./types.d.ts").Attributes} attributes @param {...Element} more */
export const written = (x, y, text, attributes = {}, ...more) => shape("text", { x, y, ...attributes }, text, more);

/** @param {string} text */
export const hint = (text) => shape("title", {}, text);

/** Charts of modules that only some pages contain, by the kind of their view. @type {Partial<Record<View["kind"], (view: any) => HTMLElement>>} */
export const chartKinds = {};

/** Charts that mark the drawn state of a motion; they are renewed where a live page has changed their view. @type {{ bind(motion: Motion): void, renew(): void }[]} */
export const stateCharts = [];

/** A text of limited length. @param {string} text @param {number} limit */
export const clipped = (text, limit) => (text.length > limit ? `${text.slice(0, limit - 1)}…` : text);

/** Linear or logarithmic axis over some numbers. */
export class Scale {
  /** @param {number[]} values */
  constructor(values, logarithmic = false, pad = 0.06) {
    const valid = values.filter((v) => isNum(v) && (!logarithmic || v > 0));
    this.log = logarithmic;
    this.lo = this.hi = 0;
    const [lo, hi] = (extent([valid]) ?? [0, 1]).map((v) => this.along(v));
    const gap = hi > lo ? pad * (hi - lo) : this.log ? 0.5 : 0.1 * Math.abs(lo) || 1;
    [this.lo, this.hi] = [lo - gap, hi + gap];
  }

  /** @param {number} v */
  along(v) { return this.log ? Math.log10(v) : v; }

  /** Position along the axis, from 0 to 1. @param {number} v */
  share(v) { return (this.along(v) - this.lo) / (this.hi - this.lo); }

  /** Number at a position. @param {number} share */
  value(share) { const v = this.lo + share * (this.hi - this.lo); return this.log ? 10 ** v : v; }

  /** Numbers along the axis with their texts. @param {number} count */
  marks(count) {
    if (this.log) {
      const first = Math.ceil(this.lo - 1e-9), last = Math.floor(this.hi + 1e-9), step = Math.max(1, Math.ceil((last - first + 1) / count));
      const powers = Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => first + k).filter((k) => (k - first) % step === 0);
      if (powers.length < 3 && step === 1) {  // numbers between the powers
        const all = Array.from({ length: last - first + 3 }, (_, k) => first - 1 + k).flatMap((k) => [1, 2, 5].map((digit) => digit * 10 ** k));
        const inside = (/** @type {number} */ v) => Math.log10(v) >= this.lo && Math.log10(v) <= this.hi, between = all.filter(inside);
        const every = all.flatMap((v) => (v / 10 ** Math.floor(Math.log10(v) + 1e-9) < 1.5 ? Array.from({ length: 9 }, (_, k) => (k + 1) * v) : [])).filter(inside);
        return (between.length < 3 && every.length <= 2 * count ? every : between).map((value) => ({ value, text: tidy(value, 3) }));
      }
      return powers.map((k) => ({ value: 10 ** k, text: Math.abs(k) < 4 ? minus(String(10 ** k)) : `10${superscript(k)}` }));
    }
    const { values, texts, power } = axisTicks(this.lo, this.hi, count);
    return values.map((value, k) => ({ value, text: texts[k] + (power && k === values.length - 1 ? `·${power}` : "") }));
  }
}

/** Path through points; a missing number interrupts it.
 * @param {number[]} xs @param {number[]} ys @param {Map1} px @param {Map1} py */
export function pathOf(xs, ys, px, py) {
  /** @type {string[]} */
  const parts = [];
  let on = false;
  xs.forEach((x, k) => {
    const [u, v] = isNum(x) && isNum(ys[k]) ? [px(x), py(ys[k])] : [NaN, NaN];
    if (Number.isFinite(u) && Number.isFinite(v)) parts.push(`${on ? "L" : "M"}${u.toFixed(1)} ${v.toFixed(1)}`);
    on = Number.isFinite(u) && Number.isFinite(v);
  });
  return parts.join("");
}

/** A drawing in a card, drawn anew where its size changes. */
export class Chart {
  /** @param {{ title: string }} view @param {number} height */
  constructor(view, height) {
    this.title = view.title;
    this.height = height;
    this.width = 0;
    this.svg = shape("svg", { class: "chart", role: "img", "aria-label": view.title, height });
    this.legend = el("div", { class: "legend", hidden: true });
    this.node = el("div", { class: "drawing" }, this.legend, this.svg);
    new ResizeObserver(() => this.resized()).observe(this.node);
  }

  resized() {
    const width = this.node.clientWidth;
    if (!width || width === this.width) return;
    this.width = width;
    this.redraw();
  }

  redraw() {
    if (!this.width) return;
    this.svg.replaceChildren();
    this.resize(this.height);
    this.draw(this.width, this.height);
  }

  /** @param {number} height */
  resize(height) {
    this.height = Math.round(height);
    this.svg.setAttribute("height", String(this.height));
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
  }

  /** Draw in a width and a height. @param {number} w @param {number} h */
  draw(w, h) {}

  /** Draw the grid, numbers and names of two axes; return the positions of numbers.
   * @param {Box} box @param {Scale} x @param {Scale} y @param {[string, string]} names
   * @param {number} [up] count of numbers of the y-axis */
  frame({ left, top, right, bottom }, x, y, names, up = Math.max(2, (bottom - top) / 42)) {
    /** @type {Map1} */
    const px = (v) => left + x.share(v) * (right - left);
    /** @type {Map1} */
    const py = (v) => bottom - y.share(v) * (bottom - top);
    const grid = shape("g", { class: "grid" }), texts = shape("g", { class: "numbers" });
    for (const { value, text } of x.marks(Math.max(2, (right - left) / 80))) {
      grid.append(shape("line", { x1: px(value), x2: px(value), y1: top, y2: bottom }));
      texts.append(written(px(value), bottom + 16, text, { "text-anchor": "middle" }));
    }
    for (const { value, text } of y.marks(up)) {
      grid.append(shape("line", { x1: left, x2: right, y1: py(value), y2: py(value) }));
      texts.append(written(left - 7, py(value) + 4, text, { "text-anchor": "end" }));
    }
    texts.append(written((left + right) / 2, bottom + 33, names[0], { "text-anchor": "middle", class: "name" }));
    texts.append(written(0, 0, names[1], { "text-anchor": "middle", class: "name", transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)` }));
    this.svg.append(grid, shape("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "edge" }), texts);
    return { px, py };
  }

  /** Frame that leaves space for the numbers of its y-axis.
   * @param {number} w @param {number} h @param {Scale} y @returns {Box} */
  box(w, h, y) {
    const longest = Math.max(2, ...y.marks((h - 52) / 42).map(({ text }) => text.length));
    return { left: 34 + 6.6 * longest, top: 10, right: w - 12, bottom: h - 42 };
  }

  /** Show the legend if it has several entries. @param {{ name: string, look: string }[]} entries */
  setLegend(entries) {
    this.legend.replaceChildren(...entries.map(({ name, look }) => el("span", { class: "key" }, el("i", { class: `sample ${look}` }), el("span", { class: "name", title: name }, name))));
    this.legend.hidden = entries.length < 2;
  }
}

/** Mark the selected design in a chart. @param {Element} svg @param {number} chosen */
export function markDesign(svg, chosen) {
  for (const old of svg.querySelectorAll(".chosen")) old.classList.remove("chosen");
  for (const node of svg.querySelectorAll(`[data-design="${chosen}"]`)) {
    node.classList.add("chosen");
    node.parentNode?.append(node);  // above the others
  }
}

/** Curves, dots and bands over one axis; curves of a design only where it is selected, dots of designs select them. */
export class CurvesChart extends Chart {
  /** @param {CurvesView} view @param {Choice | null} choice */
  constructor(view, choice) {
    super(view, view.equal ? 340 : 230);
    this.view = view;
    this.choice = view.follows ? choice : null;
    this.choice?.onChoose.on(() => this.redraw());
    this.designs = view.lines.some(({ designs }) => designs) ? choice : null;
    this.designs?.bind(this.svg, view.title);
    this.designs?.onChoose.on((k) => markDesign(this.svg, k));
    /** Name of a curve → its colour. @type {Map<string, number>} */
    this.colours = new Map();
    for (const { name, quiet } of view.lines) if (!quiet && !this.colours.has(name)) this.colours.set(name, this.colours.size);
    this.setLegend([...this.colours].map(([name, k]) => ({ name, look: `s${k % 7} ${view.lines.find((line) => line.name === name)?.style}` })));
  }

  /** Numbers that an axis has to include. @param {"x" | "y"} key @returns {number[]} */
  numbers(key) {
    const { lines, equal } = this.view;
    return lines.filter((line) => !line.quiet || equal).flatMap((line) => [...list(line[key]), ...(key === "y" ? list(line.low) : [])]);
  }

  /** @param {number} w @param {number} h @override */
  draw(w, h) {
    const { view } = this, logarithmic = view.logarithmic ?? "", levels = list(view.levels);
    const x = new Scale(this.numbers("x"), logarithmic.includes("x")), y = new Scale([...this.numbers("y"), ...levels], logarithmic.includes("y"));
    const box = this.box(w, h, y), wide = box.right - box.left, high = box.bottom - box.top;
    if (view.equal) equalise([[x, wide], [y, high]]);
    const { px, py } = this.frame(box, x, y, [view.x, view.y]);
    const inner = shape("svg", { class: "inner", x: box.left, y: box.top, width: wide, height: high, viewBox: `${box.left} ${box.top} ${wide} ${high}` });
    this.svg.append(inner);  // cuts off curves outside of the frame
    for (const level of levels) inner.append(shape("line", { x1: box.left, x2: box.right, y1: py(level), y2: py(level), class: "level" }));
    for (const line of view.lines) {
      if (this.choice && line.design !== undefined && line.design !== this.choice.chosen) continue;
      const colour = line.quiet ? "quiet" : `s${/** @type {number} */ (this.colours.get(line.name)) % 7}`;
      inner.append(...marksOf(line, colour, px, py, this.designs));
    }
    if (this.designs) markDesign(this.svg, this.designs.chosen);
  }
}

/** Make a unit equally long on two axes. @param {[Scale, number][]} axes with their lengths in pixels */
function equalise(axes) {
  const unit = Math.max(...axes.map(([scale, size]) => (scale.hi - scale.lo) / size));
  for (const [scale, size] of axes) {
    const middle = (scale.lo + scale.hi) / 2;
    [scale.lo, scale.hi] = [middle - (unit * size) / 2, middle + (unit * size) / 2];
  }
}

/** @param {Line} line @param {string} colour @param {Map1} px @param {Map1} py @param {Choice | null} choice */
function marksOf({ name, x, y, low, style, open, designs }, colour, px, py, choice) {
  if (style === "band") {
    const back = [...x.keys()].reverse();
    const lower = pathOf(back.map((k) => x[k]), back.map((k) => list(low)[k]), px, py).replace(/^M/, "L");
    return [shape("path", { d: `${pathOf(x, y, px, py)}${lower}Z`, class: `band ${colour}` })];
  }
  if (style !== "dots") return [shape("path", { d: pathOf(x, y, px, py), class: `curve ${style} ${colour}` })];
  const radius = x.length > 60 ? 1.9 : 4, look = `dot ${colour}${open ? " open" : ""}`;
  const selects = (/** @type {number} */ k) => (choice && designs ? { "data-design": designs[k], class: `${look} design`, onclick: () => choice.choose(designs[k]) } : {});
  return [...x.keys()].filter((k) => isNum(x[k]) && isNum(y[k])).map((k) =>
    shape("circle", { cx: px(x[k]), cy: py(y[k]), r: radius, class: look, ...selects(k) }, hint(`${name}: ${tidy(x[k], 5)}, ${tidy(y[k], 5)}`)));
}
