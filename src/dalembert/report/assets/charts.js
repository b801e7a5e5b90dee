// Charts: axes, marks, and what all of them share. They are drawn anew in the size of their card.

function shape(tag, props = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else node.setAttribute(key, value);
  }
  node.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return node;
}

const written = (x, y, text, props = {}, ...more) => shape("text", { x, y, ...props }, text, more);
const hint = (text) => shape("title", {}, text);
const clipped = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}…` : text);

// Numbers at an axis, from the numbers that stand along it.
class Scale {
  constructor(values, logarithmic = false, pad = 0.06) {
    const good = values.filter((v) => isNum(v) && (!logarithmic || v > 0));
    this.log = logarithmic;
    const [lo, hi] = (extent([good]) || [0, 1]).map((v) => this.along(v));
    const gap = hi > lo ? pad * (hi - lo) : this.log ? 0.5 : 0.1 * Math.abs(lo) || 1;
    [this.lo, this.hi] = [lo - gap, hi + gap];
  }

  along(v) { return this.log ? Math.log10(v) : v; }
  share(v) { return (this.along(v) - this.lo) / (this.hi - this.lo); }
  value(share) { const v = this.lo + share * (this.hi - this.lo); return this.log ? 10 ** v : v; }

  marks(count) {
    if (this.log) {
      const first = Math.ceil(this.lo - 1e-9), last = Math.floor(this.hi + 1e-9), step = Math.max(1, Math.ceil((last - first + 1) / count));
      const powers = Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => first + k).filter((k) => (k - first) % step === 0);
      return powers.map((k) => ({ value: 10 ** k, text: Math.abs(k) < 4 ? minus(String(10 ** k)) : `10${superscript(k)}` }));
    }
    const { step, values } = ticks(this.lo, this.hi, count);
    const size = Math.max(Math.abs(this.lo), Math.abs(this.hi));
    const power = size >= 1e5 || size < 1e-4 ? 3 * Math.floor(Math.log10(size) / 3) : 0;
    const decimals = decimalsOf(step / 10 ** power);
    const unit = power ? `·10${superscript(power)}` : "";
    return values.map((v, k) => ({ value: v, text: fixed(v / 10 ** power, decimals) + (k === values.length - 1 ? unit : "") }));
  }
}

// A card with one drawing, which is drawn anew where its size changes.
class Chart {
  constructor(view, height) {
    this.view = view;
    this.height = height;
    this.svg = shape("svg", { class: "chart", role: "img", "aria-label": view.title, height });
    this.legend = el("div", { class: "legend" });
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
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.svg.replaceChildren();
    this.draw(this.width, this.height);
  }

  // Grid, numbers and names of two axes; returns where numbers lie.
  frame(box, x, y, names, { across, up } = {}) {
    const { left, top, right, bottom } = box;
    const px = (v) => left + x.share(v) * (right - left), py = (v) => bottom - y.share(v) * (bottom - top);
    const grid = shape("g", { class: "grid" }), texts = shape("g", { class: "numbers" });
    for (const { value, text } of x.marks(across ?? Math.max(2, (right - left) / 80))) {
      grid.append(shape("line", { x1: px(value), x2: px(value), y1: top, y2: bottom }));
      texts.append(written(px(value), bottom + 16, text, { "text-anchor": "middle" }));
    }
    for (const { value, text } of y.marks(up ?? Math.max(2, (bottom - top) / 42))) {
      grid.append(shape("line", { x1: left, x2: right, y1: py(value), y2: py(value) }));
      texts.append(written(left - 7, py(value) + 4, text, { "text-anchor": "end" }));
    }
    texts.append(written((left + right) / 2, bottom + 33, names[0], { "text-anchor": "middle", class: "name" }));
    texts.append(written(0, 0, names[1], { "text-anchor": "middle", class: "name", transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)` }));
    this.svg.append(grid, shape("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "edge" }), texts);
    return { px, py };
  }

  // The room for a drawing with these numbers at its left.
  box(w, h, y) {
    const longest = Math.max(2, ...y.marks((h - 52) / 42).map(({ text }) => text.length));
    return { left: 34 + 6.6 * longest, top: 10, right: w - 12, bottom: h - 42 };
  }

  keys(rows) {
    this.legend.replaceChildren(...rows.map(({ name, look }) => el("span", { class: "key" }, el("i", { class: `sample ${look}` }), el("span", { class: "name", title: name }, name))));
    this.legend.hidden = rows.length < 2;
  }
}

