// Cards of a decision: each view of the payload in one.

const begun = payload.designs ? other(payload.designs) : null;
const choosing = payload.designs ? new Choice(payload.designs) : null;

function rowsTable(view) {
  return el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": view.title }, el("table", { class: "figures" },
    el("thead", {}, el("tr", {}, ["", ...view.heads, ""].map((t, k) => el("th", { scope: "col", class: k && k <= view.heads.length ? "right" : "" }, t)))),
    el("tbody", {}, view.rows.map((row) => el("tr", {}, el("th", { scope: "row" }, row.name), row.cells.map((v) => el("td", { class: "right" }, tidy(v, 6))), el("td", { class: "unit" }, raised(row.unit || "")))))));
}

const VIEWS = {
  facts: (view) => pairs(view.items),
  rows: rowsTable,
  notes: (view) => el("ul", { class: "messages" }, view.texts.map((text) => el("li", { class: "warning" }, el("span", {}, text)))),
  bars: (view) => new BarsChart(view).node,
  histogram: (view) => new HistogramChart(view).node,
  curves: (view) => new CurvesChart(view, choosing).node,
  ellipses: (view) => new EllipsesChart(view).node,
  front: (view) => new FrontChart(view, choosing).node,
  parallel: (view) => new ParallelChart(view, choosing).node,
  matrix: (view) => new MatrixChart(view, choosing).node,
  table: (view) => new DesignTable(view, choosing).node,
};

const TONED = ["front", "parallel", "matrix"];

function viewPanel(view, k) {
  const make = VIEWS[view.kind];
  if (!make || (["front", "parallel", "matrix", "table"].includes(view.kind) && !choosing?.count)) return null;
  const toned = TONED.includes(view.kind) && el("span", { class: "tones" }, el("span", {}, tidy(choosing.tones.lo, 3)), el("i", {}), el("span", {}, tidy(choosing.tones.hi, 3)), el("span", { class: "name" }, choosing.title(choosing.toned)));
  const node = panel(view.title, `view-${k}`, make(view), toned, view.note && el("p", { class: "caption note" }, view.note));
  if (view.wide) node.classList.add("wide");
  return node;
}

// Those beside the drawing, and those below it.
function viewPanels(beside) {
  const made = list(payload.views).map((view, k) => ((view.place === "board") === beside ? viewPanel(view, k) : null)).filter(Boolean);
  if (beside && choosing?.count) made.unshift(chosenCard(choosing));
  return made;
}

// How the decision ended, at the head of the page.
function decisionVerdict(node) {
  const told = payload.verdict;
  if (!told) return;
  node.replaceChildren(el("i", { class: "dot" }), el("span", {}, raised(told.text)));
  node.classList.remove("warning", "error");
  if (!told.success) node.classList.add("warning");
  node.removeAttribute("href");
  node.hidden = false;
}
