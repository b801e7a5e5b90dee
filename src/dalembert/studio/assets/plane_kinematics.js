// Kinematics of planar bodies from the poses, speeds and accelerations of a motion.

/** Motion of a body at an instant: pose, speeds, accelerations.
 * @typedef {{ x: number, y: number, a: number, vx: number, vy: number, w: number, ax: number, ay: number, e: number }} Twist */
/** @typedef {[number, number]} Vector */

/** @type {Twist} */
export const GROUND = { x: 0, y: 0, a: 0, vx: 0, vy: 0, w: 0, ax: 0, ay: 0, e: 0 };
/** Ratio of angular velocities below which two bodies translate relative to each other. */
const TRANSLATION = 1e-6;

/** Motion of a body of a page; null where the page has no speeds of it. @param {any} motion @param {any} body @param {{ i: number, f: number }} cursor @returns {Twist | null} */
export function twistOf(motion, body, cursor = motion.cursor) {
  if (body.fixed) return GROUND;
  const owner = body.of ?? body, pose = motion.pose(owner, cursor);
  const value = (/** @type {string} */ key) => { const series = motion.seriesByName.get(`${owner.name}.${key}`); return series ? motion.sample(series.values, cursor) : NaN; };
  const [vx, vy, w, ax, ay, e] = ["vx", "vy", "angular_velocity", "ax", "ay", "angular_acceleration"].map(value);
  return pose && Number.isFinite(vx + vy + w) ? { ...pose, vx, vy, w, ax, ay, e } : null;
}

/** Velocity of the point of a body at a place. @param {Twist} body @param {Vector} place @returns {Vector} */
export const velocityAt = ({ x, y, vx, vy, w }, [px, py]) => [vx - w * (py - y), vy + w * (px - x)];

/** Acceleration of the point of a body at a place. @param {Twist} body @param {Vector} place @returns {Vector} */
export const accelerationAt = ({ x, y, ax, ay, w, e }, [px, py]) => [ax - e * (py - y) - w * w * (px - x), ay + e * (px - x) - w * w * (py - y)];

/** Instant centre of two bodies: the place at which their velocities are equal; null if they translate relative to each other.
 * @param {Twist} a @param {Twist} b @returns {Vector | null} */
export function instantCentre(a, b) {
  const turn = a.w - b.w, most = Math.max(Math.abs(a.w), Math.abs(b.w));
  if (!(Math.abs(turn) > TRANSLATION * most) || most === 0) return null;
  const [ux, uy] = velocityAt(a, [0, 0]), [vx, vy] = velocityAt(b, [0, 0]);
  return [-(uy - vy) / turn, (ux - vx) / turn];
}

/** Bodies that a joint connects to the ground, with the place of the joint in their axes. @param {any} motion @param {any} body */
const groundJoint = (motion, body) => motion.joints.find((/** @type {any} */ { body: one, base }) => base && ((one === body && base.body.fixed) || (base.body === body && one.fixed)));

/** Bodies that a driver moves. @param {any} motion */
const driven = (motion) => new Set(motion.symbols.filter((/** @type {any} */ { description }) => /driver/.test(description)).flatMap((/** @type {any} */ { i, j, body }) => [i, j, body]));

/** Bodies guided by the ground that no driver moves: rockers and sliders. @param {any} motion @returns {any[]} */
export function followers(motion) {
  const moved = driven(motion);
  return motion.bodies.filter((/** @type {any} */ body) => !body.of && !body.node && !moved.has(body) && groundJoint(motion, body));
}

/** Velocity of the point of a body that slides along the ground. @param {any} motion @param {any} body @param {{ i: number, f: number }} cursor @returns {Vector | null} */
function slidingVelocity(motion, body, cursor) {
  const joint = groundJoint(motion, body), end = joint.body === body ? joint : joint.base, twist = twistOf(motion, body, cursor), place = motion.at(body, end.point, cursor);
  return twist && place ? velocityAt(twist, place) : null;
}

/** Speed relative to its maximum below which a body rests, and the difference of equal poses relative to the range. */
const REST = 1e-9, EQUAL = 1e-3;

/** Instants at which a follower turns back: its limit positions, also at the start of a cycle. @param {any} motion @returns {{ body: any, cursor: { i: number, f: number } }[]} */
export function limitPositions(motion) {
  return followers(motion).flatMap((body) => {
    const slides = groundJoint(motion, body).description !== "revolute", limits = /** @type {{ body: any, cursor: { i: number, f: number } }[]} */ ([]);
    const velocities = Array.from({ length: slides ? motion.n : 0 }, (_, i) => slidingVelocity(motion, body, { i, f: 0 }) ?? /** @type {Vector} */ ([NaN, NaN]));
    const [u, v] = velocities.reduce((best, one) => (Math.hypot(...one) > Math.hypot(...best) ? one : best), /** @type {Vector} */ ([0, 0]));  // along the guide
    const speeds = slides ? velocities.map(([x, y]) => x * u + y * v) : Array.from({ length: motion.n }, (_, i) => twistOf(motion, body, { i, f: 0 })?.w ?? NaN), most = Math.max(...speeds.map(Math.abs).filter(Number.isFinite), 0);
    const signs = speeds.map((value) => (Math.abs(value) > REST * most ? Math.sign(value) : 0)), moving = signs.flatMap((sign, i) => (sign ? [i] : []));
    if (!moving.length) return limits;
    const first = moving[0], last = /** @type {number} */ (moving.at(-1));
    if (first > 0 && signs[last] !== signs[first] && isCycle(motion, body)) limits.push({ body, cursor: { i: 0, f: 0 } });
    moving.slice(1).forEach((i, k) => {
      const before = moving[k];
      if (signs[i] === signs[before]) return;
      limits.push({ body, cursor: i === before + 1 ? { i: before, f: zeroAfter(speeds, before) } : { i: before + 1, f: 0 } });
    });
    return limits;
  });
}

