// What is known over time, whatever is drawn: instants, series, events, where the player stands.

class Timeline {
  constructor(payload) {
    this.title = String(payload.title || "mechanism");
    this.time = Float64Array.from(list(payload.time), (t, i, all) => (isNum(t) ? t : NaN)).filter((t) => !Number.isNaN(t));
    this.n = this.time.length;
    this.start = this.n ? this.time[0] : 0;
    this.end = this.n ? this.time[this.n - 1] : 0;
    this.span = this.end - this.start;
    this.moves = this.n > 1 && this.span > 0;
    this.asked = Array.isArray(payload.trace) ? payload.trace.map(String) : null;
    this.series = list(payload.series).map((s) => ({
      name: String(s.name ?? ""), unit: unitOf(s), group: String(s.group || "other"), values: floats(s.values, this.n),
      other: s.other ? floats(s.other, this.n) : null,
    }));
    this.other = payload.other ? String(payload.other) : "";
    this.seriesByName = new Map(this.series.map((s) => [s.name, s]));
    this.events = list(payload.events).filter((e) => isNum(e.time)).map((e) => ({ name: String(e.name ?? "event"), time: e.time }));
    this.bodies = [];
    this.ground = { name: "ground", fixed: true, shapes: [] };
    this.setTime(this.start);
  }

  setBodies(given, read) {
    this.bodies = list(given).map((body, index) => ({ name: String(body.name ?? `body ${index + 1}`), index, node: Boolean(body.node), ...read(body) }));
    for (const [k, { of }] of list(given).entries()) {  // what belongs to another one looks like it
      const owner = this.bodies.find((body) => of !== undefined && body.name === String(of));
      if (owner) Object.assign(this.bodies[k], { index: owner.index, of: owner });
    }
    for (const body of this.bodies) body.label = body.of || body.node ? "" : body.name.length > 28 ? `${body.name.slice(0, 27)}…` : body.name;
    this.byName = new Map(this.bodies.map((body) => [body.name, body]));
  }

  has(name) { return name === "ground" || this.byName.has(String(name)); }
  find(name) { return this.byName.get(String(name)) || this.ground; }
  told(item) { return { name: String(item.name ?? ""), description: String(item.description ?? item.symbol ?? ""), symbol: String(item.symbol ?? "") }; }

  setTime(t) {
    this.now = t;
    this.cursor = this.locate(t);
  }

  // The frame at or before t, and how far it is to the next one.
  locate(t) {
    let lo = 0, hi = this.n - 1;
    if (hi < 1) return { i: 0, f: 0 };
    while (hi - lo > 1) {
      const mid = (lo + hi) >> 1;
      if (this.time[mid] <= t) lo = mid; else hi = mid;
    }
    const step = this.time[hi] - this.time[lo];
    return { i: lo, f: step > 0 ? clamp((t - this.time[lo]) / step, 0, 1) : 0 };
  }

  // Linear between two frames; next to a gap, the nearer frame has the word.
  sample(column, { i, f }) {
    const a = column[i];
    if (f === 0 || i + 1 >= column.length) return a;
    const b = column[i + 1];
    if (a !== a || b !== b) return f < 0.5 ? a : b;
    return a + (b - a) * f;
  }

  // What is worth following, when the motion leads far away from where it was: else null.
  traveller(whole, once) {
    const drawn = this.bodies.filter((b) => b.shapes.length && !b.of && !b.node);
    return drawn.length > 1 && whole > 4 * once && once > 0 ? drawn[0] : null;
  }

  // The way of a point over the whole motion, thinned to some 2000 points.
  path(body, point) {
    const stride = Math.max(1, Math.ceil(this.n / 2000));
    const out = [];
    for (let i = 0; i < this.n; i += stride) out.push({ t: this.time[i], p: this.at(body, point, { i, f: 0 }) });
    if (this.n && (this.n - 1) % stride) out.push({ t: this.end, p: this.at(body, point, { i: this.n - 1, f: 0 }) });
    return out;
  }

  frames(most) {
    const count = Math.min(this.n, most);
    return Array.from({ length: count }, (_, k) => ({ i: count > 1 ? Math.round((k * (this.n - 1)) / (count - 1)) : 0, f: 0 }));
  }

  // Angles in degrees, or in radians as they are.
  setDegrees(on) {
    for (const s of this.series) {
      s.plain ??= { unit: s.unit, values: s.values, other: s.other };
      const turns = on && /^rad\b/.test(s.plain.unit), scaled = (column) => column && (turns ? column.map((v) => (v * 360) / TAU) : column);
      Object.assign(s, { unit: turns ? s.plain.unit.replace("rad", "°") : s.plain.unit, values: scaled(s.plain.values), other: scaled(s.plain.other) });
    }
  }

  // Points that are one place all the time share a name; the first stands for them.
  joinPoints(size) {
    const firsts = [];
    for (const point of this.points) {
      const stride = Math.max(1, Math.floor(point.way.length / 24));
      point.some = point.way.filter((_, k) => k % stride === 0).map(({ p }) => p);
      const near = (p, q) => (p && q ? Math.hypot(...p.map((v, k) => v - q[k])) < 1e-4 * size : p === q);
      const first = this.moves && firsts.find((other) => other.some.every((p, k) => near(p, point.some[k])));
      point.names = [point.name];
      if (first) { point.same = first; first.names.push(point.name); } else firsts.push(point);
    }
  }

  // The points asked for; else up to three moving ones; of many, the one with the longest way.
  chooseTraces(size) {
    for (const point of this.points) {
      point.way = this.path(point.body, point.point);
      point.length = 0;
      let last = null;
      for (const { p } of point.way) {
        if (p && last) point.length += Math.hypot(...p.map((v, k) => v - last[k]));
        last = p || last;
      }
    }
    this.joinPoints(size);
    this.spots = this.points.filter((p) => !p.same);
    const moving = this.spots.filter((p) => p.length > 1e-6 * size);
    const chosen = this.asked ? this.spots.filter((p) => p.names.some((name) => this.asked.includes(name))) : moving.length <= 3 ? moving : [...moving].sort((a, b) => b.length - a.length).slice(0, 1);
    for (const point of chosen) point.traced = true;
  }
}
