// Geometry of solids in metres, in the axes of their body; `u` is half the width of a bar without a radius.

/** @import { Shape } from "./scene_types.d.ts" */

import "./vendor/three.js";
import { hull } from "./polygons.js";
import { TAU, list } from "./numbers.js";
import { quaternion, vector, xyz } from "./spatial_motion.js";

/** @typedef {number[]} Place */

const UP = new THREE.Vector3(0, 1, 0);

/** A geometry along y, placed between two points. @param {THREE.BufferGeometry} geometry @param {Place} from @param {Place} to @returns {THREE.BufferGeometry} */
function spanning(geometry, from, to) {
  const [a, b] = [vector(from), vector(to)], way = b.clone().sub(a).normalize();
  return geometry.applyMatrix4(new THREE.Matrix4().compose(a.add(b).multiplyScalar(0.5), new THREE.Quaternion().setFromUnitVectors(UP, way), new THREE.Vector3(1, 1, 1)));
}

/** @param {Place} from @param {Place} to @returns {number} */
export const apart = (from, to) => vector(from).distanceTo(vector(to));

/** Ends of a length along an axis. @param {Place} center @param {Place} axis @param {number} length @returns {Place[]} */
const along = (center, axis, length) => [-0.5, 0.5].map((side) => vector(axis).normalize().multiplyScalar(side * length).add(vector(center)).toArray());

/** A geometry in the position and rotation of a shape. @param {THREE.BufferGeometry} geometry @param {Shape} shape @returns {THREE.BufferGeometry} */
const placed = (geometry, shape) => geometry.applyMatrix4(new THREE.Matrix4().compose(
  vector(xyz(shape.center)), quaternion(shape.turn ?? [1, 0, 0, 0]), new THREE.Vector3(1, 1, 1)));

/** @param {Place} from @param {Place} to @param {number} radius */
export const tube = (from, to, radius, sides = 32) => spanning(new THREE.CylinderGeometry(radius, radius, apart(from, to) || radius, sides), from, to);

/** @param {Place} from @param {Place} to @param {number} radius */
const pill = (from, to, radius) => spanning(new THREE.CapsuleGeometry(radius, apart(from, to), 8, 20), from, to);

/** @param {Place} center @param {number} radius */
export const ball = (center, radius) => new THREE.SphereGeometry(radius, 32, 20).translate(...center);

/** Lines between every two of the points. @param {Place[]} points */
export const polyline = (points) => new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(points.flat()), 3));

/** @param {Place[]} points */
const chain = (points) => points.slice(1).flatMap((p, k) => [points[k], p]);

/** Circles about the three axes, which show the rotation of something round. @param {Shape} shape @param {Place} size */
function meridians(shape, size) {
  const circles = [[0, 1], [1, 2], [2, 0]].flatMap(([a, b]) => chain(Array.from({ length: 97 }, (_, k) => {
    const p = [0, 0, 0];
    p[a] = 0.502 * size[a] * Math.cos((k * TAU) / 96);
    p[b] = 0.502 * size[b] * Math.sin((k * TAU) / 96);
    return p;
  })));
  return placed(polyline(circles), shape);
}

/** Rims at the ends of something round, with a diameter. @param {Place[]} ends @param {number} radius */
export function rims([from, to], radius) {
  const out = vector(to).sub(vector(from)), q = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), out.clone().normalize());
  return polyline([vector(from).addScaledVector(out, -0.002), vector(to).addScaledVector(out, 0.002)].flatMap((end) => {
    const on = (/** @type {number} */ angle) => new THREE.Vector3(1.002 * radius * Math.cos(angle), 1.002 * radius * Math.sin(angle), 0).applyQuaternion(q).add(end).toArray();
    return [...chain(Array.from({ length: 65 }, (_, k) => on((k * TAU) / 64))), on(0), on(Math.PI)];
  }));
}

/** Plate over points in one plane, with rounded corners. @param {Place[]} points @param {number} u */
function slab(points, u) {
  const places = points.map(vector), centre = places.reduce((sum, p) => sum.add(p), new THREE.Vector3()).divideScalar(points.length);
  const x = places[0].clone().sub(centre).normalize();
  const z = places.map((p) => new THREE.Vector3().crossVectors(x, p.clone().sub(centre))).sort((a, b) => b.length() - a.length())[0].normalize();
  const y = new THREE.Vector3().crossVectors(z, x);
  const flat = places.map((p) => { const d = p.clone().sub(centre); return /** @type {[number, number]} */ ([d.dot(x), d.dot(y)]); });
  const geometry = new THREE.ExtrudeGeometry(rounded(hull(flat), 1.5 * u), { depth: u, bevelEnabled: false, curveSegments: 8 }).translate(0, 0, -u / 2);
  return geometry.applyMatrix4(new THREE.Matrix4().makeBasis(x, y, z).setPosition(centre));
}

/** Outline grown by r, with arcs about its corners. @param {[number, number][]} corners @param {number} r */
function rounded(corners, r) {
  const shape = new THREE.Shape(), n = corners.length;
  const normal = (/** @type {[number, number]} */ a, /** @type {[number, number]} */ b) => Math.atan2(a[0] - b[0], b[1] - a[1]);
  corners.forEach(([x, y], k) => {
    const from = normal(corners[(k + n - 1) % n], [x, y]);
    let to = normal([x, y], corners[(k + 1) % n]);
    while (to < from) to += TAU;
    shape.absarc(x, y, r, from, to, false);
  });
  return shape;
}

