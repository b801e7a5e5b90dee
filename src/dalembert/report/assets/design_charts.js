// Charts of a table of designs: front, parallel coordinates, matrix.

/** @import { Choice } from "./choice.js" */
/** @import { DesignView } from "./types.d.ts" */

import { Chart, Scale, clipped, hint, markDesign, pathOf, written } from "./charts.js";
import { el, shape } from "./dom.js";
import { clamp, extent, isNum, tidy } from "./numbers.js";
import { inRows } from "./text_rows.js";
import { Theme } from "./theme.js";

/** Height of a row of texts [px], and fonts of the texts. */
const ROW = 14, NAME_FONT = "650 12px", VALUE_FONT = "11.5px";

/** Chart of designs that follows the selected design, the ranges and the theme. */
class DesignChart extends Chart {
  /** @param {DesignView} view @param {Choice} choice @param {number} height */
  constructor(view, choice, height) {
    super(view, height);
    this.view = view;
    this.choice = choice;
    choice.bind(this.svg, view.title);
    choice.onChoose.on(() => this.mark());
    choice.onRange.on(() => this.redraw());
    Theme.listeners.on(() => this.redraw());
  }

  /** @override */
  redraw() {
    super.redraw();
    if (this.width) this.mark();
  }

  /** Mark the selected design. */
  mark() { markDesign(this.svg, this.choice.chosen); }

  /** @param {number} k */
  attributes(k) {
    return { class: `design${this.choice.inRanges(k) ? "" : " outside"}`, "data-design": k, onclick: () => this.choice.choose(k) };
  }

  /** @param {number} k @param {number} x @param {number} y @param {number} r */
  dot(k, x, y, r) {
    const dot = shape("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r, ...this.attributes(k) }, hint(this.choice.summary(k)));
    dot.style.fill = this.choice.colour(k);
    return dot;
  }
}

/** Two columns against each other; a Pareto front is joined by a line. */
export class FrontChart extends DesignChart {
  /** @param {DesignView} view @param {Choice} choice */
  constructor(view, choice) {
    super(view, choice, 290);
    this.columns = { x: view.x ?? 0, y: view.y ?? 1 };
    if (!view.choose && choice.columns.filter((c) => c.role === "aim").length <= 2) return;
    const chooser = (/** @type {"x" | "y"} */ key) => {
      const options = choice.columns.map((c, k) => el("option", { value: String(k), selected: k === this.columns[key] }, c.name));
      const select = el("select", { "aria-label": `${key} axis`, onchange: () => { this.columns[key] = +select.value; this.redraw(); } }, options);
      return select;
    };
    this.node.prepend(el("div", { class: "axes" }, chooser("y"), el("span", { class: "caption" }, "over"), chooser("x")));
  }

  /** @param {number} w @param {number} h @override */
  draw(w, h) {
    const { choice } = this, a = choice.columns[this.columns.x], b = choice.columns[this.columns.y] ?? a;
    const x = new Scale(a.values, false, 0.09), y = new Scale(b.values, false, 0.09);
    const { px, py } = this.frame(this.box(w, h, y), x, y, [choice.title(a), choice.title(b)]);
    if (this.view.better && choice.columns.filter((c) => c.role === "aim").length === 2) {
      const order = [...a.values.keys()].sort((p, q) => a.values[p] - a.values[q]);
      this.svg.append(shape("path", { d: pathOf(order.map((k) => a.values[k]), order.map((k) => b.values[k]), px, py), class: "curve quiet" }));
    }
    const drawn = choice.order.filter((k) => isNum(a.values[k]) && isNum(b.values[k]));
    this.svg.append(shape("g", {}, drawn.map((k) => this.dot(k, px(a.values[k]), py(b.values[k]), choice.count > 200 ? 3 : 6))));
  }
}

/** All columns side by side, a line for each design; a drag along an axis selects a range. */
export class ParallelChart extends DesignChart {
  /** @param {DesignView} view @param {Choice} choice */
  constructor(view, choice) { super(view, choice, 290); }

