// What is written over the drawing in space: names, axes, gravity, time, scales of arrows.

class Overlay {
  constructor(scene) {
    this.scene = scene;
    this.canvas = el("canvas", { class: "overlay", id: "overlay", "aria-hidden": "true" });
    scene.canvas.after(this.canvas);
    this.anchors = new Map(scene.motion.bodies.map((body) => {
      const marks = body.shapes.flatMap(reach), n = marks.length || 1;
      return [body, [0, 1, 2].map((k) => marks.reduce((sum, p) => sum + p[k], 0) / n)];
    }));
  }

  draw(ratio) {
    Object.assign(this, fitCanvas(this.canvas, ratio));
    const { scene } = this;
    if (scene.show.labels) this.drawLabels();
    if (scene.show.labels) this.readLoads();
    this.drawGaps();
    this.drawAxes();
    this.drawTime();
    if (scene.show.forces) this.drawScales();
    if (scene.view.renderer instanceof Painter) {
      this.ctx.font = `12px ${Theme.font}`;
      label(this.ctx, "Drawn without WebGL (unavailable or disabled in this browser): no shadows.", [this.w / 2, 16], Theme.muted, Theme.surface);
    }
  }

  seen(place) { return place && this.scene.view.screen(vector(place)); }

  // Names of bodies at their middles, of joints beside them; the nearer one has the word where two would meet.
  drawLabels() {
    const { ctx, scene } = this, { motion } = scene, taken = [];
    const small = motion.joints.filter((j) => j.name && j.name.length <= 3);
    const wanted = [
      ...motion.bodies.filter((body) => body.label).map((body) => ({ text: body.label, at: this.seen(motion.at(body, this.anchors.get(body))), font: `600 12px ${Theme.font}`, colour: mix(Theme.colour(body.index), Theme.ink, 0.35), lift: 0 })),
      ...(small.length > 24 ? [] : small).map((j) => ({ text: j.name, at: this.seen(motion.placeOf(j)), font: `italic 12px ${Theme.font}`, colour: Theme.muted, lift: 1 })),
    ].filter(({ at }) => at).sort((a, b) => a.lift - b.lift || a.at.depth - b.at.depth);
    for (const { text, at, font, colour, lift } of wanted) {
      ctx.font = font;
      const wide = ctx.measureText(text).width / 2, r = clamp(2.4 * scene.unit * at.scale, 6, 40);
      const places = lift ? [[-r - wide, -r], [r + wide, -r], [-r - wide, r], [r + wide, r]] : [[0, -r - 8], [0, r + 8], [r + wide + 4, 0], [-r - wide - 4, 0]];
      const free = places.map(([dx, dy]) => [at.x + dx, at.y + dy]).find(([x, y]) => !taken.some((t) => Math.abs(t.x - x) < t.wide + wide + 4 && Math.abs(t.y - y) < 15));
      if (!free) continue;
      taken.push({ x: free[0], y: free[1], wide });
      label(ctx, text, free, colour, Theme.surface);
    }
  }

  // Values of the loads, at the heads of their arrows.
  readLoads() {
    const { ctx, scene } = this, shown = scene.arrows.filter(({ shown: { read } }) => read);
    if (shown.length > 2 * READABLE) return;
    ctx.font = `600 11px ${Theme.font}`;
    for (const { role, shown: { read } } of shown) {
      const at = this.seen(read.at);
      if (at) label(ctx, loadText(role, read.value), [at.x + 4, at.y - 12], LOADS[role].reaction ? Theme[role] : Theme.ink, Theme.surface, "left");
    }
  }

  drawGaps() {
    const { ctx, scene } = this;
    for (const { from, to, text } of scene.motion.gaps) {
      const [p, q] = [from, to].map((v) => scene.view.screen(vector(v)));
      if (!p || !q) continue;
      trace(ctx, [[p.x, p.y], [q.x, q.y]]);
      stroke(ctx, Theme.error, 2.4, [6, 4]);
      for (const { x, y } of [p, q]) { circle(ctx, [x, y], 4); ctx.fillStyle = Theme.error; ctx.fill(); }
      ctx.font = `600 12px ${Theme.font}`;
      label(ctx, text, [(p.x + q.x) / 2, (p.y + q.y) / 2 - 14], Theme.error, Theme.surface);
    }
  }

  // The inertial axes, and gravity, as they are seen, in a corner.
  drawAxes() {
    const { ctx, h, scene } = this, c = [52, h - 52], size = 32;
    const seen = (v) => vector(v).transformDirection(scene.view.camera.matrixWorldInverse);
    const axes = Object.entries(AXES).map(([name, v], k) => ({ name, way: seen(v), colour: AXIS_COLOURS[Theme.name][k] }));
    if (scene.motion.gravity) axes.push({ name: "g", way: seen(scene.motion.gravity), colour: Theme.muted });
    for (const { name, way, colour } of axes.sort((a, b) => a.way.z - b.way.z)) {
      const [u, v] = [size * way.x, -size * way.y];
      if (name === "g") arrow(ctx, [c[0] + 62, c[1] - v / 2], [u, v], colour, Theme.surface, 1.8);
      else arrow(ctx, c, [u, v], colour, Theme.surface, 2.4);
      ctx.font = `${name === "g" ? "italic" : "600"} 12px ${Theme.font}`;
      const at = name === "g" ? [c[0] + 78, c[1]] : [c[0] + 1.36 * u, c[1] + 1.36 * v];
      label(ctx, name, at, name === "g" ? Theme.muted : colour, Theme.surface);
    }
  }

  drawTime() {
    const { ctx, w, scene: { motion, view, ratio } } = this, ink = mix(Theme.ink, Theme.surface, 0.2);
    ctx.font = `12px ${Theme.font}`;
    if (ratio && motion.moves) label(ctx, `t = ${clock(motion.now, motion.span)} s`, [w - 16, 24], ink, Theme.surface, "right");
    if (this.scene.show.grid) label(ctx, `grid ${metres(view.step)}`, [16, this.h - 12], Theme.muted, Theme.surface, "left");
  }

  drawScales() {
    const { ctx, w, h, scene } = this, { greatest } = scene, ink = mix(Theme.ink, Theme.surface, 0.2);
    const rows = [["force", "N", Theme.force], ["moment", "N m", Theme.moment]].filter(([key]) => greatest[key] > 0);
    ctx.font = `12px ${Theme.font}`;
    rows.forEach(([key, unit, colour], k) => {
      const y = h - 18 - 20 * (rows.length - 1 - k);
      const text = `largest ${key} ${inUnits([greatest[key]], unit, { digits: 3 })}`;
      label(ctx, text, [w - 16, y], ink, Theme.surface, "right");
      const wide = ctx.measureText(text).width;
      arrow(ctx, [w - 28 - wide - 30, y], [30, 0], colour, Theme.surface, 2.6);
    });
  }
}

const AXIS_COLOURS = { light: ["#c0392b", "#1e8449", "#1f5fbf"], dark: ["#ff7b6b", "#58d68d", "#6aa9ff"] };