const points = (xs, ys, px, py) => {
  const parts = [];
  let on = false;
  xs.forEach((x, k) => {
    const y = ys[k];
    if (!isNum(x) || !isNum(y)) { on = false; return; }
    const [u, v] = [px(x), py(y)];
    if (!Number.isFinite(u) || !Number.isFinite(v)) { on = false; return; }
    parts.push(`${on ? "L" : "M"}${u.toFixed(1)} ${v.toFixed(1)}`);
    on = true;
  });
  return parts.join("");
};

// Curves, dots and bands over one axis; those of a design only where it is chosen.
class CurvesChart extends Chart {
  constructor(view, choice) {
    super(view, view.equal ? 340 : 230);
    this.choice = view.follows ? choice : null;
    this.choice?.onChoose.on(() => this.redraw());
    const seen = new Map();
    view.lines.forEach((line) => { if (!seen.has(line.name) && !line.quiet) seen.set(line.name, seen.size); });
    this.colours = seen;
    this.keys([...seen].map(([name, k]) => ({ name, look: `s${k % 7} ${view.lines.find((l) => l.name === name).style}` })));
  }

  draw(w, h) {
    const { view } = this, log = view.logarithmic || "";
    const lines = view.lines.filter((l) => !this.choice || l.design === undefined || l.design === this.choice.chosen);
    const all = (key) => view.lines.flatMap((l) => (l.quiet && !view.equal ? [] : [...list(l[key]), ...(key === "y" ? list(l.low) : [])]));
    const x = new Scale(all("x"), log.includes("x")), y = new Scale([...all("y"), ...list(view.levels)], log.includes("y"));
    const box = this.box(w, h, y);
    if (view.equal) {
      const unit = Math.max((x.hi - x.lo) / (box.right - box.left), (y.hi - y.lo) / (box.bottom - box.top));
      for (const [scale, size] of [[x, box.right - box.left], [y, box.bottom - box.top]]) {
        const middle = (scale.lo + scale.hi) / 2;
        [scale.lo, scale.hi] = [middle - (unit * size) / 2, middle + (unit * size) / 2];
      }
    }
    const { px, py } = this.frame(box, x, y, [view.x, view.y]);
    const wide = box.right - box.left, high = box.bottom - box.top;  // what lies outside of it is cut off
    const inner = shape("svg", { class: "inner", x: box.left, y: box.top, width: wide, height: high, viewBox: `${box.left} ${box.top} ${wide} ${high}` });
    this.svg.append(inner);
    for (const level of list(view.levels)) inner.append(shape("line", { x1: box.left, x2: box.right, y1: py(level), y2: py(level), class: "level" }));
    for (const line of lines) {
      const look = line.quiet ? "quiet" : `s${this.colours.get(line.name) % 7}`;
      if (line.style === "band") {
        const back = [...line.x.keys()].reverse();
        inner.append(shape("path", { d: `${points(line.x, line.y, px, py)}${points(back.map((k) => line.x[k]), back.map((k) => line.low[k]), px, py).replace(/^M/, "L")}Z`, class: `band ${look}` }));
      } else if (line.style === "dots") {
        const small = line.x.length > 60 ? 1.9 : 4;
        line.x.forEach((v, k) => { if (isNum(v) && isNum(line.y[k])) inner.append(shape("circle", { cx: px(v), cy: py(line.y[k]), r: small, class: `dot ${look}${line.open ? " open" : ""}` }, hint(`${line.name}: ${tidy(v, 5)}, ${tidy(line.y[k], 5)}`))); });
      } else inner.append(shape("path", { d: points(line.x, line.y, px, py), class: `curve ${line.style} ${look}` }));
    }
  }
}

