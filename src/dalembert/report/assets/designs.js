// The table of designs of a page: which one is chosen, and the views that share it.

class Choice {
  constructor(designs) {
    this.columns = list(designs.columns).map((c) => ({ name: String(c.name), unit: c.unit || "", role: c.role, values: list(c.values) }));
    this.count = this.columns[0]?.values.length ?? 0;
    this.reasons = list(designs.reasons);
    this.labels = list(designs.labels);
    this.alternatives = list(designs.alternatives);
    this.chosen = clamp(designs.chosen | 0, 0, Math.max(0, this.count - 1));
    this.ranges = new Map();
    this.onChoose = new Signal();
    this.onKeep = new Signal();
    const aim = this.columns.findIndex((c) => c.role === "aim");
    this.order = [...Array(this.count).keys()].filter((k) => !this.reasons[k]);
    this.tones = new Scale(this.columns[Math.max(aim, 0)]?.values ?? [], false, 0);
    this.toned = this.columns[Math.max(aim, 0)];
  }

  title(c) { return c.unit ? `${c.name} [${raised(c.unit)}]` : c.name; }
  label(k) { return this.labels[k] || `design ${k + 1}`; }
  failed(k) { return Boolean(this.reasons[k]); }
  kept(k) { return [...this.ranges].every(([c, [lo, hi]]) => this.columns[c].values[k] >= lo && this.columns[c].values[k] <= hi); }
  told(k) { return `${this.label(k)}: ${this.columns.map((c) => `${c.name} ${withUnit(tidy(c.values[k], 5), c.unit)}`).join(", ")}`; }

  choose(k) {
    if (k === this.chosen || k < 0 || k >= this.count) return;
    this.chosen = k;
    this.onChoose.emit(k);
  }

  // The next design that is kept, in the order of the table.
  step(by) {
    const kept = this.order.filter((k) => this.kept(k));
    if (!kept.length) return;
    const at = kept.indexOf(this.chosen);
    this.choose(kept[at < 0 ? 0 : clamp(at + by, 0, kept.length - 1)]);
  }

  limit(column, range) {
    if (range) this.ranges.set(column, range); else this.ranges.delete(column);
    this.onKeep.emit();
  }

  // Blue where the first aim is least, over green to orange where it is largest.
  tone(k) {
    const share = clamp(this.tones.share(this.toned.values[k]), 0, 1), stops = PALETTE[Theme.name === "dark" ? "dark" : "light"];
    if (!isNum(share)) return "var(--muted)";
    return share < 0.5 ? mix(stops[0], stops[2], 2 * share) : mix(stops[2], stops[1], 2 * share - 1);
  }

  // Arrows choose, wherever the focus is in a view of designs.
  bind(node, title) {
    node.setAttribute("tabindex", "0");
    node.setAttribute("role", "group");
    node.setAttribute("aria-label", `${title}. Arrow keys select a design.`);
    node.addEventListener("keydown", (e) => {
      const by = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1, Home: -this.count, End: this.count }[e.key];
      if (!by || e.ctrlKey || e.metaKey || e.altKey) return;
      e.preventDefault();
      e.stopPropagation();
      this.step(by);
    });
  }
}

// What all views of designs share: they are drawn anew, or marked, where another design is chosen.
class DesignChart extends Chart {
  constructor(view, choice, height) {
    super(view, height);
    this.choice = choice;
    this.keys([]);
    choice.bind(this.svg, view.title);
    choice.onChoose.on(() => this.mark());
    choice.onKeep.on(() => this.redraw());
    Theme.listeners.on(() => this.redraw());
  }

  redraw() {
    super.redraw();
    if (this.width) this.mark();
  }

  mark() {
    for (const old of this.svg.querySelectorAll(".chosen")) old.classList.remove("chosen");
    for (const node of this.svg.querySelectorAll(`[data-design="${this.choice.chosen}"]`)) {
      node.classList.add("chosen");
      node.parentNode.append(node);  // over the others
    }
  }

