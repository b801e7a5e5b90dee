// Symbols of engineering drawings. All lengths are in pixels, y points down.

// A bar, or a plate with rounded corners: one thick stroke inside another.
function plate(ctx, points, half, look) {
  ctx.lineJoin = ctx.lineCap = "round";
  trace(ctx, points, points.length > 2);
  stroke(ctx, look.edge, 2 * half + look.width);
  stroke(ctx, look.fill, 2 * half - look.width);
  if (points.length > 2) {
    ctx.fillStyle = look.fill;
    ctx.fill();
  }
  ctx.lineCap = "butt";
}

function solid(ctx, look) {
  ctx.fillStyle = look.fill;
  ctx.fill();
  ctx.lineJoin = "round";
  stroke(ctx, look.edge, look.width);
}

// A wheel: rim, hub, and one heavy spoke which shows the turning.
function wheel(ctx, c, r, angle, look, teeth) {
  ctx.beginPath();
  if (teeth) gearRim(ctx, c, r, angle, teeth);
  else ctx.arc(c[0], c[1], Math.max(1, r), 0, TAU);
  ctx.globalAlpha = 0.82;
  ctx.fillStyle = look.fill;
  ctx.fill();
  ctx.globalAlpha = 1;
  ctx.lineJoin = "round";
  stroke(ctx, look.edge, look.width);
  const at = (k, a) => [c[0] + k * r * Math.cos(a), c[1] - k * r * Math.sin(a)];
  if (teeth) {
    circle(ctx, c, r);
    stroke(ctx, look.edge, 0.8, [8, 3, 2, 3]);
  } else if (r > 14) {
    circle(ctx, c, 0.86 * r);
    stroke(ctx, look.edge, 0.6);
  }
  ctx.lineCap = "round";
  trace(ctx, [c, at(teeth ? 0.8 : 0.86, angle)]);
  stroke(ctx, look.edge, clamp(0.08 * r, 1.5, 4));
  ctx.lineCap = "butt";
  if (r > 24) {
    for (const k of [1, 2]) {
      trace(ctx, [at(0.2, angle + (k * TAU) / 3), at(teeth ? 0.78 : 0.84, angle + (k * TAU) / 3)]);
      stroke(ctx, look.edge, 0.8);
    }
  }
  circle(ctx, c, clamp(0.18 * r, 2, 16));
  solid(ctx, look);
}

// Teeth about the pitch circle; a schematic, not the true flanks.
function gearRim(ctx, [x, y], r, angle, { count, phase }) {
  const pitch = TAU / count;
  const high = Math.min(0.3 * pitch * r, 0.12 * r);
  for (let k = 0; k < count; k++) {
    for (const [u, dr] of [[-0.34, -high], [-0.14, high], [0.14, high], [0.34, -high]]) {
      const a = angle + phase + (k + u) * pitch;
      ctx.lineTo(x + (r + dr) * Math.cos(a), y - (r + dr) * Math.sin(a));
    }
  }
  ctx.closePath();
}

// Short strokes to the right of the way from a to b.
function hatch(ctx, a, b, colour, gap = 7, size = 7) {
  const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy);
  if (length < 2) return;
  const count = Math.min(400, Math.max(2, Math.round(length / gap)));
  const [tx, ty] = [dx / length, dy / length];
  ctx.beginPath();
  for (let k = 0; k < count; k++) {
    const s = ((k + 0.7) * length) / count;
    const [x, y] = [a[0] + tx * s, a[1] + ty * s];
    ctx.moveTo(x, y);
    ctx.lineTo(x - tx * size * 0.75 - ty * size, y - ty * size * 0.75 + tx * size);
  }
  stroke(ctx, colour, 1);
}

// A pin bracket on hatched ground; `tilt` turns its foot away from straight below.
function groundPivot(ctx, [x, y], h, colours, tilt = 0) {
  const base = y + 2.5 * h, half = 1.75 * h;
  ctx.save();
  ctx.translate(x, y);
  ctx.rotate(tilt);
  ctx.translate(-x, -y);
  ctx.lineJoin = "round";
  ctx.beginPath();
  ctx.moveTo(x - 0.75 * h, y - 0.1 * h);
  ctx.arc(x, y, 0.8 * h, Math.PI, 0);
  ctx.lineTo(x + half, base);
  ctx.lineTo(x - half, base);
  ctx.closePath();
  ctx.fillStyle = colours.ground;
  ctx.fill();
  stroke(ctx, colours.ink, 1.4);
  const [a, b] = [[x + 2.5 * h, base], [x - 2.5 * h, base]];
  trace(ctx, [a, b]);
  stroke(ctx, colours.ink, 1.8);
  hatch(ctx, b, a, colours.ink, Math.max(3.5, 0.7 * h), 0.7 * h);
  ctx.restore();
}

