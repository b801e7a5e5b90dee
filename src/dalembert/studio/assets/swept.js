// Area over which a body moves, and the sizes of the path of a point.

/** @typedef {[number, number]} Vector */

/** Instants at which outlines are drawn, and cells of the raster along the longer side on which the area is counted. */
const FRAMES = 240, CELLS = 512;
/** Distance from its start at which a path is closed, relative to its length. */
const CLOSED = 1e-3;
/** Area relative to the squared length below which a path goes to and fro. */
const FLAT = 1e-4;

/** Area with the sign of its orientation. @param {Vector[]} places */
const signedArea = (places) => places.reduce((sum, [x, y], k) => { const [u, v] = places[(k + 1) % places.length]; return sum + (x * v - u * y) / 2; }, 0);

/** @typedef {{ polygons: Vector[][], area: number }} Swept */

/** Areas of bodies by the poses of a motion. @type {WeakMap<object, Map<string, Swept>>} */
const known = new WeakMap();

/** Area that a body sweeps: polygons of one orientation, and its size [m²]. @param {any} motion @param {any} body @returns {Swept} */
export function sweptOf(motion, body) {
  const key = motion.series[0]?.values ?? motion, all = known.get(key) ?? new Map();
  known.set(key, all);
  const found = all.get(body.name) ?? swept(motion, body);
  all.set(body.name, found);
  return found;
}

/** @param {any} motion @param {any} body @returns {Swept} */
function swept(motion, body) {
  const polygons = /** @type {Vector[][]} */ ([]), add = (/** @type {Vector[]} */ polygon) => polygons.push(signedArea(polygon) < 0 ? [...polygon].reverse() : polygon);
  for (const shape of body.shapes) {
    const local = motion.outline(shape);
    let before = /** @type {Vector[] | null} */ (null);
    for (const cursor of motion.frames(FRAMES)) {
      const pose = motion.pose(body, cursor);
      if (!pose) continue;
      const corners = /** @type {Vector[]} */ (local.map((/** @type {any} */ point) => motion.placed(pose, point)));
      if (corners.length > 2) add(corners);
      // between two instants, each edge sweeps a quadrilateral; two triangles keep one orientation where it crosses itself
      for (let k = corners.length > 2 ? 0 : 1; before && k < corners.length; k++) {
        const last = (k || corners.length) - 1;
        add([before[last], before[k], corners[k]]);
        add([before[last], corners[k], corners[last]]);
      }
      before = corners;
    }
  }
  return { polygons, area: counted(polygons) };
}

/** Area of a union of polygons of one orientation, by the cells of a raster. @param {Vector[][]} polygons */
function counted(polygons) {
  const places = polygons.flat();
  if (!places.length) return 0;
  const bound = (/** @type {number} */ k, /** @type {(a: number, b: number) => number} */ pick) => places.reduce((best, place) => pick(best, place[k]), places[0][k]);
  const [x0, x1, y0, y1] = [bound(0, Math.min), bound(0, Math.max), bound(1, Math.min), bound(1, Math.max)], size = Math.max(x1 - x0, y1 - y0);
  if (!(size > 0)) return 0;
  const scale = CELLS / size, width = Math.ceil((x1 - x0) * scale) + 2, height = Math.ceil((y1 - y0) * scale) + 2;
  const ctx = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  if (!ctx) return NaN;
  ctx.beginPath();
  for (const polygon of polygons) {
    polygon.forEach(([x, y], k) => (k ? ctx.lineTo((x - x0) * scale + 1, (y - y0) * scale + 1) : ctx.moveTo((x - x0) * scale + 1, (y - y0) * scale + 1)));
    ctx.closePath();
  }
  ctx.fill("nonzero");
  const { data } = ctx.getImageData(0, 0, width, height);
  let sum = 0;
  for (let k = 3; k < data.length; k += 4) sum += data[k] / 255;
  return sum / scale ** 2;
}

/** Length of the path of a point until it closes [m], and the area that it encloses then [m²]. @param {any} motion @param {any} body @param {number[] | null} point @returns {{ length: number, area: number | null }} */
export function pathSizes(motion, body, point) {
  const path = /** @type {Vector[]} */ (motion.frames(400).map((/** @type {any} */ cursor) => motion.at(body, point, cursor)).filter(Boolean));
  let length = 0;
  for (let k = 1; k < path.length; k++) {
    const [[ax, ay], [bx, by]] = [path[k - 1], path[k]], step = Math.hypot(bx - ax, by - ay), [x, y] = path[0];
    const ahead = k > 2 && (bx - ax) * (path[1][0] - x) + (by - ay) * (path[1][1] - y) > 0;  // in the direction of the start
    const share = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / (step * step || 1), along = Math.min(1, Math.max(0, share));
    if (ahead && Math.hypot(ax + along * (bx - ax) - x, ay + along * (by - ay) - y) < CLOSED * length) {
      const area = Math.abs(signedArea(path.slice(0, k)));
      return { length: length + along * step, area: area > FLAT * length * length ? area : null };
    }
    length += step;
  }
  return { length, area: null };
}
