// The drawing of a structure: view in two or three dimensions, layers, what is under the pointer.

const LIGHT = [0.35, 0.5, 0.79];
const FEW_MEMBERS = 60;  // members up to which their values can be written on them

class StructureScene {
  constructor(structure, canvas, tip) {
    Object.assign(this, { structure, canvas, tip });
    this.show = { ghost: true, rest: true, loads: true, supports: true, mesh: true, labels: false, values: false };
    this.turn = structure.solid ? { a: -0.6, b: -1.15 } : null;
    this.view = { x: 0, y: 0, s: 1 };
    this.fitted = true;
    this.share = 1;  // of the displacements, while they swing
    this.bindPointer();
    structure.onState.on(() => this.invalidate());
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  // projection -------------------------------------------------------------------------
  // Flat coordinates and depth of places; seen from the front, or turned about z and then tilted.
  projected(places) {
    const out = new Float64Array(places.length);
    if (!this.turn) {
      out.set(places);
      return out;
    }
    const [ca, sa, cb, sb] = [Math.cos(this.turn.a), Math.sin(this.turn.a), Math.cos(this.turn.b), Math.sin(this.turn.b)];
    for (let i = 0; i < places.length; i += 3) {
      const x = ca * places[i] - sa * places[i + 1], y = sa * places[i] + ca * places[i + 1], z = places[i + 2];
      out[i] = x;
      out[i + 1] = cb * y - sb * z;
      out[i + 2] = sb * y + cb * z;
    }
    return out;
  }

  way(vector) { return this.projected(Float64Array.from(vector)); }

  box(places) {
    const columns = [0, 1].map((axis) => Float64Array.from({ length: places.length / 3 }, (_, k) => places[3 * k + axis]));
    return columns.map((c) => extent([c]) || [0, 1]);
  }

  fit() {
    const { structure } = this;
    const both = [this.projected(structure.rest), this.projected(structure.places())];
    const boxes = both.map((p) => this.box(p));
    const [[x0, x1], [y0, y1]] = [0, 1].map((axis) => [Math.min(...boxes.map((b) => b[axis][0])), Math.max(...boxes.map((b) => b[axis][1]))]);
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const room = Math.min(110, (w < 700 ? 0.12 : 0.2) * Math.min(w, h));
    const side = w < 700 && this.beside ? this.beside.offsetWidth : 0;  // of the colours
    const s = Math.min((w - side - 2 * room) / Math.max(x1 - x0, 1e-12), (h - 2 * room) / Math.max(y1 - y0, 1e-12));
    const factor = s > 0 && Number.isFinite(s) ? s : 1;
    this.view = { s: factor, x: (x0 + x1) / 2 - side / 2 / factor, y: (y0 + y1) / 2 };
    this.fitted = true;
    this.invalidate();
  }

  zoom(factor, at = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2]) {
    const { view, canvas } = this;
    const [dx, dy] = [(at[0] - canvas.clientWidth / 2) / view.s, (canvas.clientHeight / 2 - at[1]) / view.s];
    view.x += dx * (1 - 1 / factor);
    view.y += dy * (1 - 1 / factor);
    view.s *= factor;
    this.fitted = false;
    this.invalidate();
  }

  resize() {
    if (this.fitted) this.fit();
    else this.invalidate();
  }

