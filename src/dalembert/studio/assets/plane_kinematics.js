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

/** Instants at which a follower turns back: its limit positions. @param {any} motion @returns {{ body: any, cursor: { i: number, f: number } }[]} */
export function limitPositions(motion) {
  return followers(motion).flatMap((body) => {
    const slides = groundJoint(motion, body).description !== "revolute", limits = [];
    let direction = /** @type {Vector | null} */ (null);
    const speed = (/** @type {number} */ i) => {
      const twist = twistOf(motion, body, { i, f: 0 }), size = twist ? Math.hypot(twist.vx, twist.vy) : 0;
      if (!twist || !slides) return twist?.w ?? NaN;
      if (!direction && size > 0) direction = [twist.vx / size, twist.vy / size];
      return direction ? twist.vx * direction[0] + twist.vy * direction[1] : 0;
    };
    for (let i = 0, before = speed(0); i + 1 < motion.n; i++) {
      const after = speed(i + 1);
      if (before * after < 0) limits.push({ body, cursor: { i, f: before / (before - after) } });
      before = after;
    }
    return limits;
  });
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
      const twist = twistOf(motion, body, cursor), size = twist ? Math.hypot(twist.vx, twist.vy) : 0;
      if (!twist || size === 0) return [];
      arm = [-twist.vy / size, twist.vx / size];  // normal to the direction in which it slides
    }
    const along = /** @type {Vector} */ ([start[0] - at[0], start[1] - at[1]]), full = Math.abs(Math.atan2(arm[0] * along[1] - arm[1] * along[0], arm[0] * along[0] + arm[1] * along[1]));
    return [{ body, place: at, arms: /** @type {[Vector, Vector]} */ ([along, arm]), angle: Math.min(full, Math.PI - full) }];
  });
}
