// Eigenvalues of general real matrices, and eigenvectors by inverse iteration.

/** @import { Matrix } from "./live_matrix.js" */

import { solved, zeros } from "./live_matrix.js";

const EPSILON = 2 ** -52, LIMIT = 60;

/** Complex vector, real and imaginary part. @typedef {[Float64Array, Float64Array]} Vector */

/** Hessenberg form of a matrix, by orthogonal similarity. @param {Matrix} a @returns {Matrix} */
function hessenberg(a) {
  const n = a.length, h = a.map((row) => row.slice()), v = new Float64Array(n);
  for (let m = 1; m < n - 1; m++) {
    let norm = 0, square = 0;
    for (let i = m; i < n; i++) norm = Math.hypot(norm, (v[i] = h[i][m - 1]));
    if (!norm) continue;
    v[m] += Math.sign(v[m] || 1) * norm;
    for (let i = m; i < n; i++) square += v[i] * v[i];
    for (let j = m - 1; j < n; j++) { let s = 0; for (let i = m; i < n; i++) s += v[i] * h[i][j]; s *= 2 / square; for (let i = m; i < n; i++) h[i][j] -= s * v[i]; }
    for (let i = 0; i < n; i++) { let s = 0; for (let j = m; j < n; j++) s += v[j] * h[i][j]; s *= 2 / square; for (let j = m; j < n; j++) h[i][j] -= s * v[j]; }
    for (let i = m + 1; i < n; i++) h[i][m - 1] = 0;
  }
  return h;
}

/** Diagonal similarity by powers of two, so that rows and columns have similar sizes. @param {Matrix} a */
function balance(a) {
  const n = a.length;
  for (let changed = true; changed; ) {
    changed = false;
    for (let i = 0; i < n; i++) {
      let row = 0, column = 0, factor = 1;
      for (let j = 0; j < n; j++) if (j !== i) { row += Math.abs(a[i][j]); column += Math.abs(a[j][i]); }
      if (!row || !column) continue;
      const sum = row + column;
      while (column < row / 2) { factor *= 2; column *= 4; }
      while (column >= row * 2) { factor /= 2; column /= 4; }
      if ((column + row) / factor >= 0.95 * sum) continue;
      changed = true;
      for (let j = 0; j < n; j++) a[i][j] /= factor;
      for (let j = 0; j < n; j++) a[j][i] *= factor;
    }
  }
  return a;
}

/** Eigenvalues of a real matrix by the shifted QR algorithm of Francis, conjugate pairs as neighbours (EISPACK, hqr).
 * @param {Matrix} a @returns {[number, number][] | null} real and imaginary parts; null if the iteration fails */
export function eigenvalues(a) {
  const h = hessenberg(balance(a.map((row) => row.slice()))), size = h.length;
  if (!h.every((row) => row.every(Number.isFinite))) return null;
  /** @type {[number, number][]} */ const values = Array.from({ length: size }, () => [0, 0]);
  let norm = 0, shift = 0, n = size - 1, count = 0;
  for (let i = 0; i < size; i++) for (let j = Math.max(i - 1, 0); j < size; j++) norm += Math.abs(h[i][j]);
  while (n >= 0) {
    let l = n;
    for (; l > 0; l--) {
      const s = Math.abs(h[l - 1][l - 1]) + Math.abs(h[l][l]) || norm;
      if (Math.abs(h[l][l - 1]) < EPSILON * s) { h[l][l - 1] = 0; break; }
    }
    let x = h[n][n];
    if (l === n) { values[n--] = [x + shift, 0]; count = 0; continue; }
    let y = h[n - 1][n - 1], w = h[n][n - 1] * h[n - 1][n];
    if (l === n - 1) {
      const p = (y - x) / 2, q = p * p + w, root = Math.sqrt(Math.abs(q));
      x += shift;
      if (q >= 0) {
        const z = p + (p >= 0 ? root : -root);
        values[n - 1] = [x + z, 0];
        values[n] = [z ? x - w / z : x + z, 0];
      } else {
        values[n - 1] = [x + p, root];
        values[n] = [x + p, -root];
      }
      n -= 2;
      count = 0;
      continue;
    }
    if (count === LIMIT) return null;
    if (count && count % 10 === 0) {
      shift += x;
      for (let i = 0; i <= n; i++) h[i][i] -= x;
      const s = Math.abs(h[n][n - 1]) + Math.abs(h[n - 1][n - 2]);
      x = y = 0.75 * s;
      w = -0.4375 * s * s;
    }
    count++;
    swept(h, l, n, x, y, w);
  }
  return values;
}