  /** @param {number} w @param {number} h @override */
  draw(w, h) {
    const { choice } = this, { columns } = choice, last = columns.length - 1;
    const left = 30, right = w - 30, gap = (right - left) / Math.max(1, last);
    const at = (/** @type {number} */ c) => (last > 0 ? left + c * gap : w / 2);
    const scales = columns.map((c) => new Scale(choice.order.map((k) => c.values[k]), false, 0));
    const places = columns.map((_, c) => at(c)), unit = (/** @type {string} */ text) => (text ? ` [${text}]` : "");
    const names = inRows(places, (c, limit) => clipped(columns[c].name, limit) + unit(columns[c].unit), w, NAME_FONT);
    const [highest, lowest] = [scales.map(({ hi }) => hi), scales.map(({ lo }) => lo)].map((ends) => inRows(places, (c) => tidy(ends[c], 3), w, VALUE_FONT));
    const head = highest.rows * ROW + 6, top = names.rows * ROW + head + 4, bottom = h - lowest.rows * ROW - 6;
    const y = (/** @type {number} */ c, /** @type {number} */ v) => bottom - scales[c].share(v) * (bottom - top);
    this.svg.append(shape("g", { class: "lines" }, choice.order.map((k) => {
      const points = columns.map((c, i) => (isNum(c.values[k]) ? `${at(i).toFixed(1)} ${y(i, c.values[k]).toFixed(1)}` : "")).filter(Boolean);
      const line = shape("path", { d: points.length ? `M${points.join("L")}` : "", ...this.attributes(k) }, hint(choice.summary(k)));
      line.style.stroke = choice.colour(k);
      line.style.strokeOpacity = choice.count > 100 ? "0.35" : "0.75";
      return line;
    })));
    columns.forEach((c, i) => {
      const { lo, hi } = scales[i], range = choice.ranges.get(i), [name, high, low] = [names, highest, lowest].map(({ texts }) => texts[i]);
      const value = { class: "value", "text-anchor": "middle" };
      this.svg.append(shape("g", { class: `axis ${c.role}` }, shape("line", { x1: at(i), x2: at(i), y1: top, y2: bottom }),
        written(name.x, top - head - name.row * ROW, name.text, { "text-anchor": "middle", class: "label" }, hint(choice.title(c))),
        written(low.x, bottom + 14 + low.row * ROW, low.text, value, hint(`from ${tidy(lo, 5)} to ${tidy(hi, 5)}`)),
        written(high.x, top - 6 - high.row * ROW, high.text, value),
        range && shape("rect", { x: at(i) - 7, width: 14, y: y(i, range[1]), height: Math.max(2, y(i, range[0]) - y(i, range[1])), rx: 3, class: "range" }),
        this.handle(i, at(i), top, bottom, scales[i])));
    });
  }

  /** Area that selects a range of a column.
   * @param {number} column @param {number} x @param {number} top @param {number} bottom @param {Scale} scale */
  handle(column, x, top, bottom, scale) {
    let first = NaN, last = NaN, pending = false;
    const value = (/** @type {PointerEvent} */ e) => scale.value(clamp((bottom - (e.clientY - this.svg.getBoundingClientRect().top)) / (bottom - top), 0, 1));
    const select = () => {
      const [lo, hi] = [Math.min(first, last), Math.max(first, last)];
      pending = false;
      if (scale.share(hi) - scale.share(lo) > 0.02) this.choice.limit(column, [lo, hi]);
    };
    const move = (/** @type {PointerEvent} */ e) => {
      last = value(e);
      if (!pending) requestAnimationFrame(select);  // once per frame
      pending = true;
    };
    const end = () => { removeEventListener("pointermove", move); removeEventListener("pointerup", end); };
    const down = (/** @type {PointerEvent} */ e) => {
      first = value(e);
      addEventListener("pointermove", move);
      addEventListener("pointerup", end);
    };
    const attributes = { x: x - 10, y: top - 4, width: 20, height: bottom - top + 8, class: "grip" };
    return shape("rect", { ...attributes, onpointerdown: down, ondblclick: () => this.choice.limit(column, null) }, hint("Drag to select a range; double-click to clear it"));
  }
}

/** Upper limit of the dots of a matrix; surplus designs are omitted evenly. */
const MAX_DOTS = 12000;

/** Each column over each other. */
export class MatrixChart extends DesignChart {
  /** @param {DesignView} view @param {Choice} choice */
  constructor(view, choice) { super(view, choice, 420); }

  /** @param {number} w @override */
  draw(w) {
    const { choice } = this, columns = choice.columns.filter((c) => !this.view.role || c.role === this.view.role), n = columns.length;
    const left = 16, gap = 5, width = (w - left - 4) / n - gap, height = Math.min(width + gap, 128) - gap;
    this.resize((height + gap) * n + 12);
    const scales = columns.map((c) => new Scale(choice.order.map((k) => c.values[k]), false, 0.08)), dots = shape("g", {});
    const stride = Math.ceil((choice.order.length * n * (n - 1)) / MAX_DOTS);
    const drawn = choice.order.filter((k, row) => row % stride === 0 || k === choice.chosen), radius = choice.count > 200 ? 1.6 : 2.8;
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) {
      const x = left + j * (width + gap) + gap / 2, y = 4 + i * (height + gap) + gap / 2;
      this.svg.append(shape("rect", { x, y, width, height, class: i === j ? "edge names" : "edge" }));
      if (i === j) this.svg.append(...this.names(i, columns, x, y, width, height));
      else for (const k of drawn) {
        const [p, q] = [columns[j].values[k], columns[i].values[k]];
        if (isNum(p) && isNum(q)) dots.append(this.dot(k, x + scales[j].share(p) * width, y + height - scales[i].share(q) * height, radius));
      }
    }
    this.svg.append(dots);
  }

  /** Name and range of a column in its cell.
   * @param {number} i @param {Choice["columns"]} columns @param {number} x @param {number} y @param {number} width @param {number} height */
  names(i, columns, x, y, width, height) {
    const { name, unit, values } = columns[i], [lo, hi] = extent([this.choice.order.map((k) => values[k])]) ?? [NaN, NaN];
    return [written(x + width / 2, y + height / 2, clipped(name, Math.floor(width / 7)), { "text-anchor": "middle", class: "label" }),
      written(x + width / 2, y + height / 2 + 16, unit ? `[${unit}]` : "", { "text-anchor": "middle", class: "value" }),
      ...(width < 60 ? [] : [written(x + 4, y + height - 5, tidy(lo, 3), { class: "value" }), written(x + width - 4, y + 13, tidy(hi, 3), { class: "value", "text-anchor": "end" })])];
  }
}
