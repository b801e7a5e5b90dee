// The layers of the drawing of a structure: at rest, another design, faces, lines, points.

const LIGHT = [0.35, 0.5, 0.79];

class StructurePainter extends StructureCamera {
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
}