  dot(k, x, y, radius) {
    const { choice } = this, name = `design${choice.kept(k) ? "" : " left"}`;
    const dot = shape("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: radius, class: name, "data-design": k, onclick: () => choice.choose(k) }, hint(choice.told(k)));
    dot.style.fill = choice.tone(k);
    return dot;
  }
}

// Two columns against each other; a front is joined by a line.
class FrontChart extends DesignChart {
  constructor(view, choice) {
    super(view, choice, 290);
    [this.x, this.y] = [view.x ?? 0, view.y ?? 1];
    if (!view.choose && choice.columns.filter((c) => c.role === "aim").length <= 2) return;
    const pick = (key) => el("select", { "aria-label": `${key} axis`, onchange: (e) => { this[key] = +e.target.value; this.redraw(); } }, choice.columns.map((c, k) => el("option", { value: String(k), selected: k === this[key] }, c.name)));
    this.node.prepend(el("div", { class: "axes" }, pick("y"), el("span", { class: "caption" }, "over"), pick("x")));
  }

  draw(w, h) {
    const { choice } = this, [a, b] = [choice.columns[this.x], choice.columns[this.y] ?? choice.columns[this.x]];
    const x = new Scale(a.values, false, 0.09), y = new Scale(b.values, false, 0.09);
    const { px, py } = this.frame(this.box(w, h, y), x, y, [choice.title(a), choice.title(b)]);
    if (this.view.better && choice.columns.filter((c) => c.role === "aim").length === 2) {
      const order = [...a.values.keys()].sort((p, q) => a.values[p] - a.values[q]);
      this.svg.append(shape("path", { d: points(order.map((k) => a.values[k]), order.map((k) => b.values[k]), px, py), class: "curve quiet" }));
    }
    const dots = shape("g", {});
    for (const k of choice.order) if (isNum(a.values[k]) && isNum(b.values[k])) dots.append(this.dot(k, px(a.values[k]), py(b.values[k]), choice.count > 200 ? 3 : 6));
    this.svg.append(dots);
  }
}

// All columns side by side, a line for each design; dragging along an axis keeps a range of it.
class ParallelChart extends DesignChart {
  constructor(view, choice) { super(view, choice, 290); }

  draw(w, h) {
    const { choice } = this, columns = choice.columns, left = 30, right = w - 30, top = 62, bottom = h - 32;
    const at = (c) => (columns.length > 1 ? left + (c / (columns.length - 1)) * (right - left) : w / 2);
    const scales = columns.map((c) => new Scale(choice.order.map((k) => c.values[k]), false, 0));
    const many = (right - left) / Math.max(1, columns.length - 1) < 74;
    const y = (c, v) => bottom - scales[c].share(v) * (bottom - top);
    const lines = shape("g", { class: "lines" });
    for (const k of choice.order) {
      const d = columns.map((c, i) => (isNum(c.values[k]) ? `${i ? "L" : "M"}${at(i).toFixed(1)} ${y(i, c.values[k]).toFixed(1)}` : "")).join("").replace(/^L/, "M");
      const line = shape("path", { d, class: `design${choice.kept(k) ? "" : " left"}`, "data-design": k, onclick: () => choice.choose(k) }, hint(choice.told(k)));
      line.style.stroke = choice.tone(k);
      line.style.strokeOpacity = choice.count > 100 ? 0.35 : 0.75;
      lines.append(line);
    }
    this.svg.append(lines);
    const room = Math.max(4, Math.floor(((right - left) / Math.max(1, columns.length - 1)) / 6.6));
    columns.forEach((c, i) => {
      const ends = [scales[i].hi, scales[i].lo], anchor = i === 0 ? "start" : i === columns.length - 1 ? "end" : "middle", tx = i === 0 ? 4 : i === columns.length - 1 ? w - 4 : at(i);
      const axis = shape("g", { class: `axis ${c.role}` }, shape("line", { x1: at(i), x2: at(i), y1: top, y2: bottom }),
        written(tx, many && i % 2 ? 28 : 14, clipped(c.name, many ? 2 * room - 2 : room + 3), { "text-anchor": anchor, class: "label" }, hint(c.name)),
        written(tx, many && i % 2 ? 42 : 28, c.unit ? clipped(`[${c.unit}]`, room) : "", { "text-anchor": anchor, class: "value" }),
        written(tx, bottom + (many && i % 2 ? 26 : 14), `${tidy(ends[1], 3)}`, { class: "value", "text-anchor": anchor }, hint(`from ${tidy(ends[1], 5)} to ${tidy(ends[0], 5)}`)),
        written(tx, top - 6, tidy(ends[0], 3), { class: "value", "text-anchor": anchor }));
      const range = choice.ranges.get(i);
      if (range) axis.append(shape("rect", { x: at(i) - 7, width: 14, y: y(i, range[1]), height: Math.max(2, y(i, range[0]) - y(i, range[1])), rx: 3, class: "range" }));
      axis.append(this.handle(i, at(i), top, bottom, scales[i]));
      this.svg.append(axis);
    });
  }

