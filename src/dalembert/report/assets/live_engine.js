// WebAssembly module of a live page: memory, mathematical functions of the C library, calls.

/** @import { LiveData, LiveFunction } from "./types.d.ts" */

const PAGE = 65536, STACK = 262144;

/** Series of the error function (Abramowitz and Stegun 7.1.6), and its continued fraction (7.1.14). @param {number} x */
function erf(x) {
  const a = Math.abs(x), gauss = Math.exp(-a * a);
  if (!(a < 6)) return a >= 6 ? Math.sign(x) : x;
  if (a < 1) {
    let term = a, sum = a;
    for (let n = 1; term > 1e-18 * sum; n++) sum += term *= (2 * a * a) / (2 * n + 1);
    return Math.sign(x) * (2 / Math.sqrt(Math.PI)) * gauss * sum;
  }
  let fraction = a;
  for (let n = 250; n > 0; n--) fraction = a + n / 2 / fraction;
  return Math.sign(x) * (1 - gauss / (Math.sqrt(Math.PI) * fraction));
}

/** Remainder with the quotient rounded to the nearest integer, ties to even. @param {number} x @param {number} y */
function remainder(x, y) {
  const size = Math.abs(y), rest = Math.abs(x) % (2 * size);
  const near = rest > 1.5 * size ? rest - 2 * size : rest > 0.5 * size && !(rest === 1.5 * size) ? rest - size : rest === 1.5 * size ? -0.5 * size : rest;
  return x < 0 ? -near : near;
}

/** Functions of the C library by their names; a maximum ignores NaN. @type {Record<string, (x: number, y: number) => number>} */
export const LIBRARY = {
  ...Object.fromEntries(["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp", "expm1", "log", "log1p", "pow", "hypot"].map((name) => [name, /** @type {any} */ (Math)[name]])),
  erf, remainder,
  fmod: (x, y) => x % y,
  fmin: (x, y) => (x !== x ? y : y !== y ? x : Math.min(x, y)),
  fmax: (x, y) => (x !== x ? y : y !== y ? x : Math.max(x, y)),
};

/** Function of a module with its work vectors.
 * @typedef {LiveFunction & { run: (...addresses: (number | bigint)[]) => bigint }} Callable */

/** Instance of a module. Arrays of a call lie in memory after `mark`, which frees them. */
export class Engine {
  /** @param {WebAssembly.Module} module @param {LiveData} data */
  constructor(module, data) {
    this.memory = new WebAssembly.Memory({ initial: Math.ceil((data.memory + 2 * STACK) / PAGE) });
    const stack = Math.ceil(data.memory / 16) * 16 + STACK;
    const pointer = new WebAssembly.Global({ value: "i32", mutable: true }, stack);
    const table = new WebAssembly.Table({ initial: 4096, element: "anyfunc" });
    const env = { ...LIBRARY, __linear_memory: this.memory, __stack_pointer: pointer, __indirect_function_table: table };
    const { exports } = new WebAssembly.Instance(module, { env: /** @type {any} */ (env) });
    /** @type {Map<string, Callable>} */
    this.functions = new Map(Object.entries(data.functions).map(([name, sizes]) => [name, { ...sizes, run: /** @type {any} */ (exports)[`dalembert_${name}`] }]));
    this.top = stack;
    this.bytes = this.memory.buffer.byteLength;
  }

  /** Address of `count` numbers of 8 bytes. @param {number} count */
  room(count) {
    const at = this.top;
    this.top += 8 * count;
    if (this.top > this.bytes) {
      this.memory.grow(Math.ceil((this.top - this.bytes) / PAGE) + 16);
      this.bytes = this.memory.buffer.byteLength;
    }
    return at;
  }

  /** Numbers at an address; valid until the memory grows. @param {number} at @param {number} count */
  view(at, count) { return new Float64Array(this.memory.buffer, at, count); }

  /** Address of a copy of numbers. @param {ArrayLike<number>} values */
  put(values) {
    const at = this.room(values.length);
    this.view(at, values.length).set(values);
    return at;
  }

  /** @param {string} name */
  named(name) {
    const callable = this.functions.get(name);
    if (!callable) throw new Error(`the module has no function ${name}`);
    return callable;
  }

  /** Evaluate a function for columns of arguments.
   * @param {string} name
   * @param {number} count number of columns
   * @param {number[]} from addresses of the arguments
   * @param {Set<number> | null} fixed arguments that all columns share
   * @param {boolean} carried whether the first result is the first argument of the next column, stored after it
   * @returns {{ done: number, to: number[] }} number of columns before the first failure, addresses of the results */
  call(name, count, from, fixed = null, carried = false) {
    const { inputs, outputs, work: [arg, res, iw, w], run } = this.named(name);
    const to = outputs.map((size, k) => (carried && k === 0 ? from[0] + 8 * inputs[0] : this.room(size * count)));
    const places = from.length + to.length, addresses = this.room(places + 1), strides = this.room(places);
    const workspace = [this.room(arg), this.room(res), this.room(iw), this.room(w)];
    const pointers = new Uint32Array(this.memory.buffer, addresses, places), steps = new BigInt64Array(this.memory.buffer, strides, places);
    pointers.set([...from, ...to]);
    [...inputs.map((size, k) => (fixed?.has(k) ? 0 : size)), ...outputs].forEach((size, k) => { steps[k] = BigInt(size); });
    const done = run(BigInt(count), BigInt(from.length), BigInt(to.length), addresses, strides, addresses + 4 * from.length, strides + 8 * from.length, ...workspace);
    return { done: Number(done), to };
  }

  /** Results of one evaluation, as copies; null if it fails. @param {string} name @param {ArrayLike<number>[]} values */
  evaluate(name, ...values) {
    const mark = this.top, { done, to } = this.call(name, 1, values.map((value) => this.put(value)));
    const { outputs } = this.named(name), results = to.map((at, k) => this.view(at, outputs[k]).slice());
    this.top = mark;
    return done ? results : null;
  }
}
