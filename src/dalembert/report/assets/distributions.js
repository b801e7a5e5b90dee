// Charts of shares and random values: bars, histogram, confidence ellipses.

/** @import { BarsView, EllipsesView, HistogramView } from "./types.d.ts" */

import { Chart, Scale, chartKinds, clipped, hint, pathOf, written } from "./charts.js";
import { shape } from "./dom.js";
import { TAU, clamp, isNum, list, number, tidy } from "./numbers.js";
import { withUnit } from "./units.js";

/** A bar for each name, about zero where some are negative; long names stand above their bars. */
class BarsChart extends Chart {
  /** @param {BarsView} view */
  constructor(view) {
    const stacked = view.rows.some((row) => row.name.length > 26), rowHeight = stacked ? 42 : 27;
    super(view, 16 + rowHeight * Math.max(1, view.rows.length));
    this.view = view;
    this.stacked = stacked;
    this.rowHeight = rowHeight;
  }

  /** @param {number} value */
  text(value) {
    const { share, unit } = this.view;
    return !isNum(value) ? "–" : share ? `${number(100 * value, 3)} %` : withUnit(tidy(value, 4), unit);
  }

  /** @param {number} w @override */
  draw(w) {
    const { stacked, view: { rows } } = this, values = rows.map((row) => (isNum(row.value) ? row.value : 0));
    const widest = (/** @type {string[]} */ texts) => 12 + 6.6 * Math.max(...texts.map((text) => text.length));
    const names = stacked ? 6 : Math.min(0.42 * w, widest(rows.map((row) => row.name)));
    const room = widest(rows.map((row) => this.text(row.value)));
    const lo = Math.min(0, ...values), hi = Math.max(0, ...values), span = hi - lo || 1;
    const left = names + (lo < 0 ? room : 4), right = w - (hi > 0 || lo === 0 ? room : 8);
    const x = (/** @type {number} */ v) => left + ((v - lo) / span) * Math.max(30, right - left);
    this.svg.append(shape("line", { x1: x(0), x2: x(0), y1: stacked ? 22 : 4, y2: this.height - 6, class: "zero" }));
    rows.forEach((row, k) => {
      const top = 8 + this.rowHeight * k, y = top + (stacked ? 17 : 3), v = values[k], text = this.text(row.value);
      const name = stacked
        ? written(2, top + 11, clipped(row.name, Math.floor(w / 6.2)), { class: "label" }, hint(row.name))
        : written(names - 8, y + 12, clipped(row.name, Math.floor(names / 6.4)), { "text-anchor": "end", class: "label" });
      const bar = { x: Math.min(x(0), x(v)), y, width: Math.max(1.5, Math.abs(x(v) - x(0))), height: 17, rx: 3, class: v < 0 ? "less" : "more" };
      this.svg.append(name, shape("rect", bar, hint(`${row.name}: ${text}`)),
        written(v < 0 ? x(v) - 6 : x(v) + 6, y + 13, text, { "text-anchor": v < 0 ? "end" : "start", class: "value" }));
    });
  }
}

/** Histogram of values with a normal density and marks. */
class HistogramChart extends Chart {
  /** @param {HistogramView} view */
  constructor(view) {
    super(view, 240);
    this.view = view;
  }

  /** @param {number} w @param {number} h @override */
  draw(w, h) {
    const { counts, edges, marks, normal, label, size } = this.view;
    const [mean, deviation] = normal ?? [0, 0], step = deviation / 15;
    const bell = deviation > 0 ? Array.from({ length: 121 }, (_, k) => mean + step * (k - 60)) : [];
    const density = (/** @type {number} */ v) => Math.exp(-0.5 * ((v - mean) / deviation) ** 2) / deviation / Math.sqrt(TAU);
    const heights = list(counts).map((count, k) => count / size / (edges[k + 1] - edges[k]));
    const x = new Scale([...list(edges), ...list(marks).map((mark) => mark.value), ...bell]);
    const y = new Scale([0, ...heights, ...(bell.length ? [density(mean)] : [])], false, 0);
    y.hi *= 1.06;
    const box = { ...this.box(w, h, y), top: 26 };
    const { px, py } = this.frame(box, x, y, [label, "density"], 3);
    heights.forEach((v, k) => {
      const column = { x: px(edges[k]) + 0.5, y: py(v), width: Math.max(1, px(edges[k + 1]) - px(edges[k]) - 1), height: py(0) - py(v), class: "column" };
      this.svg.append(shape("rect", column, hint(`${tidy(edges[k], 5)} … ${tidy(edges[k + 1], 5)}: ${counts[k]}`)));
    });
    if (bell.length) this.svg.append(shape("path", { d: pathOf(bell, bell.map(density), px, py), class: "curve s1" }));
    let last = -Infinity;
    for (const { name, value } of [...list(marks)].sort((a, b) => a.value - b.value)) {
      const at = px(value), near = at - last < 62;
      this.svg.append(shape("line", { x1: at, x2: at, y1: box.top - (near ? 2 : 8), y2: box.bottom, class: "level" }, hint(`${name}: ${tidy(value, 6)}`)),
        written(clamp(at, 30, w - 34), box.top - (near ? 14 : 12), name, { "text-anchor": near ? "start" : "middle", class: "value" }));
      last = at;
    }
  }
}