/** Gear with schematic flanks about the pitch circle; a ring has its teeth inside. @param {Shape} shape @param {number} thickness */
function gear({ center, axis, radius, teeth }, thickness) {
  const { count, gap, ring, toward } = /** @type {NonNullable<Shape["teeth"]>} */ (teeth);
  const z = vector(axis).normalize(), x = vector(toward).addScaledVector(z, -vector(toward).dot(z));
  if (x.length() < 1e-12) x.set(z.y, z.z, z.x).cross(z);
  const y = new THREE.Vector3().crossVectors(z, x.normalize()), pitch = TAU / count, high = Math.min(0.3 * pitch * radius, 0.12 * radius) * (ring ? -1 : 1);
  const rim = Array.from({ length: count }, (_, k) => [[-0.34, -high], [-0.14, high], [0.14, high], [0.34, -high]].map(([share, dr]) => {
    const a = (k + share + (gap ? 0.5 : 0)) * pitch;
    return new THREE.Vector2((radius + dr) * Math.cos(a), (radius + dr) * Math.sin(a));
  })).flat();
  const shape = new THREE.Shape();
  if (ring) {
    shape.absarc(0, 0, 1.18 * radius, 0, TAU, false);
    shape.holes.push(new THREE.Shape(rim));
  } else shape.setFromPoints(rim);
  const geometry = new THREE.ExtrudeGeometry(shape, { depth: thickness, bevelEnabled: false, curveSegments: 48 }).translate(0, 0, -thickness / 2);
  return geometry.applyMatrix4(new THREE.Matrix4().makeBasis(x, y, z).setPosition(vector(center)));
}

/** @param {Shape} shape */
function triangles({ vertices, faces }) {
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(vertices), 3));
  geometry.setIndex(Array.from(list(faces)));
  return faceted(geometry);
}

/** With sharp edges. @param {THREE.BufferGeometry} geometry @returns {THREE.BufferGeometry} */
export function faceted(geometry) {
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

/** Position on a solid near a point: a corner of a surface, else on its bounding box.
 * @param {THREE.BufferGeometry} geometry @param {Shape} shape @param {THREE.Vector3} point @returns {THREE.Vector3} */
export function nearestOn(geometry, shape, point) {
  if (shape.kind !== "mesh") {
    geometry.computeBoundingBox();
    return geometry.boundingBox.clampPoint(point, new THREE.Vector3());
  }
  const corners = geometry.attributes.position, nearest = new THREE.Vector3(), p = new THREE.Vector3();
  for (let k = 0, least = Infinity; k < corners.count; k++) {
    const away = p.fromBufferAttribute(corners, k).distanceToSquared(point);
    if (away < least) { least = away; nearest.copy(p); }
  }
  return nearest;
}

/** A geometry with its edges. @param {THREE.BufferGeometry} geometry @param {number} angle between faces, in degrees */
const edged = (geometry, angle) => [geometry, new THREE.EdgesGeometry(geometry, angle)];

/** Kind of a shape → its geometry and lines on it. @type {Record<string, (shape: Shape, u: number) => THREE.BufferGeometry[]>} */
const SOLIDS = {
  bar: (s, u) => [pill(s.from, s.to, s.radius || 0.8 * u)],
  particle: (s, u) => [ball(xyz(s.center), s.radius || 1.8 * u), meridians(s, Array(3).fill(2 * (s.radius || 1.8 * u)))],
  sphere: (s) => [ball(xyz(s.center), s.radius), meridians(s, Array(3).fill(2 * s.radius))],
  ellipsoid: (s) => [placed(new THREE.SphereGeometry(0.5, 40, 28).scale(...s.size), s), meridians(s, s.size)],
  box: (s) => edged(placed(new THREE.BoxGeometry(...s.size), s), 20),
  cylinder: (s) => [tube(s.from, s.to, s.radius, 56), rims([s.from, s.to], s.radius)],
  capsule: (s) => [pill(s.from, s.to, s.radius)],
  disc: (s, u) => {
    if (s.teeth) return edged(gear(s, Math.min(2 * u, 0.25 * s.radius)), 20);
    const ends = along(s.center, s.axis, Math.min(u, 0.25 * s.radius));
    return [tube(ends[0], ends[1], s.radius, 64), rims(ends, s.radius)];
  },
  block: (s, u) => {
    const [from, to] = along(s.center, s.axis, 5 * u);
    return edged(spanning(new THREE.BoxGeometry(4 * u, 5 * u, 4 * u), from, to), 20);
  },
  line: (s, u) => [tube(s.from, s.to, 0.7 * u, 16)],
  plate: (s, u) => edged(slab(s.points, u), 40),
  curve: (s) => [null, polyline(chain(s.closed ? [...s.points, s.points[0]] : s.points))],
  mesh: (s) => edged(triangles(s), 32),
};

/** Geometry of a shape, and lines on it; either may be missing. @param {Shape} shape @param {number} u */
export const solidOf = (shape, u) => (SOLIDS[shape.kind] ?? SOLIDS.particle)(shape, u);

/** Free the memory of the graphics processor that the parts of a group occupy. @param {THREE.Object3D} group */
export function discard(group) {
  group.traverse((/** @type {any} */ part) => {
    part.geometry?.dispose();
    part.shadow?.dispose();
  });
}