  // drawing ----------------------------------------------------------------------------
  // On the canvas, or on paper of the same size that takes the same calls.
  draw(paper = null) {
    const { structure, view } = this;
    const { ctx, w, h } = paper ? { ctx: paper, w: paper.w, h: paper.h } : fitCanvas(this.canvas, this.ratio);
    const factor = structure.state.factor * structure.scale * this.share;
    const flat = (places) => {
      const p = this.projected(places);
      for (let i = 0; i < p.length; i += 3) {
        p[i] = w / 2 + (p[i] - view.x) * view.s;
        p[i + 1] = h / 2 - (p[i + 1] - view.y) * view.s;
      }
      return p;
    };
    const [rest, now] = [flat(structure.rest), flat(structure.places(factor))];
    this.drawn = now;
    this.ramp = structure.field ? new Ramp(structure.range(structure.field)) : null;
    ctx.lineJoin = ctx.lineCap = "round";
    if (this.show.rest) this.drawRest(ctx, rest);
    if (structure.ghost && this.show.ghost) this.drawGhost(ctx, flat(structure.ghostPlaces(factor)));
    this.drawFaces(ctx, now);
    this.drawLines(ctx, now);
    this.drawPoints(ctx, now);
    if (this.show.supports) this.drawSupports(ctx, this.show.rest ? rest : now);
    if (this.show.loads) this.drawLoads(ctx, now);
    if (this.show.labels) this.drawLabels(ctx, now);
    if (this.show.values) this.drawValues(ctx, now);
    this.drawTriad(ctx, h);
  }

  // The axes, as they are seen, in a corner.
  drawTriad(ctx, h) {
    const colours = { light: ["#c0392b", "#1e8449", "#1f5fbf"], dark: ["#ff7b6b", "#58d68d", "#6aa9ff"] }[Theme.name], c = [44, h - 40];
    ["x", "y", "z"].slice(0, Math.max(2, this.structure.dimension)).map((name, k) => ({ name, colour: colours[k], way: this.way([0, 1, 2].map((i) => +(i === k))) }))
      .sort((a, b) => a.way[2] - b.way[2]).forEach(({ name, colour, way }) => {
        const [u, v] = [28 * way[0], -28 * way[1]];
        ctx.strokeStyle = ctx.fillStyle = colour;
        ctx.lineWidth = 2;
        this.arrow(ctx, c[0], c[1], c[0] + u, c[1] + v);
        this.write(ctx, name, c[0] + 1.35 * u - 3, c[1] + 1.35 * v + 4, colour);
      });
  }

  write(ctx, text, x, y, colour) {
    ctx.font = `600 11.5px ${Theme.font}`;
    Object.assign(ctx, { textAlign: "left", textBaseline: "alphabetic", lineWidth: 3.5, strokeStyle: Theme.surface, fillStyle: colour });
    ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
  }

  // What the colours stand for, in numbers on the members.
  drawValues(ctx, p) {
    const { structure, structure: { field } } = this;
    if (!field || field.atVertices) return;
    ctx.font = `600 11.5px ${Theme.font}`;
    const most = field.values[structure.state.case].reduce((m, v) => (isNum(v) ? Math.max(m, Math.abs(v)) : m), 0);
    for (const { size, vertices, owners } of structure.lines) owners.forEach((own, row) => {
      const value = structure.valueOf(field, own), [a, b] = [vertices[row * size], vertices[(row + 1) * size - 1]];
      if (!isNum(value)) return;
      const text = Math.abs(value) < 1e-9 * most ? "0" : quantity(value, field.unit, 3), wide = ctx.measureText(text).width;
      this.write(ctx, text, (p[3 * a] + p[3 * b] - wide) / 2, (p[3 * a + 1] + p[3 * b + 1]) / 2 + 4, Theme.ink);
    });
  }

  path(ctx, p, vertices, from, size, close) {
    ctx.moveTo(p[3 * vertices[from]], p[3 * vertices[from] + 1]);
    for (let k = 1; k < size; k++) ctx.lineTo(p[3 * vertices[from + k]], p[3 * vertices[from + k] + 1]);
    if (close) ctx.closePath();
  }

