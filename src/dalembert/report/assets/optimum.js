// What an optimisation came to: its objective, limits and prices, the way there.

function optimumPanel(optimum) {
  if (!optimum) return null;
  const unit = optimum.unit ? ` ${optimum.unit}` : "";
  const all = [...list(optimum.variables), ...list(optimum.limits)], priced = all.some((one) => one.active && one.price);
  const rows = all.map((one) => optimumRow(one, optimum.unit, priced, !optimum.success));
  return panel("Optimum", "optimum",
    el("p", { class: "objective" }, el("span", {}, `${optimum.label}: `), el("span", { class: "was" }, `${tidy(optimum.start)}${unit}`), " → ", el("b", {}, `${tidy(optimum.value)}${unit}`)),
    el("ul", { class: "messages" }, el("li", { class: optimum.success ? "info" : "warning" }, el("b", {}, optimum.success ? "Optimal" : "Not optimal"), el("span", {}, String(optimum.message)))),
    el("div", { class: "scroll tall", tabindex: "0", role: "region", "aria-label": "Limits and parameters" }, el("table", {},
      el("thead", {}, el("tr", {}, ["Name", "First", "Best", "Unit", "Range", ...(priced ? ["Costs"] : [])].map((t, k) => el("th", { scope: "col", class: k === 1 || k === 2 ? "right" : "" }, t)))),
      el("tbody", {}, rows))),
    list(optimum.prices).length > 0 && el("ul", { class: "prices" }, list(optimum.prices).map((text) => el("li", {}, String(text)))));
}

// A limit is broken by more than a millionth of its size.
const isBroken = ({ value, lower, upper }) => (isNum(lower) && value < lower - 1e-6 * (Math.abs(lower) || 1)) || (isNum(upper) && value > upper + 1e-6 * (Math.abs(upper) || 1));

function optimumRow(one, unit, priced, failed) {
  const price = one.active && one.price ? `${tidy(one.price, 4)} ${unit || ""}${one.unit ? ` / ${one.unit}` : ""}` : "";
  return el("tr", { class: one.active ? "active" : "" },
    el("th", { scope: "row" }, String(one.name), one.active ? el("i", { class: "at", title: `at its ${one.active} bound` }, one.active === "lower" ? " ▼" : " ▲") : null,
      failed && isBroken(one) ? el("i", { class: "at broken", title: "violates its limit" }, " ✗") : null),
    el("td", { class: "right was" }, tidy(one.start)), el("td", { class: "right" }, tidy(one.value)),
    el("td", { class: "unit" }, one.unit ? raised(one.unit) : "–"), el("td", {}, designBar(one)), priced ? el("td", { class: "unit" }, price) : null);
}

// Where the first and the best value lie between the bounds; one open side is told in words.
function designBar({ start, value, lower, upper }) {
  if (isNum(lower) && isNum(upper) && lower === upper) return `= ${tidy(lower)}`;
  if (!isNum(lower) && !isNum(upper)) return "–";
  if (!isNum(lower)) return `≤ ${tidy(upper)}`;
  if (!isNum(upper)) return `≥ ${tidy(lower)}`;
  const range = rangeBar({ value, lower, upper }), first = el("i", { class: "first" });
  if (range === "–") return range;
  first.style.setProperty("--p", clamp((start - lower) / (upper - lower), 0, 1));
  range.querySelector(".bar").append(first);
  return range;
}

// The objective after every iteration, designs that break limits hollow.
function convergencePanel(optimum) {
  const steps = list(optimum?.history).filter((s) => isNum(s.objective));
  if (steps.length < 2) return null;
  const values = steps.map((s) => s.objective), low = Math.min(...values), high = Math.max(...values);
  const logarithmic = low > 0 && high > 100 * low, scale = (v) => (logarithmic ? Math.log10(v) : v);
  const [w, h, left, right, top, foot] = [460, 210, 64, 12, 14, 30], span = scale(high) - scale(low) || 1;
  const x = (k) => left + (k / (steps.length - 1)) * (w - left - right), y = (v) => top + (1 - (scale(v) - scale(low)) / span) * (h - top - foot);
  const tag = (name, props, text) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(props)) node.setAttribute(key, value);
    if (text !== undefined) node.textContent = text;
    return node;
  };
  const name = `${optimum.label}${optimum.unit ? ` [${optimum.unit}]` : ""}`;
  const svg = tag("svg", { viewBox: `0 0 ${w} ${h}`, class: "convergence", role: "img", "aria-label": `${name} over the iterations` });
  for (const v of [low, logarithmic ? Math.sqrt(low * high) : (low + high) / 2, high]) {
    svg.append(tag("line", { x1: left, x2: w - right, y1: y(v), y2: y(v), class: "grid" }), tag("text", { x: left - 8, y: y(v) + 4, "text-anchor": "end" }, tidy(v, 3)));
  }
  svg.append(tag("text", { x: left, y: h - 8 }, "0"), tag("text", { x: w - right, y: h - 8, "text-anchor": "end" }, `${steps.length - 1} iterations`));
  svg.append(tag("polyline", { points: values.map((v, k) => `${x(k)},${y(v)}`).join(" "), class: "way" }));
  steps.forEach((s, k) => {
    const dot = tag("circle", { cx: x(k), cy: y(s.objective), r: 3.4, class: s.violation > 1e-6 ? "open" : "kept" });
    dot.append(tag("title", {}, `${k}: ${tidy(s.objective)}${s.violation > 1e-6 ? `, limits violated by ${+s.violation.toPrecision(2)}` : ""}`));
    svg.append(dot);
  });
  const broken = steps.some((s) => s.violation > 1e-6) && el("p", { class: "caption" }, "Hollow: a limit is violated.");
  return panel("Convergence", "convergence", el("p", { class: "caption" }, name), svg, broken);
}
