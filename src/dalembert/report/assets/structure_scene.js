// The drawing of a structure: its layers, and what is under the pointer.

const FEW_MEMBERS = 60;  // members up to which their values can be written on them

class StructureScene extends StructureMarks {
  constructor(structure, canvas, tip) {
    super();
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

  get vector() { return true; }

  restyle() { this.invalidate(); }

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
