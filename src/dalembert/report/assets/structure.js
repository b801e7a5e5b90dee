// A structure and its states: places, displacements, fields, and colours for their values.

const AUTO = 1;  // place of the slider that stands for the automatic scale

class Structure {
  constructor(payload) {
    this.title = String(payload.title ?? "");
    const { scene = {}, states = {} } = payload, mesh = scene.mesh || {}, ghost = list(scene.ghosts)[0]?.mesh;
    this.dimension = scene.dimension || 2;
    this.solid = this.dimension === 3;
    const n = list(mesh.rest).length;
    this.count = n / 3;
    this.rest = floats(mesh.rest, n);
    this.moved = list(mesh.moved).map((m) => floats(m, n));
    this.cases = list(states.names).map(String);
    this.shapes = (key) => list(mesh[key]).map((s) => ({ size: s.size, vertices: list(s.vertices), owners: list(s.elements) }));
    [this.lines, this.faces, this.points] = ["lines", "faces", "points"].map(this.shapes);
    this.outline = list(mesh.outline);
    this.ghost = ghost ? this.otherDesign(ghost) : null;
    chooseUnits(payload.units);
    this.nodes = list(mesh.nodes);
    this.elements = list(mesh.elements);
    const table = list(payload.numbers), names = list(payload.directions);
    const used = [...names.keys()].filter((k) => this.nodes.some((_, n) => table[n * names.length + k] >= 0));
    this.directions = used.map((k) => names[k]);
    this.table = this.nodes.flatMap((_, n) => used.map((k) => table[n * names.length + k]));
    this.displacements = list(payload.displacements).map((u) => list(u));
    this.relative = Boolean(states.relative);  // shapes have no size: the largest displacement is one
    if (this.relative) this.normalise();
    this.fields = list(scene.fields).map((f) => ({ ...f, unit: /strain|^e[xyz]{2}$|^g(xy|yz|zx|xz)$/.test(f.name) && unitOf(f) === "1" ? "strain" : unitOf(f), values: f.values.map((v) => floats(v, this.elements.length)) }));
    if (this.relative) for (const f of this.fields) Object.assign(f, { unit: "1", values: f.values.map(relativeTo) });
    this.fields.unshift(this.sizes());
    this.supports = list(scene.symbols).filter((s) => s.symbol === "support");
    const loads = list(scene.symbols).filter((s) => s.symbol !== "support");
    this.loads = this.cases.map((_, k) => loads.map((s) => ({ node: s.node, force: ["x", "y", "z"].map((axis) => s[`force_${axis}`]?.[k] ?? 0), presses: Boolean(s.inward?.[k]), moment: s.moment?.[k] ?? 0 })));
    this.reactions = list(payload.reactions);
    this.scales = list(mesh.scales).map((s, k) => s * (this.factors?.[k] ?? 1));
    this.sequence = list(states.times).length > 1;
    this.kindOfState = String(states.kind ?? "case");
    this.drop = mesh.drop ?? 0;
    this.state = { case: 0, field: null, factor: AUTO };
    this.onState = new Signal();
  }

  // Lines and edges of another design, at rest and displaced.
  otherDesign({ rest, moved, lines, outline }) {
    const n = list(rest).length;
    return { rest: floats(rest, n), moved: list(moved).map((m) => floats(m, n)), lines: list(lines), outline: list(outline) };
  }

  // Its places in the current case, displaced by a factor.
  ghostPlaces(factor) {
    const out = new Float64Array(this.ghost.rest), moved = this.ghost.moved[this.state.case];
    if (moved) for (let i = 0; i < out.length; i++) out[i] += factor * moved[i];
    return out;
  }
  // Shapes in parts of their largest displacement.
  normalise() {
    const largest = (m) => {
      let most = 0;
      for (let i = 0; i < m.length; i += 3) most = Math.max(most, Math.hypot(m[i], m[i + 1], m[i + 2]));
      return most;
    };
    if (this.ghost) this.ghost.moved = this.ghost.moved.map((m) => m.map((v) => v / (largest(m) || 1)));
    this.moved.forEach((m, k) => {
      const most = largest(m);
      if (!(most > 0)) return;
      this.moved[k] = m.map((v) => v / most);
      this.displacements[k] = Array.from(this.displacements[k], (v) => v / most);
      this.factors = [...(this.factors || []), most];
    });
  }

