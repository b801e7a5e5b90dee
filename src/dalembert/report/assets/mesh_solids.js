// The mesh of a spatial structure: faces, lines and supports in the colours of a field, moved to its displacements.

/** @import { Mesh } from "./mesh.js" */
/** @import { SpatialPainter } from "./spatial_painter.js" */

import "./vendor/three.js";
import { FEW_ELEMENTS, edgeOpacity } from "./mesh.js";
import { clamp } from "./numbers.js";
import { ball } from "./solids.js";
import { AXES, vector } from "./spatial_motion.js";
import { support } from "./spatial_symbols.js";
import { thickLines } from "./spatial_trace.js";
import { Theme, mix } from "./theme.js";

/** Direction to the light, and how much darker faces across it are. */
const LIGHT = [-0.33, -0.41, 0.85], DARKER = 0.42;
/** Material that is seen from both sides. */
const BOTH_SIDES = 2;

export class MeshSolids {
  /** @param {SpatialPainter} painter @param {Mesh} mesh @param {Mesh | null} other mesh of another design or run */
  constructor(painter, mesh, other) {
    this.painter = painter;
    this.mesh = mesh;
    this.other = other;
    const { size } = painter.scene, many = mesh.elements.length > FEW_ELEMENTS, width = many ? 1.8 : 3.6;
    /** Vertices and elements of the triangles. @type {{ vertices: number[], elements: number[], faces: number[] }} */
    this.triangles = trianglesOf(mesh);
    /** Vertices of line segments, and their elements. @type {{ vertices: number[], elements: number[] }} */
    this.segments = segmentsOf(mesh);
    this.faces = new THREE.Mesh(emptyGeometry(this.triangles.vertices.length), new THREE.MeshBasicMaterial({ vertexColors: true, side: BOTH_SIDES, fog: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 }));
    this.faces.castShadow = true;
    this.edges = new THREE.LineSegments(emptyGeometry(2 * this.triangles.faces.length), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.4, fog: false }));
    this.outline = this.lines(mesh.outline, 1.4);
    // Pale colours stay visible on a darker core.
    this.core = this.lines(this.segments.vertices, width + (many ? 1.2 : 2.2));
    this.members = this.lines(this.segments.vertices, width, { vertexColors: true, polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -400 });
    this.rest = this.lines([...this.segments.vertices, ...mesh.outline], 1.2, { dashed: true, dashSize: 0.012 * size, gapSize: 0.009 * size });
    this.ghost = this.lines(other ? [...segmentsOf(other).vertices, ...other.outline] : [], 5, { transparent: true, opacity: 0.4 });
    this.nodes = new THREE.Group();
    for (const vertex of mesh.drawnNodes) {
      const dot = new THREE.Mesh(ball([0, 0, 0], 0.55 * painter.unit), painter.materials.surface("pale"));
      dot.userData = { vertex };
      this.nodes.add(dot);
    }
    this.supports = this.buildSupports();
    for (const part of [this.faces, this.edges, this.outline, this.core, this.members, this.rest, this.ghost]) part.frustumCulled = false;
    painter.parts.add(this.faces, this.edges, this.outline, this.core, this.members, this.rest, this.ghost, this.nodes, this.supports);
    this.place(this.rest, [...this.segments.vertices, ...mesh.outline], mesh.rest);
    this.rest.computeLineDistances();
    mesh.faces.length || (this.faces.visible = false);
    /** Positions and colours in the drawing. */
    this.key = "";
  }

  /** @param {number[]} vertices @param {number} width @returns {THREE.LineSegments2} */
  lines(vertices, width, style = {}) {
    const line = thickLines(Array(vertices.length).fill([0, 0, 0]), width, style);
    if (/** @type {any} */ (style).vertexColors) line.geometry.setColors(new Float32Array(3 * Math.max(2, vertices.length)));
    line.userData = { vertices };
    return line;
  }

  /** Supports as one solid. */
  buildSupports() {
    const { mesh, painter, painter: { motion, scene } } = this, supports = motion.symbols.filter(({ symbol }) => symbol === "support");
    const count = supports.reduce((sum, { nodes }) => sum + nodes.length, 0), u = painter.unit * (count <= 12 ? 1 : clamp(6 / Math.sqrt(count), 0.3, 0.8));
    /** @type {number[]} */
    const positions = [];
    for (const { nodes, axis, roller, clamp } of supports) {
      const q = new THREE.Quaternion().setFromUnitVectors(vector(AXES.z), vector(axis ?? [0, 0, -1]).negate().normalize());
      const solids = support(u, clamp, roller).map((geometry) => geometry.applyQuaternion(q).attributes.position.array);
      for (const node of nodes) {
        const place = mesh.placeOf(node, 3, mesh.rest);
        for (const array of solids) for (let k = 0; k < array.length; k++) positions.push(array[k] + place[k % 3]);
      }
    }
    const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(positions), 3));
    geometry.computeVertexNormals();
    const solid = new THREE.Mesh(geometry, painter.materials.surface("ground"));
    solid.castShadow = solid.receiveShadow = true;
    solid.visible = scene.show.supports && count > 0;
    return solid;
  }

  restyle() {
    this.key = "";
    const { ink, muted, surface } = Theme;
    this.edges.material.color.set(ink);
    this.core.material.color.set(mix(ink, surface, 0.25));
    this.outline.material.color.set(ink);
    this.rest.material.color.set(mix(muted, surface, 0.45));
    this.ghost.material.color.set(muted);
  }

  /** Move to the present displacements, and show what is requested. */
  move() {
    const { mesh, other, painter, painter: { scene, scene: { show, canvas } } } = this;
    this.rest.visible = show.rest;
    this.ghost.visible = Boolean(other) && show.ghosts;
    this.supports.visible = show.supports;
    this.edges.visible = show.mesh && mesh.faces.length > 0;
    this.edges.material.opacity = edgeOpacity((painter.view.scaleAt(painter.view.centre.toArray()) * scene.size) / Math.sqrt(mesh.faceCount || 1) / 2);
    this.outline.visible = !show.mesh && mesh.outline.length > 0;
    this.core.visible = this.members.visible = this.segments.vertices.length > 0;
    this.core.visible &&= mesh.field !== null;
    for (const line of [this.outline, this.core, this.members, this.rest, this.ghost]) line.material.resolution.set(canvas.clientWidth, canvas.clientHeight);
    const key = [mesh.cursor.i, mesh.cursor.f, mesh.scale, scene.motion.share, mesh.field?.name, Theme.name].join();
    if (key === this.key) return;
    this.key = key;
    for (const line of [this.outline, this.core, this.members]) this.place(line, line.userData.vertices, mesh.places);
    if (other) this.place(this.ghost, this.ghost.userData.vertices, other.places);
    this.fill(this.faces.geometry, this.triangles.vertices);
    this.fill(this.edges.geometry, this.triangles.faces);
    for (const dot of this.nodes.children) dot.position.set(...mesh.placeOf(dot.userData.vertex, 3));
    this.colour();
  }

  /** Positions of thick lines. @param {THREE.LineSegments2} line @param {number[]} vertices @param {Float64Array} places */
  place(line, vertices, places) {
    if (!vertices.length) return;
    const { data } = line.geometry.attributes.instanceStart;
    vertices.forEach((vertex, k) => { for (let axis = 0; axis < 3; axis++) data.array[3 * k + axis] = places[3 * vertex + axis]; });
    data.needsUpdate = true;
  }

  /** Positions of the vertices of triangles or lines. @param {THREE.BufferGeometry} geometry @param {number[]} vertices */
  fill(geometry, vertices) {
    const { position } = geometry.attributes, { places } = this.mesh;
    vertices.forEach((vertex, k) => { for (let axis = 0; axis < 3; axis++) position.array[3 * k + axis] = places[3 * vertex + axis]; });
    position.needsUpdate = true;
  }

  /** Colours of the field, darker on faces across the light. */
  colour() {
    const { mesh, mesh: { field } } = this, ramp = mesh.ramp(), values = field ? mesh.values(field) : null, colour = new THREE.Color();
    const plain = field ? mix(Theme.muted, Theme.surface, 0.6) : mix(Theme.accent, Theme.surface, 0.45), line = field ? mix(Theme.muted, Theme.surface, 0.5) : Theme.accent;
    const write = (/** @type {Float32Array} */ array, /** @type {number} */ k, /** @type {number} */ vertex, /** @type {number} */ element, /** @type {string} */ otherwise, /** @type {number} */ shade) => {
      const value = values?.[field?.atVertices ? vertex : element], { r, g, b } = colour.set(ramp?.colour(value) ?? otherwise);
      array.set([r * shade, g * shade, b * shade], 3 * k);
    };
    const { vertices, elements } = this.triangles, { color } = this.faces.geometry.attributes;
    for (let k = 0; k < vertices.length; k += 3) {
      const shade = this.shade(vertices, k);
      for (let n = k; n < k + 3; n++) write(color.array, n, vertices[n], elements[k / 3], plain, shade);
    }
    color.needsUpdate = true;
    const data = this.members.geometry.attributes.instanceColorStart?.data;
    if (!data) return;
    this.segments.vertices.forEach((vertex, k) => write(data.array, k, vertex, this.segments.elements[k >> 1], line, 1));
    data.needsUpdate = true;
  }

  /** Share of the light on a triangle. @param {number[]} vertices @param {number} k */
  shade(vertices, k) {
    const [a, b, c] = [0, 1, 2].map((n) => 3 * vertices[k + n]), p = this.mesh.places;
    const [ux, uy, uz, vx, vy, vz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2], p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], length = Math.hypot(...normal) || 1;
    const lit = Math.abs(normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]) / length;
    return (1 - DARKER * (1 - lit)) ** 2;  // colours are linear, shades are seen in their square roots
  }
}

