// Tables of a structure's displacements and reactions, sorted by a click on a heading.

const SHOWN_ROWS = 200;
const ON_PAPER = 30;  // as the style of the page says

// Columns of one unit share a prefix, so that their numbers compare: mm, kN.
function prefixes(columns, rows) {
  const found = new Map();
  columns.forEach(({ unit }, k) => {
    if (!unit) return;
    const most = rows.reduce((m, row) => (isNum(row[k]) ? Math.max(m, Math.abs(row[k])) : m), 0);
    found.set(unit, Math.max(found.get(unit) || 0, most));
  });
  return new Map([...found].map(([unit, most]) => [unit, prefixed(most, unit)]));
}

// rows: arrays of cells, a text first, numbers after it; columns: [{name, unit}].
class SortedTable {
  constructor(title, columns) {
    Object.assign(this, { title, columns, rows: [], by: null, down: true });
    this.body = el("tbody", {});
    this.head = el("tr", {});
    this.note = el("p", { class: "caption note" });
    this.paper = el("p", { class: "caption on-paper" });
    this.node = el("div", {}, el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title },
      el("table", { class: "figures" }, el("thead", {}, this.head), this.body)), this.note, this.paper);
    this.units = new Map();
    this.headings();
  }

  headings() {
    this.head.replaceChildren(...this.columns.map(({ name, unit }, k) => {
      const sorted = this.by === k ? (this.down ? "descending" : "ascending") : "none";
      const mark = this.by === k ? (this.down ? " ↓" : " ↑") : "";
      const button = el("button", { type: "button", class: "sort", onclick: () => this.sort(k) }, withUnit(name, unit ? `[${this.units.get(unit)?.unit ?? unit}]` : "") + mark);
      return el("th", { scope: "col", class: k ? "right" : "", "aria-sort": sorted }, button);
    }));
  }

  sort(k) {
    this.down = this.by === k ? !this.down : k > 0;
    this.by = k;
    this.headings();
    this.fill(this.rows);
  }

  // Numbers by their size without sign, so that what is large comes first.
  ordered() {
    if (this.by === null) return this.rows;
    const sign = this.down ? -1 : 1;
    const key = (row) => { const v = row[this.by]; return typeof v === "string" ? v : isNum(v) ? Math.abs(v) : -1; };
    return [...this.rows].sort((a, b) => {
      const [p, q] = [key(a), key(b)];
      return sign * (typeof p === "string" ? p.localeCompare(q, undefined, { numeric: true }) : p - q);
    });
  }

  // A cell in the unit of its column; what only round-off makes is zero.
  cell(value, k) {
    if (!isNum(value)) return "";
    const { factor, most } = this.units.get(this.columns[k].unit) || { factor: 1, most: 0 };
    return number(Math.abs(value) < 1e-10 * most ? 0 : value / factor, 5);
  }

  fill(rows) {
    this.rows = rows;
    this.units = prefixes(this.columns, rows);
    this.headings();
    const shown = this.ordered().slice(0, SHOWN_ROWS);
    this.body.replaceChildren(...shown.map((row) => el("tr", {}, row.map((cell, k) =>
      k ? el("td", { class: "right" }, this.cell(cell, k)) : el("th", { scope: "row" }, cell)))));
    const more = rows.length - shown.length;
    this.note.textContent = more > 0 ? `${SHOWN_ROWS} of ${rows.length} rows; sort by a column to see its largest values` : "";
    this.note.hidden = more <= 0;
    this.paper.textContent = rows.length > ON_PAPER ? `The first ${ON_PAPER} of ${rows.length} rows, in the order of the page` : "";
  }
}

function reactionRows(structure, forces, k) {
  const byNode = new Map();
  for (const r of structure.reactions) {
    if (!byNode.has(r.node)) byNode.set(r.node, [r.node, ...forces.map(() => null)]);
    byNode.get(r.node)[1 + forces.indexOf(r.name)] = list(r.values)[k];
  }
  const place = new Map(structure.nodes.map((name, n) => [name, n]));
  return [...byNode.values()].sort((a, b) => place.get(a[0]) - place.get(b[0]));
}

function structureTables(structure) {
  const displacements = new SortedTable(structure.relative ? "Shape" : "Displacements", [{ name: "node" }, ...structure.directions.map((name) => ({ name, unit: structure.unitOf(name) }))]);
  const forces = ["fx", "fy", "fz", "mx", "my", "mz"].filter((name) => structure.reactions.some((r) => r.name === name));
  const reactions = new SortedTable("Reactions", [{ name: "node" }, ...forces.map((name) => ({ name, unit: name[0] === "m" ? "N m" : "N" }))]);
  const caption = el("span", { class: "count" });
  const refresh = () => {
    const { case: k } = structure.state;
    caption.textContent = structure.cases.length > 1 ? structure.cases[k] : "";
    displacements.fill(structure.nodes.map((name, n) => [name, ...structure.components(n).map((c) => (c ? c.value : null))]));
    const rows = reactionRows(structure, forces, k);
    reactions.fill(rows);
    const most = Math.max(0, ...rows.flatMap((row) => row.slice(1)).filter(isNum).map(Math.abs));
    const sums = forces.filter((name) => name[0] === "f").map((name) => {
      const sum = rows.reduce((s, row) => s + (row[1 + forces.indexOf(name)] || 0), 0);
      return `${name} ${quantity(Math.abs(sum) < 1e-10 * most ? 0 : sum, "N")}`;
    });
    elements.fill(structure.elements.map((name, k) => [name, ...measured.map((f) => structure.valueOf(f, k))]));
    total.textContent = `sum: ${sums.join(", ")}`;
  };
  const total = el("p", { class: "caption note" });
  const measured = structure.fields.filter((f) => !f.atVertices);
  const elements = new SortedTable("Elements", [{ name: "element" }, ...measured.map((f) => ({ name: f.name.replaceAll("_", " "), unit: f.unit === "1" ? "" : f.unit }))]);
  let last = -1;
  let shown = structure.displacements;  // others where another design is chosen
  structure.onState.on(() => {
    if (structure.state.case === last && structure.displacements === shown) return;
    [last, shown] = [structure.state.case, structure.displacements];
    refresh();
  });
  refresh();
  return [
    panel(structure.relative ? "Shape" : "Displacements", "displacements", displacements.node, structure.relative && el("p", { class: "caption note" }, "Relative to the largest displacement, because a mode shape has no absolute scale. Element values are relative to the largest value as well.")),
    measured.length ? panel("Elements", "elements", elements.node) : null,
    structure.reactions.length ? panel("Reactions", "reactions", reactions.node, total) : null,
  ].filter(Boolean);
}