function pin(ctx, [x, y], r, colours) {
  circle(ctx, [x, y], r);
  ctx.fillStyle = colours.surface;
  ctx.fill();
  stroke(ctx, colours.ink, Math.max(1.2, 0.3 * r));
}

function jointMark(ctx, joint, p, h, colours) {
  const r = clamp(0.52 * h, 2, 7);
  switch (joint.symbol) {
    case "pin": return pin(ctx, p, r, colours);
    case "slotpin":
      pin(ctx, p, r, colours);
      circle(ctx, p, 0.35 * r);
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    case "slider":
      circle(ctx, p, Math.max(1.5, 0.3 * r));
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    case "clamp":
      trace(ctx, [[p[0] - r, p[1] - r], [p[0] + r, p[1] + r]]);
      stroke(ctx, colours.ink, 1.8);
      trace(ctx, [[p[0] - r, p[1] + r], [p[0] + r, p[1] - r]]);
      return stroke(ctx, colours.ink, 1.8);
    case "belt": return;
    case "mesh":
      circle(ctx, p, Math.max(1.5, 0.35 * r));
      ctx.fillStyle = colours.ink;
      return ctx.fill();
    default:
      trace(ctx, [[p[0], p[1] - r], [p[0] + r, p[1]], [p[0], p[1] + r], [p[0] - r, p[1]]], true);
      ctx.fillStyle = colours.surface;
      ctx.fill();
      return stroke(ctx, colours.ink, 1.5);
  }
}

// A circle with two dark quarters: a centre of mass, or a body without a shape.
function centreMark(ctx, [x, y], r, ink, surface) {
  circle(ctx, [x, y], r);
  ctx.fillStyle = surface;
  ctx.fill();
  ctx.fillStyle = ink;
  for (const a of [0, Math.PI]) {
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.arc(x, y, r, a, a + Math.PI / 2);
    ctx.fill();
  }
  circle(ctx, [x, y], r);
  stroke(ctx, ink, 1.3);
}

// Elements between two points. `rest` is their usual length; it keeps rigid parts rigid.
const LINKS = {
  coil(ctx, L, h, rest, c) {
    const lead = Math.min(0.14 * rest, 0.3 * L), wide = 1.15 * h, coils = 8;
    const points = [[0, 0], [lead, 0]];
    for (let k = 0; k < 2 * coils; k++) {
      points.push([lead + ((k + 0.5) * (L - 2 * lead)) / (2 * coils), k % 2 ? wide : -wide]);
    }
    points.push([L - lead, 0], [L, 0]);
    trace(ctx, points);
    ctx.lineJoin = "round";
    stroke(ctx, c.surface, 4);
    stroke(ctx, c.spring, 1.8);
  },
  dashpot(ctx, L, h, rest, c) {
    const a = 0.28 * rest, b = a + 0.4 * rest, wide = 0.95 * h;
    const head = clamp(L - 0.48 * rest, a + 2, Math.max(a + 2, Math.min(b - 1, L - 1)));
    ctx.beginPath();
    ctx.rect(a, -wide, b - a, 2 * wide);
    ctx.fillStyle = c.ground;
    ctx.fill();
    trace(ctx, [[b, -wide], [a, -wide], [a, wide], [b, wide]]);
    stroke(ctx, c.ink, 1.6);
    trace(ctx, [[0, 0], [a, 0]]);
    stroke(ctx, c.ink, 1.6);
    trace(ctx, [[head, -0.78 * wide], [head, 0.78 * wide]]);
    stroke(ctx, c.ink, 2.6);
    trace(ctx, [[head, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.6);
  },
  cylinder(ctx, L, h, rest, c) {
    const body = Math.min(0.58 * rest, 0.85 * L), wide = 0.9 * h;
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, Math.max(2.5, 0.6 * h));
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.surface, Math.max(1, 0.6 * h - 2));
    ctx.beginPath();
    ctx.roundRect(0.06 * rest, -wide, Math.max(1, body - 0.06 * rest), 2 * wide, 0.3 * h);
    ctx.fillStyle = c.actuator;
    ctx.fill();
    stroke(ctx, c.ink, 1.4);
    trace(ctx, [[body - 0.35 * h, -wide], [body - 0.35 * h, wide]]);
    stroke(ctx, c.ink, 1.1);
  },
  sleeve(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.4);
    for (const [r, fill] of [[1.5 * h, c.actuator], [0.75 * h, c.surface]]) {
      circle(ctx, [L / 2, 0], r);
      ctx.fillStyle = fill;
      ctx.fill();
      stroke(ctx, c.ink, 1.3);
    }
  },
  strand(ctx, L, h, rest, c) {
    ctx.lineCap = "round";
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, Math.min(9, Math.max(3, 0.8 * h)));
    ctx.lineCap = "butt";
  },
  tie(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 1.4, [9, 3, 2, 3]);
  },
  rod(ctx, L, h, rest, c) {
    trace(ctx, [[0, 0], [L, 0]]);
    stroke(ctx, c.ink, 4.5);
    stroke(ctx, c.surface, 1.8);
  },
};