/** Part of a step after which samples change their sign, on the cubic through the four around it; on a line at the ends and where one is missing.
 * @param {number[]} samples @param {number} i */
export function zeroAfter(samples, i) {
  const [a, b, c, d] = [-1, 0, 1, 2].map((k) => samples[i + k]);
  if (![a, d].every(Number.isFinite)) return b / (b - c);
  const at = (/** @type {number} */ f) => (-a * f * (f - 1) * (f - 2)) / 6 + (b * (f + 1) * (f - 1) * (f - 2)) / 2 - (c * (f + 1) * f * (f - 2)) / 2 + (d * (f + 1) * f * (f - 1)) / 6;
  let [low, high] = [0, 1];
  for (let k = 0; k < 40; k++) {
    const middle = (low + high) / 2;
    if (Math.sign(at(middle)) === Math.sign(b)) low = middle;
    else high = middle;
  }
  return low;
}

/** Whether a body ends where it begins. @param {any} motion @param {any} body */
function isCycle(motion, body) {
  const [start, end] = [0, motion.n - 1].map((i) => motion.pose(body, { i, f: 0 })), range = rangeOf(motion, body);
  return Boolean(start && end) && apart(start, end) < EQUAL * range;
}

/** @typedef {{ x: number, y: number, a: number }} Pose */

/** Difference of two poses [m or rad], of the angle up to full turns. @param {Pose} p @param {Pose} q */
const apart = (p, q) => Math.max(Math.hypot(p.x - q.x, p.y - q.y), Math.abs(Math.atan2(Math.sin(p.a - q.a), Math.cos(p.a - q.a))));

/** Largest difference from the first pose. @param {any} motion @param {any} body */
function rangeOf(motion, body) {
  const poses = Array.from({ length: motion.n }, (_, i) => motion.pose(body, { i, f: 0 })).filter(Boolean);
  return Math.max(0, ...poses.map((pose) => apart(pose, poses[0])));
}

/** Limit positions without those that a motion of several cycles repeats, with the time until the next one of the same body.
 * @param {any} motion @returns {{ body: any, cursor: { i: number, f: number }, time: number, stroke: number }[]} */
export function deadCentres(motion) {
  const all = limitPositions(motion).map((limit) => ({ ...limit, time: motion.time[limit.cursor.i] + limit.cursor.f * ((motion.time[limit.cursor.i + 1] ?? NaN) - motion.time[limit.cursor.i] || 0), pose: motion.pose(limit.body, limit.cursor) }));
  const kept = /** @type {typeof all} */ ([]);
  for (const limit of all) if (!kept.some((other) => other.body === limit.body && apart(other.pose, limit.pose) < EQUAL * rangeOf(motion, limit.body))) kept.push(limit);
  return kept.map((limit) => ({ body: limit.body, cursor: limit.cursor, time: limit.time, stroke: (all.find((other) => other.body === limit.body && other.time > limit.time)?.time ?? NaN) - limit.time }));
}

/** Angle of the body that a driver rotates; null without one. @param {any} motion @param {{ i: number, f: number }} cursor @returns {{ name: string, angle: number } | null} */
export function crankAngle(motion, cursor) {
  const crank = [...driven(motion)].find((body) => body && !body.fixed && motion.bodies.includes(body) && groundJoint(motion, body)?.description === "revolute"), pose = crank && motion.pose(crank, cursor);
  return pose ? { name: crank.name, angle: pose.a } : null;
}

/** Joint at which a coupler drives a follower: place, and places on both bodies whose directions enclose the transmission angle.
 * @param {any} motion @param {{ i: number, f: number }} cursor @returns {{ body: any, place: Vector, arms: [Vector, Vector], angle: number }[]} */
export function transmissions(motion, cursor = motion.cursor) {
  return followers(motion).flatMap((body) => {
    const base = groundJoint(motion, body), place = (/** @type {any} */ end) => motion.at(end.body, end.point, cursor);
    const joint = motion.joints.find((/** @type {any} */ item) => item !== base && item.description === "revolute" && item.base && (item.body === body || item.base.body === body));
    if (!joint || !base) return [];
    const coupler = joint.body === body ? joint.base.body : joint.body;
    const other = motion.joints.find((/** @type {any} */ item) => item !== joint && item.base && item.description === "revolute" && (item.body === coupler || item.base.body === coupler));
    if (coupler.fixed || !other) return [];
    const at = place(joint), start = place(other.body === coupler ? other : other.base), pivot = place(base.body === body ? base : base.base);
    if (!at || !start || !pivot) return [];
    let arm = /** @type {Vector} */ ([pivot[0] - at[0], pivot[1] - at[1]]);
    if (base.description !== "revolute") {
      const velocity = slidingVelocity(motion, body, cursor), size = velocity ? Math.hypot(...velocity) : 0;
      if (!velocity || size === 0) return [];
      arm = [-velocity[1] / size, velocity[0] / size];  // normal to the direction in which it slides
    }
    const along = /** @type {Vector} */ ([start[0] - at[0], start[1] - at[1]]), full = Math.abs(Math.atan2(arm[0] * along[1] - arm[1] * along[0], arm[0] * along[0] + arm[1] * along[1]));
    return [{ body, place: at, arms: /** @type {[Vector, Vector]} */ ([along, arm]), angle: Math.min(full, Math.PI - full) }];
  });
}
