// The mesh of a planar structure on a canvas: at rest, of another design, faces and lines in the colours of a field, nodes.

/** @import { Context } from "./types.d.ts" */
/** @import { CellsData } from "./scene_types.d.ts" */
/** @import { Mesh } from "./mesh.js" */
/** @import { PlanarPainter } from "./planar_painter.js" */
/** @import { Ramp } from "./colours.js" */

import { circle, stroke } from "./canvas.js";
import { Theme, mix } from "./theme.js";

/** Limit of elements drawn with thick lines, and of nodes that are drawn. */
export const FEW_ELEMENTS = 400, FEW_NODES = 60;

/** Draw the mesh of a scene. @param {PlanarPainter} painter @param {Mesh} mesh */
export function drawMesh(painter, mesh) {
  const { ctx, motion: { otherMesh }, scene: { show } } = painter, seen = painter.scene.seen();
  const layer = new MeshLayer(ctx, mesh, seen);
  if (show.rest) {
    new MeshLayer(ctx, mesh, painter.scene.seen(mesh.rest)).edges(mesh);
    stroke(ctx, mix(Theme.muted, Theme.surface, 0.45), 1, mesh.drop ? [] : [5, 4]);
  }
  ctx.lineJoin = ctx.lineCap = "round";
  if (otherMesh && show.ghosts) {
    new MeshLayer(ctx, mesh, painter.scene.seen(otherMesh.places)).edges(otherMesh);
    ctx.globalAlpha = 0.45;
    stroke(ctx, Theme.muted, otherMesh.lines.length ? 6 : 2.4);
    ctx.globalAlpha = 1;
  }
  layer.drawFaces(show.mesh);
  layer.drawLines();
  layer.drawNodes();
  ctx.lineCap = "butt";
}

class MeshLayer {
  /** @param {Context} ctx @param {Mesh} mesh @param {Float64Array} seen positions of the vertices on the canvas */
  constructor(ctx, mesh, seen) {
    this.ctx = ctx;
    this.mesh = mesh;
    this.seen = seen;
    this.ramp = mesh.ramp();
    this.values = mesh.field ? mesh.values(mesh.field) : null;
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

  /** @param {boolean} edges whether the edges of the cells are drawn */
  drawFaces(edges) {
    const { ctx, mesh } = this, plain = mix(Theme.accent, Theme.surface, 0.75), grey = mix(Theme.muted, Theme.surface, 0.7);
    if (!mesh.faces.length) return;
    ctx.lineWidth = 0.6;
    ctx.setLineDash([]);
    for (const cells of mesh.faces) cells.elements.forEach((_, row) => {
      ctx.beginPath();
      this.run(cells.vertices, row * cells.size, cells.size, true);
      ctx.fillStyle = this.colour(cells, row) ?? (mesh.field ? grey : plain);
      ctx.strokeStyle = edges ? "rgb(20 30 40 / 35%)" : ctx.fillStyle;
      ctx.fill();
      ctx.stroke();
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
    for (const k of drawnNodes(this.mesh)) {
      circle(ctx, [seen[3 * k], seen[3 * k + 1]], 2.8);
      ctx.fillStyle = Theme.surface;
      ctx.fill();
      stroke(ctx, Theme.ink, 1.2);
    }
  }
}

/** Elements at nodes, and the ends of few lines. @param {Mesh} mesh */
export function drawnNodes({ nodes, lines, points }) {
  const drawn = new Set(points.flatMap(({ vertices }) => vertices));
  for (const { vertices } of nodes.length <= FEW_NODES ? lines : []) for (const k of vertices) if (k < nodes.length) drawn.add(k);
  return drawn;
}
