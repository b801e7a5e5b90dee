// Dense matrices by rows: orthogonal factors, least squares, eigenvalues and eigenvectors.

/** @typedef {Float64Array<ArrayBuffer>[]} Matrix */

/** @param {number} rows @param {number} columns @returns {Matrix} */
export const zeros = (rows, columns) => Array.from({ length: rows }, () => new Float64Array(columns));

/** Matrix from columns one after the other. @param {ArrayLike<number>} values @param {number} rows @returns {Matrix} */
export const matrixOf = (values, rows) => Array.from({ length: rows }, (_, i) => Float64Array.from({ length: rows ? values.length / rows : 0 }, (_, j) => values[rows * j + i]));

/** @param {Matrix} a @param {number} columns of the matrix, also if it has no rows @returns {Matrix} */
export const transposed = (a, columns) => Array.from({ length: columns }, (_, j) => Float64Array.from(a, (row) => row[j]));

/** @param {Matrix} a @param {Matrix} b @returns {Matrix} */
export function product(a, b) {
  const columns = b[0]?.length ?? 0, result = zeros(a.length, columns);
  for (let i = 0; i < a.length; i++) for (let k = 0; k < b.length; k++) { const x = a[i][k]; if (x) for (let j = 0; j < columns; j++) result[i][j] += x * b[k][j]; }
  return result;
}

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b */
export function dot(a, b) {
  let sum = 0;
  for (let k = 0; k < a.length; k++) sum += a[k] * b[k];
  return sum;
}

/** Product of a matrix and a vector. @param {Matrix} a @param {ArrayLike<number>} x */
export const times = (a, x) => Float64Array.from(a, (row) => dot(row, x));

/** Orthonormal basis of the null space of a matrix with independent rows, as columns, and of the space of its rows: Householder's method.
 * @param {Matrix} a @param {number} n number of its columns @returns {{ free: Matrix, bound: Matrix }} (n, n − m) and (n, m) */
export function spaces(a, n) {
  const m = a.length, r = transposed(a, n), q = zeros(n, n);
  for (let i = 0; i < n; i++) q[i][i] = 1;
  for (let k = 0; k < m; k++) {
    const v = new Float64Array(n);
    let norm = 0;
    for (let i = k; i < n; i++) norm = Math.hypot(norm, (v[i] = r[i][k]));
    if (!norm) continue;
    v[k] += Math.sign(v[k] || 1) * norm;
    let square = 0;
    for (let i = k; i < n; i++) square += v[i] * v[i];
    for (let j = k; j < m; j++) { let s = 0; for (let i = k; i < n; i++) s += v[i] * r[i][j]; s *= 2 / square; for (let i = k; i < n; i++) r[i][j] -= s * v[i]; }
    for (let j = 0; j < n; j++) { let s = 0; for (let i = k; i < n; i++) s += q[j][i] * v[i]; s *= 2 / square; for (let i = k; i < n; i++) q[j][i] -= s * v[i]; }
  }
  return { free: q.map((row) => row.slice(m)), bound: q.map((row) => row.slice(0, m)) };
}

/** Solutions of square systems by elimination with row exchanges. @param {Matrix} a @param {Matrix} b right-hand sides in columns @returns {Matrix} */
export function solved(a, b) {
  const n = a.length, lu = a.map((row) => row.slice()), x = b.map((row) => row.slice());
  for (let k = 0; k < n; k++) {
    let pivot = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(lu[i][k]) > Math.abs(lu[pivot][k])) pivot = i;
    [lu[k], lu[pivot], x[k], x[pivot]] = [lu[pivot], lu[k], x[pivot], x[k]];
    for (let i = k + 1; i < n; i++) {
      const factor = lu[i][k] / lu[k][k];
      if (!factor) continue;
      for (let j = k; j < n; j++) lu[i][j] -= factor * lu[k][j];
      for (let j = 0; j < x[i].length; j++) x[i][j] -= factor * x[k][j];
    }
  }
  for (let k = n - 1; k >= 0; k--) for (let j = 0; j < x[k].length; j++) { for (let i = k + 1; i < n; i++) x[k][j] -= lu[k][i] * x[i][j]; x[k][j] /= lu[k][k]; }
  return x;
}

/** Cholesky's factor of a symmetric matrix; null unless it is positive definite. @param {Matrix} a @returns {Matrix | null} */
export function cholesky(a) {
  const n = a.length, l = zeros(n, n);
  for (let j = 0; j < n; j++) {
    for (let i = j; i < n; i++) {
      let s = a[i][j];
      for (let k = 0; k < j; k++) s -= l[i][k] * l[j][k];
      if (i > j) { l[i][j] = s / l[j][j]; continue; }
      if (!(s > 1e-14 * Math.abs(a[j][j]))) return null;
      l[j][j] = Math.sqrt(s);
    }
  }
  return l;
}

/** Solution of `L x = b`. @param {Matrix} l @param {ArrayLike<number>} b */
export function forward(l, b) {
  const x = Float64Array.from(b);
  for (let i = 0; i < x.length; i++) { for (let k = 0; k < i; k++) x[i] -= l[i][k] * x[k]; x[i] /= l[i][i]; }
  return x;
}

/** Solution of `Lᵀ x = b`. @param {Matrix} l @param {ArrayLike<number>} b */
export function backward(l, b) {
  const x = Float64Array.from(b);
  for (let i = x.length - 1; i >= 0; i--) { for (let k = i + 1; k < x.length; k++) x[i] -= l[k][i] * x[k]; x[i] /= l[i][i]; }
  return x;
}

/** Eigenvalues and orthonormal eigenvectors of a symmetric matrix, by Jacobi's rotations. @param {Matrix} matrix
 * @returns {{ values: Float64Array, vectors: Matrix }} vectors in rows */
export function symmetricEigenpairs(matrix) {
  const n = matrix.length, a = matrix.map((row) => row.slice()), v = zeros(n, n);
  for (let i = 0; i < n; i++) v[i][i] = 1;
  for (let sweep = 0, rotated = true; rotated && sweep < 60; sweep++) {
    rotated = false;
    for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) {
      if (Math.abs(a[p][q]) <= 2 ** -54 * Math.sqrt(Math.abs(a[p][p] * a[q][q])) || !a[p][q]) continue;
      rotated = true;
      const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]), t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1)), c = 1 / Math.hypot(t, 1), s = t * c;
      for (let k = 0; k < n; k++) { const x = a[k][p], y = a[k][q]; a[k][p] = c * x - s * y; a[k][q] = s * x + c * y; }
      for (let k = 0; k < n; k++) { const x = a[p][k], y = a[q][k]; a[p][k] = c * x - s * y; a[q][k] = s * x + c * y; }
      for (let k = 0; k < n; k++) { const x = v[p][k], y = v[q][k]; v[p][k] = c * x - s * y; v[q][k] = s * x + c * y; }
      a[p][q] = a[q][p] = 0;
    }
  }
  return { values: Float64Array.from(a, (row, i) => row[i]), vectors: v };
}