  handle(i, x, top, bottom, scale) {
    const value = (e) => { const box = this.svg.getBoundingClientRect(); return scale.value(clamp((bottom - (e.clientY - box.top)) / (bottom - top), 0, 1)); };
    let begun = null;
    const grip = shape("rect", { x: x - 10, y: top - 4, width: 20, height: bottom - top + 8, class: "grip" }, hint("Drag to select a range; double-click to clear it"));
    let last = null;
    const keep = () => {
      const [lo, hi] = [Math.min(begun, last), Math.max(begun, last)];
      last = null;
      if (scale.share(hi) - scale.share(lo) > 0.02) this.choice.limit(i, [lo, hi]);
    };
    const move = (e) => {
      if (last === null) requestAnimationFrame(keep);  // once for each picture
      last = value(e);
    };
    const end = () => { removeEventListener("pointermove", move); removeEventListener("pointerup", end); };
    grip.addEventListener("pointerdown", (e) => {
      begun = value(e);
      addEventListener("pointermove", move);
      addEventListener("pointerup", end);
    });
    grip.addEventListener("dblclick", () => this.choice.limit(i, null));
    return grip;
  }
}

const MOST_DOTS = 12000;

// Every column over every other; of very many designs some are left out, evenly.
class MatrixChart extends DesignChart {
  constructor(view, choice) { super(view, choice, 420); }

  draw(w) {
    const { choice } = this, columns = choice.columns.filter((c) => !this.view.role || c.role === this.view.role), n = columns.length, left = 16, gap = 5;
    const wide = (w - left - 4) / n, high = Math.min(wide, 128);
    this.height = Math.round(high * n + 12);
    this.svg.setAttribute("height", this.height);
    this.svg.setAttribute("viewBox", `0 0 ${w} ${this.height}`);
    const scales = columns.map((c) => new Scale(choice.order.map((k) => c.values[k]), false, 0.08)), dots = shape("g", {});
    const stride = Math.ceil((choice.order.length * n * (n - 1)) / MOST_DOTS), some = choice.order.filter((k, row) => row % stride === 0 || k === choice.chosen);
    const ends = columns.map((c) => extent([choice.order.map((k) => c.values[k])]) ?? [NaN, NaN]);
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) {
      const x0 = left + j * wide + gap / 2, y0 = 4 + i * high + gap / 2, [size, tall] = [wide - gap, high - gap];
      this.svg.append(shape("rect", { x: x0, y: y0, width: size, height: tall, class: i === j ? "edge names" : "edge" }));
      if (i === j) {
        this.svg.append(written(x0 + size / 2, y0 + tall / 2, clipped(columns[i].name, Math.floor(size / 7)), { "text-anchor": "middle", class: "label" }),
          written(x0 + size / 2, y0 + tall / 2 + 16, columns[i].unit ? `[${columns[i].unit}]` : "", { "text-anchor": "middle", class: "value" }),
          ...(size < 60 ? [] : [written(x0 + 4, y0 + tall - 5, tidy(ends[i][0], 3), { class: "value" }), written(x0 + size - 4, y0 + 13, tidy(ends[i][1], 3), { class: "value", "text-anchor": "end" })]));
        continue;
      }
      for (const k of some) {
        const [p, q] = [columns[j].values[k], columns[i].values[k]];
        if (isNum(p) && isNum(q)) dots.append(this.dot(k, x0 + scales[j].share(p) * size, y0 + tall - scales[i].share(q) * tall, choice.count > 200 ? 1.6 : 2.8));
      }
    }
    this.svg.append(dots);
  }
}

const SHOWN_DESIGNS = 400;