/** Radii of the ellipses that contain 95 % and 68 % of two normal variables, in standard deviations. */
const CONFIDENCE_RADII = [2.4477, 1.5096];

/** Confidence ellipses of each pair of unknowns. */
class EllipsesChart extends Chart {
  /** @param {EllipsesView} view */
  constructor(view) {
    super(view, 300);
    this.view = view;
  }

  /** @param {number} w @override */
  draw(w) {
    const { names, units, centre, covariance } = this.view, n = names.length;
    const value = (/** @type {number} */ k) => withUnit(tidy(centre[k], 4), units[k]);
    const left = clamp(14 + 6.6 * Math.max(...names.slice(1).map((_, k) => value(k + 1).length)), 74, w / 2);
    const side = Math.min((w - left - 8) / Math.max(1, n - 1), 190);
    this.resize(side * (n - 1) + 52);
    for (let i = 1; i < n; i++) for (let j = 0; j < i; j++) {
      const x = left + j * side, y = 4 + (i - 1) * side;
      const correlation = covariance[i][j] / Math.sqrt(covariance[i][i] * covariance[j][j]);
      this.svg.append(shape("g", {}, hint(`${names[j]} and ${names[i]}: correlation ${tidy(correlation, 3)}`), pairOf(covariance, i, j, x, y, side)));
      if (i === n - 1) this.svg.append(written(x + side / 2, y + side + 15, names[j], { "text-anchor": "middle", class: "label" }), written(x + side / 2, y + side + 30, value(j), { "text-anchor": "middle", class: "value" }));
      if (j === 0) this.svg.append(written(left - 6, y + side / 2 - 2, clipped(names[i], 11), { "text-anchor": "end", class: "label" }), written(left - 6, y + side / 2 + 14, value(i), { "text-anchor": "end", class: "value" }));
    }
  }
}

/** Ellipses of the unknowns i and j in a square.
 * @param {number[][]} covariance @param {number} i @param {number} j @param {number} x @param {number} y @param {number} side */
function pairOf(covariance, i, j, x, y, side) {
  const pad = 5, inner = side - 2 * pad, reach = (/** @type {number} */ k) => 2.75 * Math.sqrt(covariance[k][k]) || 1;
  const a = Math.sqrt(covariance[j][j]), b = covariance[i][j] / (a || 1), d = Math.sqrt(Math.max(0, covariance[i][i] - b * b));
  const at = (/** @type {number} */ p, /** @type {number} */ q) => [x + pad + inner * (0.5 + p / (2 * reach(j))), y + pad + inner * (0.5 - q / (2 * reach(i)))];
  const rings = CONFIDENCE_RADII.map((radius) => Array.from({ length: 61 }, (_, k) => {
    const [c, s] = [Math.cos((k / 60) * TAU), Math.sin((k / 60) * TAU)];
    return at(radius * a * c, radius * (b * c + d * s)).map((v) => v.toFixed(1)).join(" ");
  }));
  const [cx, cy] = at(0, 0);
  return [shape("rect", { x: x + pad, y: y + pad, width: inner, height: inner, class: "edge" }),
    ...rings.map((ring) => shape("path", { d: `M${ring.join("L")}Z`, class: "band s0" })), shape("circle", { cx, cy, r: 2.6, class: "dot s0" })];
}

chartKinds.bars = (view) => new BarsChart(view).node;
chartKinds.histogram = (view) => new HistogramChart(view).node;
chartKinds.ellipses = (view) => new EllipsesChart(view).node;
