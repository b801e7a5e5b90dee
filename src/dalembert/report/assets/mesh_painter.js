// The mesh of a planar structure on a canvas: at rest, of another design, faces and lines in the colours of a field, nodes.

/** @import { CellsData } from "./scene_types.d.ts" */
/** @import { Mesh } from "./mesh.js" */
/** @import { PlanarPainter } from "./planar_painter.js" */

import { circle, stroke } from "./canvas.js";
import { FEW_ELEMENTS, edgeOpacity } from "./mesh.js";
import { extent } from "./numbers.js";
import { Theme, mix } from "./theme.js";

export class MeshPainter {
  /** @param {PlanarPainter} painter @param {Mesh} mesh @param {Mesh | null} other mesh of another design or run */
  constructor(painter, mesh, other) {
    this.painter = painter;
    this.mesh = mesh;
    this.other = other;
    this.ctx = painter.ctx;
    /** Positions of the vertices on the canvas. */
    this.seen = mesh.places;
    this.ramp = mesh.ramp();
    /** Values of the field. @type {Float64Array | null} */
    this.values = null;
  }

  draw() {
    const { mesh, other, painter: { ctx, scene, scene: { show } } } = this;
    this.ctx = ctx;
    this.ramp = mesh.ramp();
    this.values = mesh.field ? mesh.values(mesh.field) : null;
    if (show.rest) {
      this.seen = scene.seen(mesh.rest);
      this.edges(mesh);
      stroke(ctx, mix(Theme.muted, Theme.surface, 0.45), 1, mesh.drop ? [] : [5, 4]);
    }
    ctx.lineJoin = ctx.lineCap = "round";
    if (other && show.ghosts) {
      this.seen = scene.seen(other.places);
      this.edges(other);
      ctx.globalAlpha = 0.45;
      stroke(ctx, Theme.muted, other.lines.length ? 6 : 2.4);
      ctx.globalAlpha = 1;
    }
    this.seen = scene.seen();
    this.drawFaces(show.mesh);
    this.drawLines();
    this.drawNodes();
    ctx.lineCap = "butt";
  }

  /** Path through vertices. @param {number[]} vertices @param {number} first @param {number} count */
  run(vertices, first, count, closed = false) {
    const { ctx, seen } = this;
    for (let k = first; k < first + count; k++) {
      const [x, y] = [seen[3 * vertices[k]], seen[3 * vertices[k] + 1]];
      if (k === first) ctx.moveTo(x, y); else ctx.lineTo(x, y);
    }
    if (closed) ctx.closePath();
  }

  /** Path of all lines and outlines. @param {Mesh} mesh */
  edges({ lines, outline }) {
    this.ctx.beginPath();
    for (const { size, vertices } of lines) for (let k = 0; k < vertices.length; k += size) this.run(vertices, k, size);
    for (let k = 0; k < outline.length; k += 2) this.run(outline, k, 2);
  }

  /** Colour of a cell: of its element, or the mean of its vertices. @param {CellsData} cells @param {number} row */
  colour({ size, vertices, elements }, row) {
    const { mesh: { field }, ramp, values } = this;
    if (!field || !values) return null;
    if (!field.atVertices) return ramp?.colour(values[elements[row]]) ?? null;
    let sum = 0;
    for (let k = row * size; k < (row + 1) * size; k++) sum += values[vertices[k]] / size;
    return ramp?.colour(sum) ?? null;
  }

  /** Opacity of the edges of cells, lower for small cells. */
  edgeOpacity() {
    const [w, h] = [0, 1].map((axis) => { const [lo, hi] = extent([this.seen.filter((_, k) => k % 3 === axis)]) ?? [0, 1]; return hi - lo; });
    return edgeOpacity(Math.sqrt((w * h) / this.mesh.faceCount));
  }

  /** @param {boolean} edges whether the edges of the cells are drawn */
  drawFaces(edges) {
    const { ctx, mesh } = this, plain = mix(Theme.accent, Theme.surface, 0.75), grey = mix(Theme.muted, Theme.surface, 0.7), edge = `rgb(20 30 40 / ${Math.round(100 * this.edgeOpacity())}%)`;
    if (!mesh.faces.length) return;
    for (const cells of mesh.faces) cells.elements.forEach((_, row) => {
      const colour = this.colour(cells, row) ?? (mesh.field ? grey : plain);
      ctx.beginPath();
      this.run(cells.vertices, row * cells.size, cells.size, true);
      ctx.fillStyle = colour;
      ctx.fill();
      stroke(ctx, edges ? edge : colour, 0.6);
    });
    ctx.beginPath();
    for (let k = 0; k < mesh.outline.length; k += 2) this.run(mesh.outline, k, 2);
    stroke(ctx, Theme.ink, 1.2);
  }

  drawLines() {
    const { ctx, mesh, ramp } = this, many = mesh.elements.length > FEW_ELEMENTS, width = many ? 1.6 : 3.2;
    for (const cells of mesh.lines) {
      const { size, vertices, elements } = cells;
      if (ramp) {  // pale colours stay visible on a darker core
        ctx.beginPath();
        elements.forEach((_, row) => this.run(vertices, row * size, size));
        stroke(ctx, mix(Theme.ink, Theme.surface, 0.25), width + (many ? 1.2 : 2));
      }
      elements.forEach((_, row) => {
        if (mesh.field?.atVertices) { this.drawRun(cells, row, width); return; }
        ctx.beginPath();
        this.run(vertices, row * size, size);
        stroke(ctx, this.colour(cells, row) ?? (ramp ? mix(Theme.muted, Theme.surface, 0.5) : Theme.accent), width);
      });
    }
  }

  /** Line whose colour varies with the values at its vertices. @param {CellsData} cells @param {number} row @param {number} width */
  drawRun({ size, vertices }, row, width) {
    const { ctx, ramp, values } = this;
    for (let k = row * size; values && k < (row + 1) * size - 1; k++) {
      ctx.beginPath();
      this.run(vertices, k, 2);
      stroke(ctx, ramp?.colour((values[vertices[k]] + values[vertices[k + 1]]) / 2) ?? Theme.muted, width);
    }
  }

  drawNodes() {
    const { ctx, seen } = this;
    for (const k of this.mesh.drawnNodes) {
      circle(ctx, [seen[3 * k], seen[3 * k + 1]], 2.8);
      ctx.fillStyle = Theme.surface;
      ctx.fill();
      stroke(ctx, Theme.ink, 1.2);
    }
  }
}
