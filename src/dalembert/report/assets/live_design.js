// Design of a live page: values of the parameters, locks, history, address.

/** @import { LiveParameter } from "./types.d.ts" */

import { clamp, isNum } from "./numbers.js";
import { Signal } from "./theme.js";

/** Range of a parameter without bounds, relative to its value. */
const SPREAD = 0.5;

export class Design {
  /** @param {LiveParameter[]} parameters */
  constructor(parameters) {
    this.parameters = parameters;
    this.initial = parameters.map(({ value }) => value);
    this.values = [...this.initial];
    this.locked = parameters.map(({ drawn }) => Boolean(drawn));
    /** @type {number[][]} */
    this.past = [];
    /** @type {number[][]} */
    this.future = [];
    /** Emitted with the origin of a change. @type {Signal<string>} */
    this.onChange = new Signal();
    /** Address of the design in the table of the page; null if it is none of them. @type {() => string | null} */
    this.row = () => null;
    /** Design in the address, or the one with which the page was saved. */
    this.values = this.readFrom(location.hash) ?? this.readFrom(document.documentElement.dataset.design ?? "") ?? this.values;
    addEventListener("hashchange", () => { const values = this.readFrom(location.hash); if (values) { this.begin(); this.replace(values, "address"); } });
  }

  /** Lower and upper end of the slider of a parameter. @param {number} k @returns {[number, number]} */
  range(k) {
    const { lower, upper } = this.parameters[k], start = this.initial[k], spread = SPREAD * (Math.abs(start) || 1);
    return [isNum(lower) ? lower : Math.min(start, isNum(upper) ? upper : start) - spread, isNum(upper) ? upper : Math.max(start, isNum(lower) ? lower : start) + spread];
  }

  /** The value within the bounds of a parameter. @param {number} k @param {number} value */
  bounded(k, value) {
    const { lower, upper } = this.parameters[k];
    return clamp(value, isNum(lower) ? lower : -Infinity, isNum(upper) ? upper : Infinity);
  }

  /** Begin a change that undo reverts as a whole. */
  begin() {
    this.past.push([...this.values]);
    this.future = [];
  }

  /** @param {number} k @param {number} value */
  set(k, value) { this.replace(this.values.map((old, i) => (i === k ? value : old)), "set"); }

  /** @param {ArrayLike<number>} values @param {string} origin */
  replace(values, origin) {
    const next = Array.from(values, (value, k) => (isNum(value) ? this.bounded(k, value) : this.values[k]));
    if (next.every((value, k) => value === this.values[k])) return;
    this.values = next;
    this.onChange.emit(origin);
  }

  get changed() { return this.values.some((value, k) => value !== this.initial[k]); }

  reset() {
    if (!this.changed) return;
    this.begin();
    this.replace(this.initial, "reset");
  }

  undo() { this.travel(this.past, this.future); }
  redo() { this.travel(this.future, this.past); }

  /** @param {number[][]} from @param {number[][]} to */
  travel(from, to) {
    let values = from.pop();
    while (values && values.every((value, k) => value === this.values[k])) values = from.pop();
    if (!values) return;
    to.push([...this.values]);
    this.replace(values, "history");
  }

  // Address and texts ------------------------------------------------------------------------------

  /** Name and value of the changed parameters, in SI units. @returns {[string, number][]} */
  get changes() { return this.parameters.flatMap(({ name }, k) => (this.values[k] === this.initial[k] ? [] : [/** @type {[string, number]} */ ([name, this.values[k]])])); }

  get hash() { return this.row() ?? (this.changed ? `#p=${this.changes.map(([name, value]) => `${encodeURIComponent(name)}:${value}`).join(",")}` : ""); }

  /** Values in the text of an address, null without any; unknown names and other texts have no effect. @param {string} address */
  readFrom(address) {
    const text = /^#p=(.*)$/.exec(address)?.[1];
    if (text === undefined) return null;
    const values = [...this.initial];
    for (const part of text.split(",")) {
      const at = part.lastIndexOf(":"), value = /^[-+.\deE]{1,32}$/.test(part.slice(at + 1)) ? Number(part.slice(at + 1)) : NaN;
      const k = this.parameters.findIndex(({ name }) => encodeURIComponent(name) === part.slice(0, at));
      if (k >= 0 && isNum(value)) values[k] = this.bounded(k, value);
    }
    return values;
  }

  /** Show the design in the address, where the browser permits it. */
  write() {
    try { history.replaceState(null, "", this.hash || location.pathname + location.search); } catch { /* pages in frames have no address */ }
  }
}