/** Triangles of the faces, and the vertices of their edges. @param {Mesh} mesh */
function trianglesOf({ faces: groups }) {
  /** @type {number[]} */
  const vertices = [], /** @type {number[]} */ elements = [], /** @type {number[]} */ faces = [];
  for (const { size, vertices: all, elements: owners } of groups) owners.forEach((element, row) => {
    const ring = all.slice(row * size, (row + 1) * size);
    for (let k = 1; k < size - 1; k++) { vertices.push(ring[0], ring[k], ring[k + 1]); elements.push(element); }
    ring.forEach((vertex, k) => faces.push(vertex, ring[(k + 1) % size]));
  });
  return { vertices, elements, faces };
}

/** Segments of the lines. @param {Mesh} mesh */
function segmentsOf({ lines }) {
  /** @type {number[]} */
  const vertices = [], /** @type {number[]} */ elements = [];
  for (const { size, vertices: all, elements: owners } of lines) owners.forEach((element, row) => {
    for (let k = row * size; k < (row + 1) * size - 1; k++) { vertices.push(all[k], all[k + 1]); elements.push(element); }
  });
  return { vertices, elements };
}

/** Geometry of a number of vertices with colours. @param {number} count @returns {THREE.BufferGeometry} */
function emptyGeometry(count) {
  const column = () => new THREE.BufferAttribute(new Float32Array(3 * count), 3);
  return new THREE.BufferGeometry().setAttribute("position", column()).setAttribute("color", column());
}