// A bar for each name, about zero where some are negative; long names stand over their bars.
class BarsChart extends Chart {
  constructor(view) {
    const stacked = view.rows.some((r) => r.name.length > 26), row = stacked ? 42 : 27;
    super(view, 16 + row * Math.max(1, view.rows.length));
    Object.assign(this, { stacked, row });
    this.keys([]);
  }

  text(row) {
    const { share, unit } = this.view;
    return !isNum(row.value) ? "–" : share ? `${number(100 * row.value, 3)} %` : withUnit(tidy(row.value, 4), unit);
  }

  draw(w) {
    const { rows } = this.view, values = rows.map((r) => (isNum(r.value) ? r.value : 0)), size = (text) => 12 + 6.6 * text.length;
    const names = this.stacked ? 6 : Math.min(0.42 * w, Math.max(...rows.map((r) => size(r.name))));
    const room = Math.max(...rows.map((r) => size(this.text(r))));
    const lo = Math.min(0, ...values), hi = Math.max(0, ...values), span = hi - lo || 1;
    const left = names + (lo < 0 ? room : 4), right = w - (hi > 0 || lo === 0 ? room : 8), x = (v) => left + ((v - lo) / span) * Math.max(30, right - left);
    rows.forEach((row, k) => {
      const top = 8 + this.row * k, y = top + (this.stacked ? 17 : 3), v = values[k], text = this.text(row);
      const name = this.stacked ? written(2, top + 11, clipped(row.name, Math.floor(w / 6.2)), { class: "label" }, hint(row.name)) : written(names - 8, y + 12, clipped(row.name, Math.floor(names / 6.4)), { "text-anchor": "end", class: "label" });
      this.svg.append(name,
        shape("rect", { x: Math.min(x(0), x(v)), y, width: Math.max(1.5, Math.abs(x(v) - x(0))), height: 17, rx: 3, class: v < 0 ? "less" : "more" }, hint(`${row.name}: ${text}`)),
        written(v < 0 ? x(v) - 6 : x(v) + 6, y + 13, text, { "text-anchor": v < 0 ? "end" : "start", class: "value" }));
    });
    this.svg.prepend(shape("line", { x1: x(0), x2: x(0), y1: this.stacked ? 22 : 4, y2: this.height - 6, class: "zero" }));
  }
}

// How often which values occur, a normal density over it, and marks.
class HistogramChart extends Chart {
  constructor(view) {
    super(view, 240);
    this.keys([]);
  }

  draw(w, h) {
    const { counts, edges, marks, normal, label, size } = this.view;
    const bell = normal && normal[1] > 0 ? Array.from({ length: 121 }, (_, k) => normal[0] + normal[1] * (k / 15 - 4)) : [];
    const density = (v) => Math.exp(-0.5 * ((v - normal[0]) / normal[1]) ** 2) / normal[1] / Math.sqrt(TAU);
    const heights = list(counts).map((c, k) => c / size / (edges[k + 1] - edges[k]));
    const x = new Scale([...list(edges), ...list(marks).map((m) => m.value), ...bell]), y = new Scale([0, ...heights, ...(bell.length ? [density(normal[0])] : [])], false, 0);
    y.hi *= 1.06;
    const box = { ...this.box(w, h, y), top: 26 };
    const { px, py } = this.frame(box, x, y, [label, "density"], { up: 3 });
    heights.forEach((v, k) => this.svg.append(shape("rect", { x: px(edges[k]) + 0.5, y: py(v), width: Math.max(1, px(edges[k + 1]) - px(edges[k]) - 1), height: py(0) - py(v), class: "column" }, hint(`${tidy(edges[k], 5)} … ${tidy(edges[k + 1], 5)}: ${counts[k]}`))));
    if (bell.length) this.svg.append(shape("path", { d: points(bell, bell.map(density), px, py), class: "curve s1" }));
    let last = -Infinity;
    for (const mark of [...list(marks)].sort((a, b) => a.value - b.value)) {
      const at = px(mark.value), low = at - last < 62;
      this.svg.append(shape("line", { x1: at, x2: at, y1: low ? box.top - 2 : box.top - 8, y2: box.bottom, class: "level" }, hint(`${mark.name}: ${tidy(mark.value, 6)}`)),
        written(clamp(at, 30, w - 34), low ? box.top - 14 : box.top - 12, mark.name, { "text-anchor": low ? "start" : "middle", class: "value" }));
      last = at;
    }
  }
}