// The numbers, a row for each design; a click on a heading sorts.
class DesignTable {
  constructor(view, choice) {
    Object.assign(this, { view, choice, by: null, down: false });
    this.head = el("tr", {});
    this.body = el("tbody", {});
    const box = el("div", { class: "scroll" }, el("table", { class: "figures designs" }, el("thead", {}, this.head), this.body));
    this.box = box;
    this.note = el("p", { class: "caption note" });
    this.node = el("div", {}, box, this.note);
    choice.bind(box, view.title);
    choice.onChoose.on(() => this.mark());
    choice.onKeep.on(() => this.fill());
    this.fill();
  }

  fill() {
    const { choice } = this, text = (k) => (choice.failed(k) ? choice.reasons[k] : "");
    this.head.replaceChildren(el("th", { scope: "col" }, "Design"), ...choice.columns.map((c, i) => {
      const mark = this.by === i ? (this.down ? " ↓" : " ↑") : "";
      return el("th", { scope: "col", class: "right", "aria-sort": this.by === i ? (this.down ? "descending" : "ascending") : "none" },
        el("button", { type: "button", class: "sort", onclick: () => { this.down = this.by === i && !this.down; this.by = i; this.fill(); } }, choice.title(c) + mark));
    }));
    let rows = [...Array(choice.count).keys()];
    if (this.by !== null) {
      const sign = this.down ? -1 : 1, at = (k) => choice.columns[this.by].values[k];
      rows.sort((p, q) => (isNum(at(p)) ? (isNum(at(q)) ? sign * (at(p) - at(q)) : -1) : 1));
    }
    choice.order = rows.filter((k) => !choice.failed(k));
    rows = rows.filter((k) => choice.kept(k) || choice.failed(k));
    this.note.textContent = rows.length > SHOWN_DESIGNS ? `${SHOWN_DESIGNS} of ${rows.length} designs; sort or select a range to see others.` : "";
    rows = rows.slice(0, SHOWN_DESIGNS);
    this.body.replaceChildren(...rows.map((k) => el("tr", { "data-design": String(k), class: choice.failed(k) ? "failed" : "pickable", title: text(k), onclick: () => choice.choose(k) },
      el("th", { scope: "row" }, choice.label(k)), choice.columns.map((c) => el("td", { class: `right ${c.role}` }, isNum(c.values[k]) ? tidy(c.values[k], 5) : "–")))));
    this.mark();
  }

  mark() {
    for (const row of this.body.children) {
      const on = +row.dataset.design === this.choice.chosen;
      row.classList.toggle("chosen", on);
      if (on) row.setAttribute("aria-current", "true"); else row.removeAttribute("aria-current");
      if (on && this.moved) this.box.scrollTop = clamp(this.box.scrollTop, row.offsetTop + row.offsetHeight - this.box.clientHeight + 4, row.offsetTop - 34);
    }
    this.moved = true;
  }
}

// The design that is chosen, in words and numbers.
function chosenCard(choice) {
  const title = el("h2", {}), aims = el("dl", { class: "aims" }), rest = el("dl", { class: "pairs" });
  const cells = (role) => choice.columns.filter((c) => c.role === role).map((c) => el("div", {}, el("dt", {}, c.name), el("dd", {}, withUnit(tidy(c.values[choice.chosen], 6), c.unit))));
  const fill = () => {
    title.textContent = clipped(choice.label(choice.chosen), 60).replace(/^./, (c) => c.toUpperCase());
    aims.replaceChildren(...cells("aim"));
    rest.replaceChildren(...cells("parameter"));
  };
  fill();
  choice.onChoose.on(fill);
  return el("section", { class: "card panel chosen-design", "aria-live": "polite", "aria-label": "Selected design" },
    el("div", { class: "plot-head" }, title, el("div", { class: "plot-tools" },
      iconButton("back", "Previous design", () => choice.step(-1), { id: "previous-design" }), iconButton("next", "Next design", () => choice.step(1), { id: "next-design" }))), aims, rest);
}

// What of the page is that of the design chosen; the address may name it.
function other(designs) {
  if (!designs || !list(designs.alternatives).length) return null;
  const asked = /^#design=(\d+)$/.exec(location.hash);
  const last = list(designs.alternatives).length - 1;
  if (asked) designs.chosen = clamp(+asked[1], 0, last);
  return designs.alternatives[designs.chosen] ?? null;
}