function linkSymbol(ctx, kind, p, q, h, rest, offset, colours) {
  const L = Math.hypot(q[0] - p[0], q[1] - p[1]);
  ctx.save();
  ctx.translate(p[0], p[1]);
  ctx.rotate(Math.atan2(q[1] - p[1], q[0] - p[0]));
  if (offset) {
    for (const x of [0, L]) {
      trace(ctx, [[x, 0], [x, offset]]);
      stroke(ctx, colours.ink, 1.4);
    }
    ctx.translate(0, offset);
  }
  (LINKS[kind] || LINKS.rod)(ctx, L, h, rest, colours);
  ctx.restore();
}

function arrow(ctx, [x, y], [u, v], colour, surface, width = 2.4) {
  const length = Math.hypot(u, v);
  if (length < 1.5) return;
  const head = Math.min(11, 0.6 * length), [tx, ty] = [u / length, v / length];
  const tip = [x + u, y + v], neck = [tip[0] - tx * head, tip[1] - ty * head];
  ctx.lineCap = "round";
  trace(ctx, [[x, y], neck]);
  stroke(ctx, surface, width + 2.5);
  stroke(ctx, colour, width);
  ctx.lineCap = "butt";
  trace(ctx, [tip, [neck[0] - ty * head * 0.42, neck[1] + tx * head * 0.42], [neck[0] + ty * head * 0.42, neck[1] - tx * head * 0.42]], true);
  ctx.lineJoin = "round";
  stroke(ctx, surface, 2);
  ctx.fillStyle = colour;
  ctx.fill();
}

// An arc with an arrow head; `sweep` > 0 turns counter-clockwise.
function momentArc(ctx, [x, y], r, sweep, colour, surface, width = 2.2) {
  if (Math.abs(sweep) * r < 3) return;
  const from = -Math.PI / 2, to = from - sweep, back = sweep > 0;
  ctx.beginPath();
  ctx.arc(x, y, r, from, to, back);
  stroke(ctx, surface, width + 2.3);
  stroke(ctx, colour, width);
  const size = Math.min(8, r, Math.abs(sweep) * r), way = back ? -1 : 1;
  const tip = [x + r * Math.cos(to), y + r * Math.sin(to)];
  const [tx, ty] = [-Math.sin(to) * way, Math.cos(to) * way];
  trace(ctx, [[tip[0] + tx * size * 0.6, tip[1] + ty * size * 0.6],
    [tip[0] - tx * size * 0.5 - ty * size * 0.5, tip[1] - ty * size * 0.5 + tx * size * 0.5],
    [tip[0] - tx * size * 0.5 + ty * size * 0.5, tip[1] - ty * size * 0.5 - tx * size * 0.5]], true);
  ctx.fillStyle = colour;
  ctx.fill();
}

function label(ctx, text, [x, y], colour, surface, align = "center") {
  ctx.textAlign = align;
  ctx.textBaseline = "middle";
  ctx.lineJoin = "round";
  ctx.strokeStyle = surface;
  ctx.lineWidth = 4;
  ctx.strokeText(text, x, y);
  ctx.fillStyle = colour;
  ctx.fillText(text, x, y);
}
