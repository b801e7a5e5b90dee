// From where a structure is seen, and how a pointer moves that.

class StructureCamera {
  // Flat coordinates and depth of places; seen from the front, or turned about z and then tilted.
  projected(places) {
    const out = new Float64Array(places.length);
    if (!this.turn) {
      out.set(places);
      return out;
    }
    const [ca, sa, cb, sb] = [Math.cos(this.turn.a), Math.sin(this.turn.a), Math.cos(this.turn.b), Math.sin(this.turn.b)];
    for (let i = 0; i < places.length; i += 3) {
      const x = ca * places[i] - sa * places[i + 1], y = sa * places[i] + ca * places[i + 1], z = places[i + 2];
      out[i] = x;
      out[i + 1] = cb * y - sb * z;
      out[i + 2] = sb * y + cb * z;
    }
    return out;
  }

  way(vector) { return this.projected(Float64Array.from(vector)); }

  box(places) {
    const columns = [0, 1].map((axis) => Float64Array.from({ length: places.length / 3 }, (_, k) => places[3 * k + axis]));
    return columns.map((c) => extent([c]) || [0, 1]);
  }

  fit() {
    const { structure } = this;
    const both = [this.projected(structure.rest), this.projected(structure.places())];
    const boxes = both.map((p) => this.box(p));
    const [[x0, x1], [y0, y1]] = [0, 1].map((axis) => [Math.min(...boxes.map((b) => b[axis][0])), Math.max(...boxes.map((b) => b[axis][1]))]);
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const room = Math.min(110, (w < 760 ? 0.12 : 0.2) * Math.min(w, h));
    const side = w < 760 && this.beside ? this.beside.offsetWidth : 0;  // of the colours
    const s = Math.min((w - side - 2 * room) / Math.max(x1 - x0, 1e-12), (h - 2 * room) / Math.max(y1 - y0, 1e-12));
    const factor = s > 0 && Number.isFinite(s) ? s : 1;
    this.view = { s: factor, x: (x0 + x1) / 2 - side / 2 / factor, y: (y0 + y1) / 2 };
    this.fitted = true;
    this.invalidate();
  }

  zoom(factor, at = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2]) {
    const { view, canvas } = this;
    const [dx, dy] = [(at[0] - canvas.clientWidth / 2) / view.s, (canvas.clientHeight / 2 - at[1]) / view.s];
    view.x += dx * (1 - 1 / factor);
    view.y += dy * (1 - 1 / factor);
    view.s *= factor;
    this.fitted = false;
    this.invalidate();
  }

  resize() {
    if (this.fitted) this.fit();
    else this.invalidate();
  }

  invalidate() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  bindPointer() {
    const { canvas } = this;
    let last = null;
    const at = (e) => { const box = canvas.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; };
    canvas.addEventListener("pointerdown", (e) => { last = at(e); canvas.setPointerCapture(e.pointerId); canvas.classList.add("grabbing"); this.tip.hidden = true; });
    canvas.addEventListener("pointermove", (e) => {
      const here = at(e);
      if (!last) { this.hover(here); return; }
      this.drag(here[0] - last[0], here[1] - last[1], e.shiftKey);
      last = here;
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; canvas.classList.remove("grabbing"); });
    canvas.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.zoom(Math.exp(-0.0015 * e.deltaY), at(e)); }, { passive: false });
    canvas.addEventListener("dblclick", () => this.fit());
  }

  drag(dx, dy, pan) {
    if (this.turn && !pan) {
      this.turn.a += 0.008 * dx;
      this.turn.b = clamp(this.turn.b + 0.008 * dy, -Math.PI, 0);
    } else {
      this.view.x -= dx / this.view.s;
      this.view.y += dy / this.view.s;
      this.fitted = false;
    }
    this.invalidate();
  }
}
