// Complex linear systems by elimination with row exchanges.

/** Complex vector, real and imaginary part. @typedef {[Float64Array, Float64Array]} Vector */

/** Factors `P A = L U` of a complex matrix, whose entries are stored by rows. */
export class ComplexFactors {
  /** @param {Float64Array} re entries, which the factors replace @param {Float64Array} im @param {number} n */
  constructor(re, im, n) {
    this.re = re;
    this.im = im;
    this.order = Int32Array.from({ length: n }, (_, k) => k);
    for (let k = 0; k < n; k++) {
      let pivot = k, most = -1;
      for (let i = k; i < n; i++) { const size = Math.abs(re[n * i + k]) + Math.abs(im[n * i + k]); if (size > most) [pivot, most] = [i, size]; }
      if (pivot !== k) this.exchange(k, pivot, n);
      const a = re[n * k + k], b = im[n * k + k], size = a * a + b * b;
      for (let i = k + 1; i < n; i++) {
        const c = re[n * i + k], d = im[n * i + k];
        if (!c && !d) continue;
        const f = (c * a + d * b) / size, g = (d * a - c * b) / size;
        re[n * i + k] = f;
        im[n * i + k] = g;
        for (let j = k + 1, p = n * i + k + 1, q = n * k + k + 1; j < n; j++, p++, q++) {
          const x = re[q], y = im[q];
          if (!x && !y) continue;
          re[p] -= f * x - g * y;
          im[p] -= f * y + g * x;
        }
      }
    }
  }

  /** @param {number} k @param {number} l @param {number} n */
  exchange(k, l, n) {
    const { re, im, order } = this;
    for (const part of [re, im]) {
      const row = part.slice(n * k, n * (k + 1));
      part.copyWithin(n * k, n * l, n * (l + 1));
      part.set(row, n * l);
    }
    [order[k], order[l]] = [order[l], order[k]];
  }

  /** Solution of `A x = b`. @param {Vector} b @returns {Vector} */
  solve([b, c]) {
    const { order } = this, n = order.length, x = Float64Array.from(order, (k) => b[k]), y = Float64Array.from(order, (k) => c[k]);
    for (let i = 0; i < n; i++) this.eliminate(x, y, i, 0, i, (j) => n * i + j);
    for (let i = n - 1; i >= 0; i--) { this.eliminate(x, y, i, i + 1, n, (j) => n * i + j); this.divide(x, y, i); }
    return [x, y];
  }

  /** Solution of `Aᵀ x = b`. @param {Vector} b @returns {Vector} */
  solveTransposed([b, c]) {
    const { order } = this, n = order.length, x = Float64Array.from(b), y = Float64Array.from(c);
    for (let i = 0; i < n; i++) { this.eliminate(x, y, i, 0, i, (j) => n * j + i); this.divide(x, y, i); }
    for (let i = n - 1; i >= 0; i--) this.eliminate(x, y, i, i + 1, n, (j) => n * j + i);
    const result = /** @type {Vector} */ ([new Float64Array(n), new Float64Array(n)]);
    order.forEach((k, i) => { result[0][k] = x[i]; result[1][k] = y[i]; });
    return result;
  }

  /** Subtract the products of earlier entries from entry `i`. @param {Float64Array} x @param {Float64Array} y @param {number} i @param {number} from @param {number} to @param {(j: number) => number} at */
  eliminate(x, y, i, from, to, at) {
    const { re, im } = this;
    for (let j = from; j < to; j++) {
      const a = re[at(j)], b = im[at(j)];
      x[i] -= a * x[j] - b * y[j];
      y[i] -= a * y[j] + b * x[j];
    }
  }

  /** Divide entry `i` by the pivot. @param {Float64Array} x @param {Float64Array} y @param {number} i */
  divide(x, y, i) {
    const n = this.order.length, a = this.re[n * i + i], b = this.im[n * i + i], size = a * a + b * b;
    [x[i], y[i]] = [(x[i] * a + y[i] * b) / size, (y[i] * a - x[i] * b) / size];
  }
}