// One ellipse for each pair of unknowns: 68 % and 95 % of two normal variables.
class EllipsesChart extends Chart {
  constructor(view) {
    super(view, 300);
    this.keys([]);
  }

  draw(w) {
    const { names, units, centre, covariance } = this.view, n = names.length, foot = 46;
    const told = (k) => withUnit(tidy(centre[k], 4), units[k]);
    const left = clamp(14 + 6.6 * Math.max(...names.slice(1).map((_, k) => told(k + 1).length)), 74, w / 2);
    const side = Math.min((w - left - 8) / Math.max(1, n - 1), 190);
    this.height = Math.round(side * (n - 1) + foot + 6);
    this.svg.setAttribute("height", this.height);
    this.svg.setAttribute("viewBox", `0 0 ${w} ${this.height}`);
    const reach = (k) => 2.75 * Math.sqrt(covariance[k][k]) || 1;
    for (let i = 1; i < n; i++) for (let j = 0; j < i; j++) {
      const [x0, y0] = [left + j * side, 4 + (i - 1) * side], pad = 5, inner = side - 2 * pad;
      const at = (p, q) => [x0 + pad + inner * (0.5 + p / (2 * reach(j))), y0 + pad + inner * (0.5 - q / (2 * reach(i)))];
      const box = shape("g", {}, shape("rect", { x: x0 + pad, y: y0 + pad, width: inner, height: inner, class: "edge" }), hint(`${names[j]} and ${names[i]}: correlation ${tidy(covariance[i][j] / Math.sqrt(covariance[i][i] * covariance[j][j]), 3)}`));
      const [a, b, c] = [Math.sqrt(covariance[j][j]), covariance[i][j] / (Math.sqrt(covariance[j][j]) || 1), 0];
      const d = Math.sqrt(Math.max(c, covariance[i][i] - b * b));
      for (const [size, name] of [[2.4477, "band s0"], [1.5096, "band s0"]]) {
        const ring = Array.from({ length: 61 }, (_, k) => { const t = (k / 60) * TAU; return at(size * a * Math.cos(t), size * (b * Math.cos(t) + d * Math.sin(t))); });
        box.append(shape("path", { d: `M${ring.map((p) => p.map((v) => v.toFixed(1)).join(" ")).join("L")}Z`, class: name }));
      }
      const [cx, cy] = at(0, 0);
      box.append(shape("circle", { cx, cy, r: 2.6, class: "dot s0" }));
      this.svg.append(box);
      if (i === n - 1) this.svg.append(written(x0 + side / 2, y0 + side + 15, names[j], { "text-anchor": "middle", class: "label" }), written(x0 + side / 2, y0 + side + 30, told(j), { "text-anchor": "middle", class: "value" }));
      if (j === 0) this.svg.append(written(left - 6, y0 + side / 2 - 2, clipped(names[i], 11), { "text-anchor": "end", class: "label" }), written(left - 6, y0 + side / 2 + 14, told(i), { "text-anchor": "end", class: "value" }));
    }
  }
}
