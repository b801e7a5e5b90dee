// The way of a point in space: all of it faint, the last part up to now strong.

class Trace {
  constructor(point, world) {
    this.point = point;
    const way = point.way.map(({ p }) => p);
    const pairs = way.slice(1).map((p, k) => [way[k], p]);
    this.last = Math.max(1, Math.ceil(0.15 * way.length));
    this.whole = thick(pairs.filter(([a, b]) => a && b), 1.8);
    this.recent = thick(Array.from({ length: this.last + 1 }, () => [[0, 0, 0], [0, 0, 0]]), 3.2);
    Object.assign(this.recent.material, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -8 });  // over the whole, in the same place
    this.pair = [this.whole, this.recent];
    world.add(...this.pair);
  }

  restyle(colour, surface) {
    this.whole.material.color.set(mix(surface, colour, 0.5));
    this.recent.material.color.set(colour);
  }

  show(motion, canvas) {
    const { point } = this;
    for (const line of this.pair) {
      line.visible = point.traced && motion.moves;
      line.material.resolution.set(canvas.clientWidth, canvas.clientHeight);
    }
    if (!this.recent.visible) return;
    let now = 0, high = point.way.length;
    while (now < high) {
      const middle = (now + high) >> 1;
      if (point.way[middle].t <= motion.now) now = middle + 1; else high = middle;
    }
    const end = motion.at(point.body, point.point), data = this.recent.geometry.attributes.instanceStart.data;
    for (let k = 0; k <= this.last; k++) {
      const a = point.way[now - 1 - k]?.p, b = k ? point.way[now - k]?.p : end;
      data.array.set(a && b ? [...a, ...b] : [0, 0, 0, 0, 0, 0], 6 * k);
    }
    data.needsUpdate = true;
  }
}

// Segments of a width in pixels.
function thick(pairs, width) {
  const geometry = new THREE.LineSegmentsGeometry().setPositions(pairs.length ? pairs.flat(2) : [0, 0, 0, 0, 0, 0]);
  const line = new THREE.LineSegments2(geometry, new THREE.LineMaterial({ linewidth: width, fog: false }));
  line.frustumCulled = false;
  return line;
}
