// Geometry of solids in metres, in the axes of their body; `u` is half the width of a bar without a width of its own.

const UP = new THREE.Vector3(0, 1, 0);

// A geometry along y, put between two points.
function between(geometry, from, to) {
  const [a, b] = [vector(from), vector(to)], way = b.clone().sub(a).normalize();
  return geometry.applyMatrix4(new THREE.Matrix4().compose(
    a.add(b).multiplyScalar(0.5), new THREE.Quaternion().setFromUnitVectors(UP, way), new THREE.Vector3(1, 1, 1)));
}

const apart = (from, to) => vector(from).distanceTo(vector(to));
const along = (center, axis, length) => {
  const half = vector(axis).normalize().multiplyScalar(length / 2), c = vector(center);
  return [c.clone().sub(half).toArray(), c.add(half).toArray()];
};
const placed = (geometry, shape) => geometry.applyMatrix4(new THREE.Matrix4().compose(
  vector(xyz(shape.center)), quaternion(shape.turn || [1, 0, 0, 0]), new THREE.Vector3(1, 1, 1)));

function tube(from, to, radius, sides = 32) {
  return between(new THREE.CylinderGeometry(radius, radius, apart(from, to) || radius, sides), from, to);
}

function pill(from, to, radius) {
  return between(new THREE.CapsuleGeometry(radius, apart(from, to), 8, 20), from, to);
}

const ball = (center, radius) => new THREE.SphereGeometry(radius, 32, 20).translate(...center);

// Circles about the three axes: they show how something round turns.
function meridians(shape, size) {
  const points = [];
  for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
    for (let k = 0; k < 96; k++) for (const angle of [(k * TAU) / 96, ((k + 1) * TAU) / 96]) {
      const p = [0, 0, 0];
      p[a] = 0.502 * size[a] * Math.cos(angle);
      p[b] = 0.502 * size[b] * Math.sin(angle);
      points.push(p);
    }
  }
  return placed(polyline(points), shape);
}

// Lines between every two of the points.
const polyline = (points) => new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(points.flat()), 3));
const chain = (points) => points.slice(1).flatMap((p, k) => [points[k], p]);

// Rims of something round about an axis, with a diameter on either end.
function rims([from, to], radius) {
  const q = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), vector(to).sub(vector(from)).normalize());
  const on = (end, angle) => new THREE.Vector3(radius * 1.002 * Math.cos(angle), radius * 1.002 * Math.sin(angle), 0).applyQuaternion(q).add(vector(end)).toArray();
  const out = vector(to).sub(vector(from)).multiplyScalar(0.002);
  const ends = [vector(from).sub(out).toArray(), vector(to).add(out).toArray()];
  return polyline(ends.flatMap((end) => [
    ...Array.from({ length: 64 }, (_, k) => [on(end, (k * TAU) / 64), on(end, ((k + 1) * TAU) / 64)]).flat(), on(end, 0), on(end, Math.PI)]));
}

// A plate over points in one plane, with rounded corners.
function slab(points, u) {
  const places = points.map(vector), centre = places.reduce((sum, p) => sum.add(p), new THREE.Vector3()).divideScalar(points.length);
  const x = places[0].clone().sub(centre).normalize();
  const z = places.map((p) => new THREE.Vector3().crossVectors(x, p.clone().sub(centre))).sort((a, b) => b.length() - a.length())[0].normalize();
  const y = new THREE.Vector3().crossVectors(z, x);
  const flat = places.map((p) => { const d = p.clone().sub(centre); return [d.dot(x), d.dot(y)]; });
  const shape = rounded(hull(flat), 1.5 * u);
  const geometry = new THREE.ExtrudeGeometry(shape, { depth: u, bevelEnabled: false, curveSegments: 8 }).translate(0, 0, -u / 2);
  return geometry.applyMatrix4(new THREE.Matrix4().makeBasis(x, y, z).setPosition(centre));
}

// The outline grown by r, with arcs about its corners.
function rounded(corners, r) {
  const shape = new THREE.Shape(), n = corners.length;
  corners.forEach(([x, y], k) => {
    const [before, after] = [corners[(k + n - 1) % n], corners[(k + 1) % n]];
    const normal = ([ax, ay], [bx, by]) => Math.atan2(-(bx - ax), by - ay);
    const from = normal(before, [x, y]);
    let to = normal([x, y], after);
    while (to < from) to += TAU;
    shape.absarc(x, y, r, from, to, false);
  });
  return shape;
}