/** Double step with implicit shifts on the rows `l` to `n`. @param {Matrix} h @param {number} l @param {number} n @param {number} x @param {number} y @param {number} w */
function swept(h, l, n, x, y, w) {
  let m = n - 2, p = 0, q = 0, r = 0;
  for (; ; m--) {
    const z = h[m][m], u = x - z, v = y - z;
    p = (u * v - w) / h[m + 1][m] + h[m][m + 1];
    q = h[m + 1][m + 1] - z - u - v;
    r = h[m + 2][m + 1];
    const s = Math.abs(p) + Math.abs(q) + Math.abs(r);
    [p, q, r] = [p / s, q / s, r / s];
    if (m === l || Math.abs(h[m][m - 1]) * (Math.abs(q) + Math.abs(r)) < EPSILON * Math.abs(p) * (Math.abs(h[m - 1][m - 1]) + Math.abs(z) + Math.abs(h[m + 1][m + 1]))) break;
  }
  for (let i = m + 2; i <= n; i++) { h[i][i - 2] = 0; if (i > m + 2) h[i][i - 3] = 0; }
  for (let k = m; k < n; k++) {
    const inner = k !== n - 1;
    let scale = 1;
    if (k !== m) {
      [p, q, r] = [h[k][k - 1], h[k + 1][k - 1], inner ? h[k + 2][k - 1] : 0];
      scale = Math.abs(p) + Math.abs(q) + Math.abs(r);
      if (!scale) continue;
      [p, q, r] = [p / scale, q / scale, r / scale];
    }
    const s = Math.sign(p || 1) * Math.sqrt(p * p + q * q + r * r);
    if (k !== m) h[k][k - 1] = -s * scale; else if (l !== m) h[k][k - 1] = -h[k][k - 1];
    p += s;
    const [a, b, c] = [p / s, q / s, r / s], [d, e] = [q / p, r / p];
    for (let j = k; j < h.length; j++) {
      const sum = h[k][j] + d * h[k + 1][j] + (inner ? e * h[k + 2][j] : 0);
      h[k][j] -= sum * a;
      h[k + 1][j] -= sum * b;
      if (inner) h[k + 2][j] -= sum * c;
    }
    for (let i = 0; i <= Math.min(n, k + 3); i++) {
      const sum = a * h[i][k] + b * h[i][k + 1] + (inner ? c * h[i][k + 2] : 0);
      h[i][k] -= sum;
      h[i][k + 1] -= sum * d;
      if (inner) h[i][k + 2] -= sum * e;
    }
  }
}

/** Eigenvector of an eigenvalue, of length one, by inverse iteration.
 * @param {Matrix} a @param {[number, number]} value @param {number} [start] number of the start, on which the vector of a multiple eigenvalue depends @returns {Vector} */
export function eigenvector(a, [re, im], start = 0) {
  const n = a.length, size = Math.max(...a.map((row) => row.reduce((sum, x) => sum + Math.abs(x), 0)), Number.MIN_VALUE);
  for (let distance = 8 * EPSILON; distance < 1e-6; distance *= 8) {  // exactly singular matrices have no inverse
    const vector = inverseIteration(a, re + distance * size, im, start);
    if (vector.every((part) => part.every(Number.isFinite))) return vector;
  }
  return [new Float64Array(n).fill(NaN), new Float64Array(n)];
}

/** @param {Matrix} a @param {number} near @param {number} im @param {number} start @returns {Vector} */
function inverseIteration(a, near, im, start) {
  const n = a.length, real = !im, m = real ? n : 2 * n, matrix = zeros(m, m);
  for (let i = 0; i < n; i++) {
    matrix[i].set(a[i]);
    matrix[i][i] -= near;
    if (real) continue;
    matrix[n + i].set(a[i], n);
    matrix[n + i][n + i] -= near;
    matrix[i][n + i] = im;
    matrix[n + i][i] = -im;
  }
  let x = Array.from({ length: m }, (_, i) => Float64Array.of(1 + Math.sin((7 + start) * i) * (0.5 + start)));
  for (let k = 0; k < 3; k++) {
    x = solved(matrix, x);
    const length = Math.hypot(...x.map(([value]) => value));
    for (const entry of x) entry[0] /= length;
  }
  return [Float64Array.from({ length: n }, (_, i) => x[i][0]), Float64Array.from({ length: n }, (_, i) => (real ? 0 : x[n + i][0]))];
}
