// What is drawn on a canvas, as an SVG drawing: takes the calls that the drawings of pages make.

class SvgContext {
  constructor(w, h) {
    Object.assign(this, { w, h, svg: true, parts: [], stack: [], d: "", clips: 0 });
    Object.assign(this, { fillStyle: "#000", strokeStyle: "#000", lineWidth: 1, lineJoin: "miter", lineCap: "butt", globalAlpha: 1, font: "12px sans-serif", textAlign: "left", textBaseline: "alphabetic", dash: [], transform: "", open: 0 });
    this.ruler = document.createElement("canvas").getContext("2d");
  }

  static STATE = ["fillStyle", "strokeStyle", "lineWidth", "lineJoin", "lineCap", "globalAlpha", "font", "textAlign", "textBaseline", "dash", "transform", "open"];

  save() { this.stack.push(Object.fromEntries(SvgContext.STATE.map((key) => [key, this[key]]))); }
  restore() {
    const before = this.stack.pop();
    for (; this.open > before.open; this.open--) this.parts.push("</g>");
    Object.assign(this, before);
  }
  translate(x, y) { this.transform += `translate(${round(x)} ${round(y)})`; }
  rotate(a) { this.transform += `rotate(${round((a * 360) / TAU)})`; }
  setLineDash(dash) { this.dash = dash; }
  measureText(text) { this.ruler.font = this.font; return this.ruler.measureText(text); }

  beginPath() { this.d = ""; }
  moveTo(x, y) { this.d += `M${round(x)} ${round(y)}`; }
  lineTo(x, y) { this.d += `${this.d ? "L" : "M"}${round(x)} ${round(y)}`; }
  closePath() { this.d += "Z"; }
  rect(x, y, w, h) { this.d += `M${round(x)} ${round(y)}h${round(w)}v${round(h)}h${round(-w)}Z`; }
  roundRect(x, y, w, h, given) {
    const r = Math.min(Math.abs(given), w / 2, h / 2), a = `a${round(r)} ${round(r)} 0 0 1 `;
    this.d += `M${round(x + r)} ${round(y)}h${round(w - 2 * r)}${a}${round(r)} ${round(r)}v${round(h - 2 * r)}${a}${round(-r)} ${round(r)}h${round(2 * r - w)}${a}${round(-r)} ${round(-r)}v${round(2 * r - h)}${a}${round(r)} ${round(-r)}Z`;
  }
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
    this.open++;
  }

  put(tag, attributes, text) {
    const all = { ...attributes, opacity: this.globalAlpha < 1 ? this.globalAlpha : null, transform: this.transform || null };
    const told = Object.entries(all).filter(([, v]) => v !== null).map(([k, v]) => ` ${k}="${escaped(String(v))}"`).join("");
    this.parts.push(text === undefined ? `<${tag}${told}/>` : `<${tag}${told}>${escaped(text)}</${tag}>`);
  }
  pen() {
    return { fill: "none", stroke: this.strokeStyle, "stroke-width": round(this.lineWidth), "stroke-linejoin": this.lineJoin, "stroke-linecap": this.lineCap, "stroke-dasharray": this.dash.length ? this.dash.join(" ") : null };
  }
  stroke() { if (this.d) this.put("path", { d: this.d, ...this.pen() }); }
  fill() { if (this.d) this.put("path", { d: this.d, fill: this.fillStyle }); }
  fillRect(x, y, width, height) { this.put("rect", { x, y, width, height, fill: this.fillStyle }); }
  text(text, x, y, paint) {
    const anchor = { center: "middle", right: "end" }[this.textAlign] ?? "start";
    const size = +/(\d+(?:\.\d+)?)px/.exec(this.font)[1], drop = { middle: 0.35, top: 0.8 }[this.textBaseline] ?? 0;
    this.put("text", { x: round(x), y: round(y + drop * size), "text-anchor": anchor, style: `font:${this.font}`, ...paint }, text);
  }
  fillText(text, x, y) { this.text(text, x, y, { fill: this.fillStyle }); }
  strokeText(text, x, y) { this.text(text, x, y, this.pen()); }

  toString() {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${this.w}" height="${this.h}" viewBox="0 0 ${this.w} ${this.h}">${this.parts.join("")}</svg>\n`;
  }
}

const round = (x) => +x.toFixed(2);
const escaped = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
