// Vectors, rotations and rays of the spatial studio; quaternions are Euler parameters, the scalar first.

/** @typedef {number[]} Vec */

/** @param {Vec} a @param {Vec} b */
export const plus = (a, b) => a.map((v, k) => v + b[k]);
/** @param {Vec} a @param {Vec} b */
export const minus = (a, b) => a.map((v, k) => v - b[k]);
/** @param {Vec} a @param {number} s */
export const times = (a, s) => a.map((v) => v * s);
/** @param {Vec} a @param {Vec} b */
export const dot = (a, b) => a.reduce((sum, v, k) => sum + v * b[k], 0);
/** @param {Vec} a @param {Vec} b */
export const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
/** @param {Vec} a */
export const size = (a) => Math.hypot(...a);
/** @param {Vec} a */
export const unit = (a) => times(a, 1 / (size(a) || 1));

/** Axes of the inertial frame. @type {Record<string, Vec>} */
export const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

/** Two directions across a direction, right-handed with it. @param {Vec} normal */
export function across(normal) {
  const least = [0, 1, 2].sort((a, b) => Math.abs(normal[a]) - Math.abs(normal[b]))[0];
  const u = unit(cross(normal, Object.values(AXES)[least]));
  return [u, cross(unit(normal), u)];
}

/** Product of rotations: b, then a. @param {Vec} a @param {Vec} b */
export function product([a, ...u], [b, ...v]) {
  return [a * b - dot(u, v), ...plus(plus(times(v, a), times(u, b)), cross(u, v))];
}

/** @param {Vec} q */
export const inverse = ([w, x, y, z]) => [w, -x, -y, -z];

/** @param {Vec} q @param {Vec} v */
export const turned = (q, v) => product(product(q, [0, ...v]), inverse(q)).slice(1);

/** @param {Vec} axis @param {number} angle [rad] */
export const about = (axis, angle) => [Math.cos(angle / 2), ...times(unit(axis), Math.sin(angle / 2))];

/** Rotation about the common normal that turns one direction into another. @param {Vec} from @param {Vec} to */
export function between(from, to) {
  const [a, b] = [unit(from), unit(to)], cosine = dot(a, b);
  if (cosine < -1 + 1e-12) return about(across(a)[0], Math.PI);
  return unit([1 + cosine, ...cross(a, b)]);
}

/** Axis and angle of a rotation, at most half a turn. @param {Vec} q */
export function axisAngle(q) {
  const [w, ...v] = q[0] < 0 ? times(q, -1) : q, length = size(v);
  return { axis: length > 1e-12 ? times(v, 1 / length) : [0, 0, 1], angle: 2 * Math.atan2(length, w) };
}

/** Rows of the matrix of a rotation. @param {Vec} q @returns {number[][]} */
export function matrix(q) {
  const columns = Object.values(AXES).map((axis) => turned(q, axis));
  return [0, 1, 2].map((row) => columns.map((column) => column[row]));
}

/** Rotation of a matrix. @param {number[][]} m */
export function fromMatrix([[a, b, c], [d, e, f], [g, h, i]]) {
  const parts = [1 + a + e + i, 1 + a - e - i, 1 - a + e - i, 1 - a - e + i], most = parts.indexOf(Math.max(...parts));
  const rows = [[parts[0], h - f, c - g, d - b], [h - f, parts[1], b + d, c + g], [c - g, b + d, parts[2], f + h], [d - b, c + g, f + h, parts[3]]];
  return unit(rows[most]);
}

/** Angles of three successive rotations about body axes, such as zxz; the third is zero where it is not unique.
 * @param {Vec} q @param {string} sequence */
export function euler(q, sequence) {
  const [i, j, last] = [...sequence].map((axis) => "xyz".indexOf(axis)), k = 3 - i - j, m = matrix(q);
  const sign = (j - i + 3) % 3 === 1 ? 1 : -1, proper = last === i;
  const sine = proper ? Math.hypot(m[j][i], m[k][i]) : sign * m[i][k], cosine = proper ? m[i][i] : Math.hypot(m[i][i], m[i][j]);
  const second = Math.atan2(sine, cosine);
  if (Math.abs(proper ? sine : cosine) < 1e-9) return [Math.atan2(sign * m[k][j], m[j][j]), second, 0];
  return proper ? [Math.atan2(m[j][i], -sign * m[k][i]), second, Math.atan2(m[i][j], sign * m[i][k])]
    : [Math.atan2(-sign * m[j][k], m[k][k]), second, Math.atan2(-sign * m[i][j], m[i][i])];
}

/** Point of a plane on a ray; null where they are nearly parallel, or behind the ray's start.
 * @param {{ from: Vec, way: Vec }} ray @param {Vec} place @param {Vec} normal */
export function onPlane({ from, way }, place, normal) {
  const slope = dot(way, normal);
  if (Math.abs(slope) < 0.02) return null;
  const t = dot(minus(place, from), normal) / slope;
  return t > 0 ? plus(from, times(way, t)) : null;
}

/** Coordinate along a line of its point nearest to a ray. @param {{ from: Vec, way: Vec }} ray @param {Vec} place @param {Vec} direction */
export function alongLine({ from, way }, place, direction) {
  const b = dot(way, direction), w = minus(place, from), scale = 1 - b * b;
  return scale < 1e-4 ? null : (b * dot(way, w) - dot(direction, w)) / scale;
}