  // Units of displacements and turns.
  unitOf(name) { return this.relative ? (name[0] === "r" ? "rad/m" : "") : name[0] === "r" ? "rad" : "m"; }

  // The size of the displacement of every vertex is a field too.
  sizes() {
    const values = this.moved.map((m) => Float64Array.from({ length: this.count }, (_, k) => Math.hypot(m[3 * k], m[3 * k + 1], m[3 * k + 2])));
    return { name: this.relative ? "shape" : "displacement", unit: this.unitOf("u"), values, atVertices: true };
  }

  set(change) {
    Object.assign(this.state, change);
    this.onState.emit();
  }

  // The automatic scale of the current case.
  get scale() { return this.scales[this.state.case] || 1; }

  get field() { return this.state.field; }

  // Places of all vertices in the current case, displaced by a factor.
  places(factor = this.state.factor * this.scale) {
    const out = new Float64Array(this.rest);
    const moved = this.moved[this.state.case];
    if (moved) for (let i = 0; i < out.length; i++) out[i] += factor * moved[i];
    if (this.drop) for (let k = 0; k < this.count; k++) out[3 * k + 1] -= this.drop;
    return out;
  }

  // Of a field in the current case, or in all that follow one another: smallest and largest,
  // about zero where both signs occur.
  range(field) {
    const [lo, hi] = extent(this.sequence ? field.values : [field.values[this.state.case] || []]) || [0, 0];
    if (lo < 0 && hi > 0) { const most = Math.max(-lo, hi); return [-most, most]; }
    if (lo > 0 && lo < 1e-4 * hi) return [0, hi];
    return hi > lo ? [lo, hi] : [lo, lo + (Math.abs(lo) || 1)];
  }

  valueOf(field, element) {
    const values = field.values[this.state.case];
    return values && !field.atVertices ? values[element] : NaN;
  }

  // ux, uy, … of a node in the current case.
  components(node) {
    const u = list(this.displacements[this.state.case]);
    const width = this.directions.length;
    return this.directions.map((name, k) => {
      const degree = this.table[node * width + k];
      return degree >= 0 ? { name, unit: this.unitOf(name), value: u[degree] } : null;
    });
  }
}

// In parts of the largest of them.
function relativeTo(values) {
  const most = values.reduce((m, v) => (isNum(v) ? Math.max(m, Math.abs(v)) : m), 0);
  return most > 0 ? values.map((v) => v / most) : values;
}

// Colours after viridis for one sign, blue over white to red for both.
const RAMPS = {
  one: ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6dcd59", "#b4de2c", "#fde725"],
  both: ["#0a3a70", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b", "#76001f"],
};

class Ramp {
  constructor([lo, hi]) {
    [this.lo, this.hi] = [lo, hi];
    const stops = lo < 0 && hi > 0 ? RAMPS.both : RAMPS.one;
    this.steps = Array.from({ length: 256 }, (_, k) => {
      const x = (k / 255) * (stops.length - 1), i = Math.min(Math.floor(x), stops.length - 2);
      return mix(stops[i], stops[i + 1], x - i);
    });
  }

  colour(value) {
    if (!isNum(value)) return null;
    return this.steps[clamp(Math.round((255 * (value - this.lo)) / (this.hi - this.lo)), 0, 255)];
  }
}

// Factor and unit for a size: as chosen, else kN, MPa, mm, where the unit takes prefixes.
function prefixed(size, unit) {
  if (chosenUnits.has(unit)) return { factor: chosenUnits.get(unit)[0], unit: chosenUnits.get(unit)[1], most: size };
  if (unit === "strain") return { factor: 1e-6, unit: "µm/m", most: size };
  const takes = ["N", "Pa", "J", "m", "N m"].includes(unit) && size > 0;
  const power = takes ? clamp(3 * Math.floor(Math.log10(size * (1 + 1e-9)) / 3), -9, 9) : 0;
  const prefix = { "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" }[power];
  return { factor: 10 ** power, unit: prefix + unit, most: size };
}

// 12.3 kN, 4.5 MPa.
function quantity(value, unit, digits = 4) {
  if (!isNum(value)) return "–";
  if (value === 0) return withUnit("0", chosenUnits.has(unit) ? chosenUnits.get(unit)[1] : unit);
  const { factor, unit: shown } = prefixed(Math.abs(value), unit);
  return withUnit(number(value / factor, digits), shown);
}
