// Path of a point in space: faint, with the recent part strong.

/** @import { Point, TracedPoint } from "./types.d.ts" */
/** @import { SpatialMotion } from "./spatial_motion.js" */

import "./vendor/three.js";
import { mix } from "./theme.js";

/** Share of the path that is strong. */
const RECENT = 0.15;

export class SpatialTrace {
  /** @param {TracedPoint} point @param {THREE.Group} parent */
  constructor(point, parent) {
    this.point = point;
    const way = point.way.map(({ p }) => p);
    this.last = Math.max(1, Math.ceil(RECENT * way.length));
    this.whole = thickLines(way.slice(1).flatMap((q, k) => { const p = way[k]; return p && q ? [p, q] : []; }), 1.8);
    this.recent = thickLines(Array(2 * this.last + 2).fill([0, 0, 0]), 3.2);
    // Drawn over the whole path, in the same place.
    Object.assign(this.recent.material, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -8 });
    parent.add(this.whole, this.recent);
  }

  /** @param {string} colour @param {string} surface */
  restyle(colour, surface) {
    this.whole.material.color.set(mix(surface, colour, 0.5));
    this.recent.material.color.set(colour);
  }

  /** @param {SpatialMotion} motion @param {HTMLCanvasElement} canvas */
  show(motion, { clientWidth, clientHeight }) {
    const { point } = this;
    for (const line of [this.whole, this.recent]) {
      line.visible = point.traced && motion.moves;
      line.material.resolution.set(clientWidth, clientHeight);
    }
    if (!this.recent.visible) return;
    let now = 0, high = point.way.length;
    while (now < high) {
      const middle = (now + high) >> 1;
      if (point.way[middle].t <= motion.now) now = middle + 1; else high = middle;
    }
    const end = motion.at(/** @type {any} */ (point.body), point.point), { data } = this.recent.geometry.attributes.instanceStart;
    for (let k = 0; k <= this.last; k++) {
      const p = point.way[now - 1 - k]?.p, q = k ? point.way[now - k]?.p : end;
      data.array.set(p && q ? [...p, ...q] : [0, 0, 0, 0, 0, 0], 6 * k);
    }
    data.needsUpdate = true;
  }
}

/** Segments between pairs of points, of a width in pixels. @param {ArrayLike<number>[] | Point[]} points @param {number} width @returns {THREE.LineSegments2} */
export function thickLines(points, width, style = {}) {
  const geometry = new THREE.LineSegmentsGeometry().setPositions(points.length ? points.flatMap((p) => Array.from(p)) : [0, 0, 0, 0, 0, 0]);
  const line = new THREE.LineSegments2(geometry, new THREE.LineMaterial({ linewidth: width, fog: false, ...style }));
  line.frustumCulled = false;
  return line;
}
