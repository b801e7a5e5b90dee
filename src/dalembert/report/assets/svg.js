// Context of a canvas that writes SVG.

import { contextOf } from "./canvas.js";
import { TAU } from "./numbers.js";

/** @param {number} x */
const round = (x) => +x.toFixed(2);

/** @param {string} text */
const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

const STATE = /** @type {const} */ (["fillStyle", "strokeStyle", "lineWidth", "lineJoin", "lineCap", "globalAlpha", "font", "textAlign", "textBaseline", "dash", "transform", "groups"]);

export class SvgContext {
  /** @param {number} w @param {number} h */
  constructor(w, h) {
    this.w = w;
    this.h = h;
    this.svg = true;
    /** @type {string[]} */
    this.parts = [];
    /** @type {Partial<SvgContext>[]} */
    this.stack = [];
    /** Path. */
    this.d = "";
    this.clips = 0;
    this.fillStyle = this.strokeStyle = "#000";
    this.lineWidth = 1;
    /** @type {CanvasLineJoin} */
    this.lineJoin = "miter";
    /** @type {CanvasLineCap} */
    this.lineCap = "butt";
    this.globalAlpha = 1;
    this.font = "12px sans-serif";
    /** @type {CanvasTextAlign} */
    this.textAlign = "left";
    /** @type {CanvasTextBaseline} */
    this.textBaseline = "alphabetic";
    /** @type {number[]} */
    this.dash = [];
    this.transform = "";
    /** Open groups. */
    this.groups = 0;
    this.ruler = contextOf(document.createElement("canvas"));
  }

  save() { this.stack.push(Object.fromEntries(STATE.map((key) => [key, this[key]]))); }
  restore() {
    const state = this.stack.pop() ?? {};
    for (; this.groups > (state.groups ?? 0); this.groups--) this.parts.push("</g>");
    Object.assign(this, state);
  }
  /** @param {number} x @param {number} y */
  translate(x, y) { this.transform += `translate(${round(x)} ${round(y)})`; }
  /** @param {number} angle */
  rotate(angle) { this.transform += `rotate(${round((angle * 360) / TAU)})`; }
  /** @param {number[]} dash */
  setLineDash(dash) { this.dash = dash; }
  /** @param {string} text */
  measureText(text) { this.ruler.font = this.font; return this.ruler.measureText(text); }

  beginPath() { this.d = ""; }
  /** @param {number} x @param {number} y */
  moveTo(x, y) { this.d += `M${round(x)} ${round(y)}`; }
  /** @param {number} x @param {number} y */
  lineTo(x, y) { this.d += `${this.d ? "L" : "M"}${round(x)} ${round(y)}`; }
  closePath() { this.d += "Z"; }
  /** @param {number} x @param {number} y @param {number} w @param {number} h */
  rect(x, y, w, h) { this.d += `M${round(x)} ${round(y)}h${round(w)}v${round(h)}h${round(-w)}Z`; }
  /** @param {number} x @param {number} y @param {number} w @param {number} h @param {number} radius */
  roundRect(x, y, w, h, radius) {
    const r = round(Math.min(Math.abs(radius), w / 2, h / 2)), a = `a${r} ${r} 0 0 1 `, [side, height] = [round(w - 2 * r), round(h - 2 * r)];
    this.d += `M${round(x + r)} ${round(y)}h${side}${a}${r} ${r}v${height}${a}${-r} ${r}h${-side}${a}${-r} ${-r}v${-height}${a}${r} ${-r}Z`;
  }
  /** @param {number} x @param {number} y @param {number} r @param {number} from @param {number} to */
  arc(x, y, r, from, to, back = false) {
    const whole = Math.abs(to - from) >= TAU - 1e-9;
    let sweep = whole ? (back ? -TAU : TAU) : (to - from) % TAU;
    if (!whole && back && sweep > 0) sweep -= TAU;
    if (!whole && !back && sweep < 0) sweep += TAU;
    this.lineTo(x + r * Math.cos(from), y + r * Math.sin(from));
    for (const k of whole ? [0.5, 1] : [1]) {
      const end = from + k * sweep, large = !whole && Math.abs(sweep) > TAU / 2;
      this.d += `A${round(r)} ${round(r)} 0 ${+large} ${+(sweep > 0)} ${round(x + r * Math.cos(end))} ${round(y + r * Math.sin(end))}`;
    }
  }
  clip() {
    this.parts.push(`<clipPath id="clip${++this.clips}"><path d="${this.d}" transform="${this.transform}"/></clipPath><g clip-path="${"url"}(#clip${this.clips})">`);
    this.groups++;
  }

  /** @param {string} tag @param {Record<string, string | number | null>} attributes @param {string} [text] */
  put(tag, attributes, text) {
    const all = { ...attributes, opacity: this.globalAlpha < 1 ? this.globalAlpha : null, transform: this.transform || null };
    const listed = Object.entries(all).filter(([, value]) => value !== null).map(([key, value]) => ` ${key}="${escaped(String(value))}"`).join("");
    this.parts.push(text === undefined ? `<${tag}${listed}/>` : `<${tag}${listed}>${escaped(text)}</${tag}>`);
  }
  pen() {
    return { fill: "none", stroke: this.strokeStyle, "stroke-width": round(this.lineWidth), "stroke-linejoin": this.lineJoin, "stroke-linecap": this.lineCap, "stroke-dasharray": this.dash.length ? this.dash.join(" ") : null };
  }
  stroke() { if (this.d) this.put("path", { d: this.d, ...this.pen() }); }
  fill() { if (this.d) this.put("path", { d: this.d, fill: this.fillStyle }); }
  /** @param {number} x @param {number} y @param {number} width @param {number} height */
  fillRect(x, y, width, height) { this.put("rect", { x, y, width, height, fill: this.fillStyle }); }
  /** @param {string} text @param {number} x @param {number} y @param {Record<string, string | number | null>} paint */
  text(text, x, y, paint) {
    const anchor = this.textAlign === "center" ? "middle" : this.textAlign === "right" ? "end" : "start";
    const size = +(/(\d+(?:\.\d+)?)px/.exec(this.font)?.[1] ?? 12), drop = this.textBaseline === "middle" ? 0.35 : this.textBaseline === "top" ? 0.8 : 0;
    this.put("text", { x: round(x), y: round(y + drop * size), "text-anchor": anchor, style: `font:${this.font}`, ...paint }, text);
  }
  /** @param {string} text @param {number} x @param {number} y */
  fillText(text, x, y) { this.text(text, x, y, { fill: this.fillStyle }); }
  /** @param {string} text @param {number} x @param {number} y */
  strokeText(text, x, y) { this.text(text, x, y, this.pen()); }

  toString() {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${this.w}" height="${this.h}" viewBox="0 0 ${this.w} ${this.h}">${this.parts.join("")}</svg>\n`;
  }
}