// A toothed wheel: schematic flanks about the pitch circle, a tooth or a gap where it meets the other.
function gear({ center, axis, radius, teeth }, thick) {
  const z = vector(axis).normalize(), x = vector(teeth.toward).addScaledVector(z, -vector(teeth.toward).dot(z));
  if (x.length() < 1e-12) x.set(z.y, z.z, z.x).cross(z);
  const y = new THREE.Vector3().crossVectors(z, x.normalize()), pitch = TAU / teeth.count, high = Math.min(0.3 * pitch * radius, 0.12 * radius);
  const shape = new THREE.Shape(), flanks = [[-0.34, -high], [-0.14, high], [0.14, high], [0.34, -high]], sign = teeth.ring ? -1 : 1;
  const rim = Array.from({ length: teeth.count }, (_, k) => flanks.map(([u, dr]) => {
    const a = (k + u + (teeth.gap ? 0.5 : 0)) * pitch, r = radius + sign * dr;
    return new THREE.Vector2(r * Math.cos(a), r * Math.sin(a));
  })).flat();
  if (teeth.ring) {
    shape.absarc(0, 0, 1.18 * radius, 0, TAU, false);
    shape.holes.push(new THREE.Shape(rim));
  } else shape.setFromPoints(rim);
  const geometry = new THREE.ExtrudeGeometry(shape, { depth: thick, bevelEnabled: false, curveSegments: 48 }).translate(0, 0, -thick / 2);
  return geometry.applyMatrix4(new THREE.Matrix4().makeBasis(x, y, z).setPosition(vector(center)));
}

function triangles({ vertices, faces }) {
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(vertices), 3));
  geometry.setIndex(Array.from(list(faces)));
  return faceted(geometry);
}

// With edges that are not smoothed.
function faceted(geometry) {
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

// A place of a solid near a point: of a surface a corner, else on the box about it.
function nearestOn(geometry, shape, point) {
  if (shape.kind !== "mesh") {
    geometry.computeBoundingBox();
    return geometry.boundingBox.clampPoint(point, new THREE.Vector3());
  }
  const corners = geometry.attributes.position, best = new THREE.Vector3(), p = new THREE.Vector3();
  for (let k = 0, least = Infinity; k < corners.count; k++) {
    const away = p.fromBufferAttribute(corners, k).distanceToSquared(point);
    if (away < least) { least = away; best.copy(p); }
  }
  return best;
}

const SOLIDS = {
  bar: (s, u) => [pill(s.from, s.to, s.radius || 0.8 * u)],
  particle: (s, u) => [ball(xyz(s.center), s.radius || 1.8 * u), meridians(s, Array(3).fill(2 * (s.radius || 1.8 * u)))],
  sphere: (s) => [ball(xyz(s.center), s.radius), meridians(s, Array(3).fill(2 * s.radius))],
  ellipsoid: (s) => [placed(new THREE.SphereGeometry(0.5, 40, 28).scale(...s.size), s), meridians(s, s.size)],
  box: (s) => { const g = placed(new THREE.BoxGeometry(...s.size), s); return [g, new THREE.EdgesGeometry(g, 20)]; },
  cylinder: (s) => [tube(s.from, s.to, s.radius, 56), rims([s.from, s.to], s.radius)],
  capsule: (s) => [pill(s.from, s.to, s.radius)],
  disc: (s, u) => { if (s.teeth) { const g = gear(s, Math.min(2 * u, 0.25 * s.radius)); return [g, new THREE.EdgesGeometry(g, 20)]; } const ends = along(s.center, s.axis, Math.min(u, 0.25 * s.radius)); return [tube(...ends, s.radius, 64), rims(ends, s.radius)]; },
  block: (s, u) => { const [from, to] = along(s.center, s.axis, 5 * u); const g = between(new THREE.BoxGeometry(4 * u, 5 * u, 4 * u), from, to); return [g, new THREE.EdgesGeometry(g, 20)]; },
  line: (s, u) => [tube(s.from, s.to, 0.7 * u, 16)],
  plate: (s, u) => { const g = slab(s.points, u); return [g, new THREE.EdgesGeometry(g, 40)]; },
  curve: (s) => [null, polyline(chain(s.closed ? [...s.points, s.points[0]] : s.points))],
  mesh: (s) => { const g = triangles(s); return [g, new THREE.EdgesGeometry(g, 32)]; },
};
