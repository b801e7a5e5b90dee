// What is written on a drawing in the plane: names, scales, the way of gravity.

class SceneMarks extends ScenePainter {
  drawLabels() {
    const { ctx, half } = this;
    const middle = ({ i, j }) => {
      const p = this.placeOf(i.body, i.point), q = this.placeOf(j.body, j.point);
      return p && q && [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
    };
    const pins = [...this.motion.joints.map((j) => this.placeOf(j.body, j.point)), ...this.motion.links.map(middle)].filter(Boolean);
    const taken = this.drawJointNames();
    ctx.font = `600 12px ${Theme.font}`;
    for (const body of this.motion.bodies) {
      const pose = this.poses.get(body);
      if (!pose || !body.label) continue;
      const wide = ctx.measureText(body.label).width / 2;
      const places = this.labelPlaces(body, pose, wide);
      const cost = ([x, y], more = 0) => {
        const covers = ([px, py], dx, dy) => Math.abs(px - x) < wide + dx + more && Math.abs(py - y) < 8 + dy + more;
        return pins.filter((p) => covers(p, half, half)).length + 2 * taken.filter((t) => covers(t.at, t.wide, 8)).length
          + (Math.abs(x - this.w / 2) > this.w / 2 - wide || Math.abs(y - this.h / 2) > this.h / 2 - 8 ? 3 : 0);
      };
      // A label keeps its place until another one is better, or the best one is clear again.
      const costs = places.map((place) => cost(place)), least = Math.min(...costs);
      if (!(costs[body.side] <= least)) body.side = costs.indexOf(least);
      if (body.side && !cost(places[0], 10)) body.side = 0;
      const at = places[body.side];
      taken.push({ at, wide });
      label(ctx, body.label, at, this.looks[body.index].text, Theme.surface);
    }
  }

  // Short joint names, at the corner of the joint which lies on the fewest bodies.
  drawJointNames() {
    const joints = this.motion.joints.filter((j) => j.name && j.name.length <= 3);
    if (joints.length > 24) return [];
    const bodies = [...this.poses].filter(([, pose]) => pose);
    const cost = (place, reach) => bodies.filter(([body, pose]) => {
      const p = toBody(pose, this.world(place));
      return body.shapes.some((shape) => inShape(shape, p, reach / this.view.s));
    }).length;
    this.ctx.font = `italic 12px ${Theme.font}`;
    return joints.map((joint) => {
      const p = this.placeOf(joint.body, joint.point);
      if (!p) return null;
      const [dx, dy] = [1.1 * this.half + 7, 0.9 * this.half + 5];
      const places = [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([u, v]) => [p[0] + u * dx, p[1] + v * dy]);
      const costs = places.map((place) => cost(place, this.half + 4)), least = Math.min(...costs);
      if (!(costs[joint.side] <= least)) joint.side = costs.indexOf(least);
      const at = places[joint.side];
      label(this.ctx, joint.name, at, Theme.muted, Theme.surface);
      return { at, wide: 7 };
    }).filter(Boolean);
  }

  // Where the name of a body may stand, best first: beside a bar, in a plate, about the rest.
  labelPlaces(body, pose, wide) {
    const bar = body.shapes.length === 1 && body.shapes[0].kind === "bar" && body.shapes[0];
    if (bar) {
      const [a, b] = [bar.from, bar.to].map((p) => this.screen(toWorld(pose, p)));
      const L = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const [nx, ny] = [(b[1] - a[1]) / L, -(b[0] - a[0]) / L];
      const gap = this.half + 11 + (wide - 6) * Math.abs(nx);
      return [1, -1].flatMap((sign) => [0.5, 0.33, 0.67].map((k) => [a[0] + k * (b[0] - a[0]) + sign * nx * gap, a[1] + k * (b[1] - a[1]) + sign * ny * gap]));
    }
    const points = body.shapes.length ? body.shapes.flatMap(outline) : [[0, 0]];
    const seen = points.map((p) => this.screen(toWorld(pose, p)));
    const [x0, x1] = extent([seen.map((p) => p[0])]), [y0, y1] = extent([seen.map((p) => p[1])]);
    const [x, y, pad] = [(x0 + x1) / 2, (y0 + y1) / 2, 12 + (body.shapes.some((s) => s.kind === "polygon" || s.kind === "bar" || s.kind === "particle") || !body.shapes.length ? this.half : 0)];
    const around = [[x, y0 - pad], [x, y1 + pad], [x1 + pad + wide - 4, y], [x0 - pad - wide + 4, y]];
    if (!body.shapes.some((s) => s.kind === "polygon") || Math.min(x1 - x0, y1 - y0) < 2 * wide) return around;
    return [[seen.reduce((sum, p) => sum + p[0], 0) / seen.length, seen.reduce((sum, p) => sum + p[1], 0) / seen.length], ...around];
  }

  drawScale() {
    const { ctx, h, w } = this;
    const size = niceAbove(70 / this.view.s), length = size * this.view.s;
    const [x, y] = [18, h - 20];
    const ink = mix(Theme.ink, Theme.surface, 0.2);
    trace(ctx, [[x, y - 5], [x, y], [x + length, y], [x + length, y - 5]]);
    ctx.lineJoin = "miter";
    stroke(ctx, Theme.surface, 4);
    stroke(ctx, ink, 1.5);
    ctx.font = `12px ${Theme.font}`;
    label(ctx, metres(size), [x + length / 2, y - 11], ink, Theme.surface);
    if (this.ratio && this.motion.moves) label(ctx, `t = ${clock(this.motion.now, this.motion.span)} s`, [w - 16, 24], ink, Theme.surface, "right");
    let right = w - 18;
    const legend = (text, draw, width) => {
      const room = Math.max(width, ctx.measureText(text).width);
      draw([right - room / 2 - width / 2, y]);
      label(ctx, text, [right - room / 2, y - 17], ink, Theme.surface);
      right -= room + 26;
    };
    if (this.greatest.load > 0) {
      const n = niceAbove(this.greatest.load * 0.2), length = n * this.loadScale();
      legend(`${inUnits([n], "N", { digits: 2 })} applied`, (p) => arrow(ctx, p, [length, 0], this.colours.load, Theme.surface, 2.8), length);
    }
    if (!this.show.forces) return;
    if (this.greatest.force > 0) {
      const n = niceAbove(this.greatest.force * 0.2);
      legend(inUnits([n], "N", { digits: 2 }), (p) => arrow(ctx, p, [n * this.forceScale(), 0], Theme.force, Theme.surface), n * this.forceScale());
    }
    if (this.greatest.moment > 0) {
      const n = niceAbove(this.greatest.moment * 0.2), r = 8;
      legend(inUnits([n], "N m", { digits: 2 }), (p) => momentArc(ctx, [p[0] + r, p[1] + 1], r, this.sweep("moment", n), Theme.moment, Theme.surface), 2 * r);
    }
  }

  drawGravity() {
    const { ctx } = this;
    const [gx, gy] = this.motion.gravity, size = Math.hypot(gx, gy);
    const [ux, uy] = [gx / size, -gy / size], c = [32, 34];
    arrow(ctx, [c[0] - 15 * ux, c[1] - 15 * uy], [30 * ux, 30 * uy], Theme.muted, Theme.surface, 1.6);
    ctx.font = `italic 13px ${Theme.font}`;
    label(ctx, "g", [c[0] + 13 * Math.abs(uy) , c[1] + 14 * Math.abs(ux)], Theme.muted, Theme.surface);
  }
}
