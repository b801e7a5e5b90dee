// Primitives that stand alone: about an axis, along a direction, loads and limits. Each draws itself in a scene.

const LOOKS = {
  spiral(scene, item) {
    const { ctx, half } = scene, p = scene.placeOf(item.body, item.point), turn = scene.turn(item);
    if (!p || turn === null) return;
    const from = scene.angleOf(item.i), to = from + 2.25 * TAU + turn, steps = 90, r = (k) => (0.8 + 1.9 * k) * half;
    const at = (k) => { const a = from + k * (to - from); return [p[0] + r(k) * Math.cos(a), p[1] - r(k) * Math.sin(a)]; };
    trace(ctx, Array.from({ length: steps + 1 }, (_, k) => at(k / steps)));
    ctx.lineJoin = ctx.lineCap = "round";
    stroke(ctx, scene.colours.surface, 3.6);
    stroke(ctx, scene.colours.spring, 1.6);
    ctx.lineCap = "butt";
  },
  brake(scene, item) {
    const { ctx, half, colours } = scene, p = scene.placeOf(item.body, item.point), a = scene.angleOf(item.j);
    if (!p || a === null) return;
    circle(ctx, p, 3.1 * half);
    stroke(ctx, colours.ink, 1.3);
    for (const side of [0, Math.PI]) {
      ctx.beginPath();
      ctx.arc(p[0], p[1], 2.75 * half, side - a - 0.6, side - a + 0.6);
      stroke(ctx, colours.actuator, 0.6 * half);
    }
  },
  motor(scene, item) {
    const { ctx, half, colours } = scene, p = scene.placeOf(item.body, item.point), r = 1.75 * half;
    if (!p) return;
    circle(ctx, p, r);
    ctx.fillStyle = colours.actuator;
    ctx.fill();
    stroke(ctx, colours.ink, 1.4);
    momentArc(ctx, p, 1.6 * r, 0.62 * TAU, colours.ink, colours.surface, 1.4);
  },
  belt(scene, item) {
    const { ctx, colours, half } = scene;
    const wheels = item.wheels.map(({ body, point, radius }) => ({ c: scene.placeOf(body, point), r: radius * scene.view.s, body }));
    if (wheels.length < 2 || wheels.some(({ c }) => !c)) return;
    const [one, two] = wheels, [dx, dy] = [two.c[0] - one.c[0], two.c[1] - one.c[1]], d = Math.hypot(dx, dy);
    if (d < 2 * half) return gearbox(ctx, one.c, half, colours);
    for (const { c, r, body } of wheels) {
      const a = scene.angleOf(body);
      circle(ctx, c, r);
      ctx.fillStyle = mix(Theme.surface, Theme.ink, 0.06);
      ctx.globalAlpha = 0.8;
      ctx.fill();
      ctx.globalAlpha = 1;
      stroke(ctx, colours.ink, 1.2);
      trace(ctx, [c, [c[0] + r * Math.cos(a), c[1] - r * Math.sin(a)]]);
      stroke(ctx, colours.ink, 1.2);
    }
    const way = Math.atan2(dy, dx), open = Math.acos(clamp((one.r - (item.crossed ? -two.r : two.r)) / d, -1, 1));
    for (const side of [-open, open]) {
      const u = [Math.cos(way + side), Math.sin(way + side)], k = item.crossed ? -two.r : two.r;
      trace(ctx, [[one.c[0] + one.r * u[0], one.c[1] + one.r * u[1]], [two.c[0] + k * u[0], two.c[1] + k * u[1]]]);
      stroke(ctx, colours.ink, 2.4);
    }
  },
  travel(scene, item) {
    const { ctx, half, colours } = scene, p = scene.placeOf(item.body, item.point), pose = scene.poses.get(item.on);
    if (!p || !pose) return;
    const size = Math.hypot(...item.axis) || 1, [x, y] = item.axis.map((v) => v / size);
    const [u, v] = [pose.c * x - pose.s * y, -(pose.s * x + pose.c * y)], reach = 4 * half + 6;
    const c = [p[0] + 2.6 * half * v, p[1] - 2.6 * half * u];
    for (const sign of [1, -1]) arrow(ctx, c, [sign * reach * u, sign * reach * v], colours.drive, colours.surface, Math.max(2, 0.4 * half));
  },
  limit(scene, item) {
    const { ctx, half, colours, motion } = scene;
    const [x, y, u, v] = [item.x, item.y, item.nx, item.ny].map((column) => motion.sample(column, motion.cursor));
    if (![x, y, u, v].every(Number.isFinite)) return;
    const p = scene.screen([x, y]), r = 2.4 * half + 3, gap = Math.max(3.5, 0.7 * half);
    const [a, b] = [[p[0] - r * v, p[1] - r * u], [p[0] + r * v, p[1] + r * u]];
    trace(ctx, [a, b]);
    stroke(ctx, colours.ink, 2);
    hatch(ctx, a, b, colours.ink, gap, gap);
  },
  arrow(scene, item) {
    const p = scene.placeOf(item.body, item.point), load = scene.load(item);
    if (!p || load.fx !== load.fx) return;
    const scale = scene.loadScale();
    const way = scene.arrowWay("load", load.fx, load.fy, scale);
    arrow(scene.ctx, p, way, scene.colours.load, Theme.surface, 2.8);
    scene.readLoad("load", Math.hypot(load.fx, load.fy), p, way);
  },
  twist(scene, item) {
    const p = scene.placeOf(item.body, item.point), { m } = scene.load(item);
    if (!p || m !== m) return;
    const r = 3.2 * scene.half + 4;
    momentArc(scene.ctx, p, r, scene.sweep("twist", m), scene.colours.load, Theme.surface, 2.6);
    scene.readLoad("twist", Math.abs(m), p, [0, r + 4]);
  },
};

// A fixed ratio between two shafts on one axis.
function gearbox(ctx, [x, y], h, colours) {
  ctx.beginPath();
  ctx.roundRect(x - 2.4 * h, y - 1.8 * h, 4.8 * h, 3.6 * h, 0.5 * h);
  ctx.fillStyle = colours.actuator;
  ctx.fill();
  stroke(ctx, colours.ink, 1.4);
  for (const [k, r] of [[-0.75, 0.8], [0.85, 1.1]]) { circle(ctx, [x + k * h, y], r * h); stroke(ctx, colours.ink, 1.1); }
}
