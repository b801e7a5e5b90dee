// Which part of the plane is seen, and how a pointer moves it.

class SceneCamera {
  resize() {
    if (this.fitted) this.fit(); else this.invalidate();
  }

  fit() {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const { x0, x1, y0, y1 } = this.followed ? this.motion.envelope([this.motion.cursor]) : this.box;
    this.anchor = null;
    const side = Math.min(60, 0.09 * w), top = 44, bottom = 58;
    this.view.s = Math.max(1e-9, Math.min((w - 2 * side) / (x1 - x0), (h - top - bottom) / (y1 - y0)));
    this.view.x = (x0 + x1) / 2;
    this.view.y = (y0 + y1) / 2 - (bottom - top) / 2 / this.view.s;
    this.fitted = true;
    this.home = this.view.s;
    this.invalidate();
  }

  // The view goes with a body; null lets it stand.
  follow(body) {
    this.followed = body;
    this.fit();
  }

  keepUp() {
    const pose = this.followed && this.poses.get(this.followed);
    if (!pose) return;
    this.anchor ??= [this.view.x - pose.x, this.view.y - pose.y];
    [this.view.x, this.view.y] = [pose.x + this.anchor[0], pose.y + this.anchor[1]];
  }

  shift(dx, dy) {
    this.view.x += dx;
    this.view.y += dy;
    if (this.anchor) { this.anchor[0] += dx; this.anchor[1] += dy; }
  }

  zoom(factor, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
    const before = this.world([px, py]);
    this.view.s = clamp(this.view.s * factor, this.home / 20, this.home * 200);
    const after = this.world([px, py]);
    this.shift(before[0] - after[0], before[1] - after[1]);
    this.fitted = false;
    this.invalidate();
  }

  pan(dx, dy) {
    this.shift(-dx / this.view.s, dy / this.view.s);
    this.fitted = false;
    this.invalidate();
  }

  screen([x, y]) {
    return [this.canvas.clientWidth / 2 + (x - this.view.x) * this.view.s, this.canvas.clientHeight / 2 - (y - this.view.y) * this.view.s];
  }

  world([px, py]) {
    return [this.view.x + (px - this.canvas.clientWidth / 2) / this.view.s, this.view.y - (py - this.canvas.clientHeight / 2) / this.view.s];
  }

  bindPointer() {
    const { canvas } = this;
    const down = new Map();
    const place = (e) => { const r = canvas.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      this.zoom(Math.exp(-clamp(e.deltaY * (e.deltaMode ? 30 : 1), -300, 300) * 0.0016), ...place(e));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (e) => {
      down.set(e.pointerId, place(e));
      canvas.setPointerCapture(e.pointerId);
      this.pointer = place(e);
      this.invalidate();
    });
    canvas.addEventListener("pointermove", (e) => {
      const now = place(e), was = down.get(e.pointerId);
      if (was) {
        const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
        if (other) {
          const ratio = Math.hypot(now[0] - other[0], now[1] - other[1]) / Math.max(1, Math.hypot(was[0] - other[0], was[1] - other[1]));
          this.zoom(ratio, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
        } else this.pan(now[0] - was[0], now[1] - was[1]);
        down.set(e.pointerId, now);
        canvas.classList.add("grabbing");
      }
      this.pointer = now;
      this.invalidate();
    });
    const up = (e) => { down.delete(e.pointerId); if (!down.size) canvas.classList.remove("grabbing"); };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("pointerleave", (e) => { if (e.pointerType === "mouse") { this.pointer = null; this.invalidate(); } });
    canvas.addEventListener("dblclick", () => this.fit());
    document.addEventListener("pointerdown", (e) => { if (e.target !== canvas) { this.pointer = null; this.invalidate(); } });
  }
}
