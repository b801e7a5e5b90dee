// Poses of the bodies of a picture: hidden bodies, and those that are being moved.

/** @import { Page } from "./pictures.js" */
/** @import { Vec } from "./space_math.js" */

/** Position and rotation. @typedef {{ p: Vec, q: Vec }} Pose */

export class Poses {
  /** @param {Page} page @param {Set<string>} hidden names of bodies */
  constructor(page, hidden) {
    this.page = page;
    /** Bodies that are shown elsewhere than they are. @type {Map<string, Pose>} */
    this.moved = new Map();
    const { motion } = page, pose = motion.pose.bind(motion);
    this.original = pose;
    motion.pose = (/** @type {any} */ body, /** @type {any} */ cursor) => {
      const own = pose(body, cursor), elsewhere = cursor === undefined || cursor === motion.cursor ? this.moved.get(body.name) : undefined;
      if (!own || body.fixed) return own;
      if (hidden.has(body.name) || hidden.has(body.of?.name)) return null;
      return elsewhere ? { p: own.p.clone().set(...elsewhere.p), q: own.q.clone().set(...elsewhere.q.slice(1), elsewhere.q[0]) } : own;
    };
  }

  /** @param {string} name */
  body(name) { return name === "ground" ? this.page.motion.ground : this.page.motion.bodies.find((/** @type {any} */ body) => body.name === name && !body.of) ?? null; }

  /** Pose in the picture, whether the body is shown or not. @param {string} name @returns {Pose | null} */
  of(name) {
    const body = this.body(name), pose = body && this.original(body);
    return pose ? { p: pose.p.toArray(), q: [pose.q.w, pose.q.x, pose.q.y, pose.q.z] } : null;
  }
}

/** Poses and points as they are now, which a computed preview does not change. @param {Poses} poses @returns {Poses} */
export function stillPoses(poses) {
  const { page } = poses, { motion } = page, names = [...new Set(["ground", ...motion.bodies.map((/** @type {any} */ body) => body.name)])];
  const own = new Map(names.map((name) => [name, poses.of(name)])), places = motion.points.map((/** @type {any} */ { body, point }) => ({ body, point, at: motion.at(body, point) }));
  const still = Object.assign(Object.create(motion), { at: (/** @type {any} */ body, /** @type {any} */ point) => places.find((/** @type {any} */ one) => one.body === body && one.point === point)?.at ?? motion.at(body, point) });
  return Object.assign(Object.create(poses), { of: (/** @type {string} */ name) => own.get(name) ?? null, page: { ...page, motion: still } });
}