  drawRest(ctx, p) {
    const { structure } = this;
    ctx.strokeStyle = mix(Theme.muted, Theme.surface, 0.45);
    ctx.lineWidth = 1;
    ctx.setLineDash(structure.dimension === 1 ? [] : [5, 4]);
    ctx.beginPath();
    for (const { size, vertices } of structure.lines) {
      for (let i = 0; i < vertices.length; i += size) this.path(ctx, p, vertices, i, size);
    }
    for (let i = 0; i < structure.outline.length; i += 2) this.path(ctx, p, structure.outline, i, 2);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  // Another design behind this one, wide and pale.
  drawGhost(ctx, p) {
    const { ghost } = this.structure;
    ctx.globalAlpha = 0.45;
    ctx.strokeStyle = Theme.muted;
    ctx.lineWidth = 6;
    ctx.beginPath();
    for (const { size, vertices } of ghost.lines) for (let i = 0; i < vertices.length; i += size) this.path(ctx, p, vertices, i, size);
    ctx.stroke();
    ctx.lineWidth = 2.4;
    ctx.beginPath();
    for (let i = 0; i < ghost.outline.length; i += 2) this.path(ctx, p, ghost.outline, i, 2);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }

  // The value of one shape: of its element, or the mean of its vertices.
  value(shape, row) {
    const { field, state } = this.structure;
    if (!field) return NaN;
    const values = field.values[state.case];
    if (!field.atVertices) return values[shape.owners[row]];
    let sum = 0;
    for (let k = 0; k < shape.size; k++) sum += values[shape.vertices[row * shape.size + k]];
    return sum / shape.size;
  }

  drawFaces(ctx, p) {
    const { structure, show } = this;
    const faces = [];
    for (const shape of structure.faces) {
      for (let row = 0; row < shape.owners.length; row++) {
        const face = { shape, row, depth: 0 };
        if (structure.solid) for (let k = 0; k < shape.size; k++) face.depth += p[3 * shape.vertices[row * shape.size + k] + 2] / shape.size;
        faces.push(face);
      }
    }
    if (structure.solid) faces.sort((a, b) => a.depth - b.depth);
    const plain = mix(Theme.accent, Theme.surface, 0.7);
    const mesh = show.mesh && faces.length <= 20000;
    ctx.lineWidth = 0.6;
    for (const { shape, row } of faces) {
      const colour = this.ramp ? this.ramp.colour(this.value(shape, row)) || mix(Theme.muted, Theme.surface, 0.7) : plain;
      ctx.fillStyle = structure.solid ? this.shaded(colour, p, shape, row) : colour;
      ctx.strokeStyle = mesh ? "rgb(20 30 40 / 35%)" : ctx.fillStyle;
      ctx.beginPath();
      this.path(ctx, p, shape.vertices, row * shape.size, shape.size, true);
      ctx.fill();
      ctx.stroke();
    }
    if (structure.solid) return;
    ctx.strokeStyle = Theme.ink;
    ctx.lineWidth = 1.2;
    ctx.beginPath();
    for (let i = 0; i < structure.outline.length; i += 2) this.path(ctx, p, structure.outline, i, 2);
    ctx.stroke();
  }

  // Darker where a face looks away from the light.
  shaded(colour, p, { vertices, size }, row) {
    const at = (k) => [0, 1, 2].map((i) => (i === 2 ? p[3 * vertices[row * size + k] + 2] * this.view.s : p[3 * vertices[row * size + k] + i] * (i ? -1 : 1)));
    const [a, b, c] = [at(0), at(1), at(size - 1)];
    const [u, v] = [b, c].map((q) => q.map((x, i) => x - a[i]));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...normal) || 1;
    const lit = Math.abs(normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]) / length;
    return mix(colour, "#000000", 0.38 * (1 - lit));
  }

  drawLines(ctx, p) {
    const { structure, ramp } = this;
    const many = structure.elements.length > 400;
    const width = many ? 1.6 : 3.2;
    for (const shape of structure.lines) {
      const rows = [...shape.owners.keys()];
      const trace = (row) => this.path(ctx, p, shape.vertices, row * shape.size, shape.size);
      if (ramp) {  // pale colours stay visible on a darker core
        ctx.strokeStyle = mix(Theme.ink, Theme.surface, 0.25);
        ctx.lineWidth = width + (many ? 1.2 : 2);
        ctx.beginPath();
        rows.forEach(trace);
        ctx.stroke();
      }
      ctx.lineWidth = width;
      for (const row of rows) {
        if (ramp && structure.field.atVertices) { this.drawRun(ctx, p, shape, row); continue; }
        const colour = ramp ? ramp.colour(this.value(shape, row)) : null;
        ctx.strokeStyle = colour || (ramp ? mix(Theme.muted, Theme.surface, 0.5) : Theme.accent);
        ctx.beginPath();
        trace(row);
        ctx.stroke();
      }
    }
  }

  // A line whose colour runs with the values of its vertices.
  drawRun(ctx, p, { vertices, size }, row) {
    const values = this.structure.field.values[this.structure.state.case];
    for (let k = row * size; k < (row + 1) * size - 1; k++) {
      ctx.strokeStyle = this.ramp.colour((values[vertices[k]] + values[vertices[k + 1]]) / 2) || Theme.muted;
      ctx.beginPath();
      this.path(ctx, p, vertices, k, 2);
      ctx.stroke();
    }
  }

  drawPoints(ctx, p) {
    const { structure } = this;
    const dots = new Set(structure.points.flatMap((s) => s.vertices));
    if (structure.nodes.length <= 60) for (const s of structure.lines) s.vertices.forEach((v) => v < structure.nodes.length && dots.add(v));
    ctx.lineWidth = 1.2;
    ctx.strokeStyle = Theme.ink;
    ctx.fillStyle = Theme.surface;
    for (const v of dots) {
      ctx.beginPath();
      ctx.arc(p[3 * v], p[3 * v + 1], 2.8, 0, TAU);
      ctx.fill();
      ctx.stroke();
    }
  }

  drawSupports(ctx, p) {
    const count = this.structure.supports.reduce((sum, s) => sum + s.nodes.length, 0);
    const size = count <= 12 ? 13 : 7;
    ctx.strokeStyle = Theme.muted;
    ctx.fillStyle = Theme.surface;
    ctx.lineWidth = 1.3;
    for (const support of this.structure.supports) {
      const [wx, wy] = this.structure.solid ? [0, 1] : [support.way[0], -support.way[1]];
      for (const node of support.nodes) {
        const at = (along, across) => [p[3 * node] + size * (along * wx - across * wy), p[3 * node + 1] + size * (along * wy + across * wx)];
        const line = (...points) => { ctx.moveTo(...at(...points[0])); points.slice(1).forEach((q) => ctx.lineTo(...at(...q))); };
        ctx.beginPath();
        if (support.turns) {  // held fast: a wall, in space the top of a block
          line([0, -0.9], [0, 0.9]);
          for (let h = -0.7; h <= 0.9; h += 0.32) line([0, h], [0.4, h - 0.25]);
          if (this.structure.solid) { line([0, -0.9], [0.75, -0.9], [0.75, 0.9], [0, 0.9]); }
        } else {
          line([0, 0], [1, -0.6], [1, 0.6], [0, 0]);
          ctx.fill();
          line([support.roller ? 1.3 : 1, -0.8], [support.roller ? 1.3 : 1, 0.8]);
        }
        ctx.stroke();
      }
    }
  }

  drawLoads(ctx, p) {
    const loads = list(this.structure.loads[this.structure.state.case]);
    const most = Math.max(...loads.map((l) => Math.hypot(...l.force)), 1e-300);
    const longest = loads.length <= 6 ? 52 : 26;
    ctx.strokeStyle = ctx.fillStyle = Theme.force;
    ctx.lineWidth = 2;
    for (const { node, force, presses, moment } of loads) {
      if (moment) this.arc(ctx, p[3 * node], p[3 * node + 1], Math.sign(moment));
      const way = this.way(force);
      const [dx, dy] = [(way[0] / most) * longest, (-way[1] / most) * longest];
      const [x, y] = [p[3 * node], p[3 * node + 1]];
      const [x0, y0] = presses ? [x - dx, y - dy] : [x, y];
      this.arrow(ctx, x0, y0, x0 + dx, y0 + dy);
      if (loads.length > READABLE) continue;
      const size = Math.hypot(...force), up = presses ? -1 : 1;
      if (size > 0) this.write(ctx, quantity(size, "N", 3), (presses ? x0 : x0 + dx) + 6, (presses ? y0 : y0 + dy) + (up * dy > 0 ? 10 : -2), Theme.force);
      if (moment) this.write(ctx, quantity(Math.abs(moment), "N m", 3), x + 18, y - 14, Theme.force);
      ctx.strokeStyle = ctx.fillStyle = Theme.force;
      ctx.lineWidth = 2;
    }
  }

  // Of a moment: three quarters of a circle round the node.
  arc(ctx, x, y, sign) {
    const [radius, from, to] = sign > 0 ? [15, 0.75 * Math.PI, -0.7 * Math.PI] : [15, 0.25 * Math.PI, 1.7 * Math.PI];
    ctx.beginPath();
    ctx.arc(x, y, radius, from, to, sign > 0);
    ctx.stroke();
    const [ex, ey] = [x + radius * Math.cos(to), y + radius * Math.sin(to)];
    const [ux, uy] = [sign * Math.sin(to), -sign * Math.cos(to)];
    ctx.beginPath();
    ctx.moveTo(ex + 7 * ux, ey + 7 * uy);
    ctx.lineTo(ex - 4 * uy, ey + 4 * ux);
    ctx.lineTo(ex + 4 * uy, ey - 4 * ux);
    ctx.fill();
  }

  arrow(ctx, x0, y0, x1, y1) {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 3) return;
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
    const head = Math.min(9, 0.6 * length);
    ctx.beginPath();
    ctx.moveTo(x0, y0);
    ctx.lineTo(x1 - 0.8 * head * ux, y1 - 0.8 * head * uy);
    ctx.stroke();
    ctx.beginPath();
    ctx.moveTo(x1, y1);
    ctx.lineTo(x1 - head * ux - 0.4 * head * uy, y1 - head * uy + 0.4 * head * ux);
    ctx.lineTo(x1 - head * ux + 0.4 * head * uy, y1 - head * uy - 0.4 * head * ux);
    ctx.fill();
  }

  drawLabels(ctx, p) {
    ctx.font = `11.5px ${Theme.font}`;
    ctx.lineWidth = 3;
    ctx.strokeStyle = Theme.surface;
    ctx.fillStyle = Theme.ink;
    this.structure.nodes.forEach((name, k) => {
      ctx.strokeText(name, p[3 * k] + 6, p[3 * k + 1] - 6);
      ctx.fillText(name, p[3 * k] + 6, p[3 * k + 1] - 6);
    });
  }

  get vector() { return true; }
  restyle() { this.invalidate(); }

  // pointer ------------------------------------------------------------------------------
  bindPointer() {
    const { canvas } = this;
    let last = null;
    const at = (e) => { const box = canvas.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; };
    canvas.addEventListener("pointerdown", (e) => { last = at(e); canvas.setPointerCapture(e.pointerId); canvas.classList.add("grabbing"); this.tip.hidden = true; });
    canvas.addEventListener("pointermove", (e) => {
      const here = at(e);
      if (!last) { this.hover(here); return; }
      this.drag(here[0] - last[0], here[1] - last[1], e.shiftKey);
      last = here;
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; canvas.classList.remove("grabbing"); });
    canvas.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(Math.exp(-0.0015 * e.deltaY), at(e)); }, { passive: false });
    canvas.addEventListener("dblclick", () => this.fit());
  }

  drag(dx, dy, pan) {
    if (this.turn && !pan) {
      this.turn.a += 0.008 * dx;
      this.turn.b = clamp(this.turn.b + 0.008 * dy, -Math.PI, 0);
    } else {
      this.view.x -= dx / this.view.s;
      this.view.y += dy / this.view.s;
      this.fitted = false;
    }
    this.invalidate();
  }

  hover(here) {
    const found = this.nodeAt(here) || this.elementAt(here);
    this.tip.hidden = !found;
    if (!found) return;
    this.tip.replaceChildren(el("b", {}, found.name), el("span", { class: "what" }, found.what), el("dl", {}, found.rows.map(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])));
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const [x, y] = [here[0] + 16 + this.tip.offsetWidth > w ? here[0] - 12 - this.tip.offsetWidth : here[0] + 16, Math.min(here[1] + 14, h - this.tip.offsetHeight - 4)];
    this.tip.style.transform = `translate(${Math.max(4, x)}px, ${Math.max(4, y)}px)`;
  }

  nodeAt([x, y]) {
    const { structure, drawn } = this;
    if (!drawn) return null;
    let best = -1, least = 8;
    for (let k = 0; k < structure.nodes.length; k++) {
      const away = Math.hypot(drawn[3 * k] - x, drawn[3 * k + 1] - y);
      if (away < least) [best, least] = [k, away];
    }
    if (best < 0) return null;
    const rows = structure.components(best).filter(Boolean).map((c) => [c.name, quantity(c.value, c.unit)]);
    const forces = structure.reactions.filter((r) => r.node === structure.nodes[best]).map((r) => [r.name, quantity(list(r.values)[structure.state.case], r.unit)]);
    return { name: structure.nodes[best], what: forces.length ? "support" : "node", rows: [...rows, ...forces] };
  }

  elementAt(here) {
    const { structure, drawn } = this;
    if (!drawn) return null;
    let owner = -1, least = 7;
    for (const { size, vertices, owners } of structure.lines) {
      owners.forEach((own, row) => {
        for (let k = row * size; k < (row + 1) * size - 1; k++) {
          const away = segmentDistance(here, drawn, vertices[k], vertices[k + 1]);
          if (away < least) [owner, least] = [own, away];
        }
      });
    }
    if (owner < 0) owner = this.faceAt(here);
    if (owner < 0) return null;
    const rows = structure.fields.filter((f) => isNum(structure.valueOf(f, owner))).map((f) => [f.name.replaceAll("_", " "), quantity(structure.valueOf(f, owner), f.unit)]);
    return { name: structure.elements[owner], what: "element", rows: rows.slice(0, 14) };
  }

  // The element of the face under the pointer, the nearest of several.
  faceAt([x, y]) {
    let owner = -1, front = -Infinity;
    for (const { size, vertices, owners } of this.structure.faces) {
      owners.forEach((own, row) => {
        let inside = false, depth = 0;
        for (let k = 0, j = size - 1; k < size; j = k++) {
          const [a, b] = [3 * vertices[row * size + k], 3 * vertices[row * size + j]];
          const [xa, ya, xb, yb] = [this.drawn[a], this.drawn[a + 1], this.drawn[b], this.drawn[b + 1]];
          if (ya > y !== yb > y && x < ((xb - xa) * (y - ya)) / (yb - ya) + xa) inside = !inside;
          depth += this.drawn[a + 2] / size;
        }
        if (inside && depth > front) [owner, front] = [own, depth];
      });
    }
    return owner;
  }
}

function segmentDistance([x, y], p, i, j) {
  const [x0, y0, x1, y1] = [p[3 * i], p[3 * i + 1], p[3 * j], p[3 * j + 1]];
  const [dx, dy] = [x1 - x0, y1 - y0];
  const t = clamp(((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1), 0, 1);
  return Math.hypot(x0 + t * dx - x, y0 + t * dy - y);
}
