// Start of a synthesis of six-bars: positions of their joints in one configuration.

/** Inversion → joints, and the link whose point or rotation follows the target. @type {Record<string, { joints: Record<string, [number, number]>, link: string, at: string }>} */
export const SIX_BARS = {
  "watt I": { joints: { B: [0, 0], F: [4, 0], A: [1, 0.5], D: [4.5, 3], C: [1.5, 0.2], E: [4, 5], G: [5.5, 3] }, link: "outer", at: "E" },
  "watt II": { joints: { B: [0, 0], A: [4, 0], C: [8, 0], F: [1, 0.5], D: [4.5, 3], E: [6.5, 2.2], G: [9, 3] }, link: "upper", at: "G" },
  "stephenson I": { joints: { A: [0, 0], D: [4, 0], B: [1, 0.3], E: [4.3, 3], C: [0.8, -0.5], F: [6, 2.5], G: [4.5, -1.5] }, link: "outer", at: "F" },
  "stephenson II": { joints: { G: [0, 0], F: [5, 0], C: [0.8, 0.2], A: [2, 2], B: [3, 0.8], D: [4.2, 2.5], E: [5, 1.5] }, link: "second", at: "E" },
  "stephenson III": { joints: { A: [0, 0], B: [3, 0], C: [5.5, 0], D: [0.6, 0.2], E: [3.2, 2.5], F: [2, 3], G: [6, 4.5] }, link: "upper", at: "G" },
};
/** Size of the path of a point relative to the unit of the joints. */
const PATH = 2;
/** Half width of the range of the coordinates relative to that unit. */
const REACH = 1;

/** Keys of [synthesis] for another linkage: for a six-bar its joints at the size and the place of the target.
 * @param {string} linkage @param {string} type of the target @param {number[][]} points of the target @returns {Record<string, unknown>} */
export function linkageFields(linkage, type, points) {
  const none = { joints: null, marks: null, reach: null, ratio: null, point: null, body: null, output: null }, own = SIX_BARS[linkage];
  if (!own) return { ...none, linkage };
  const [xs, ys] = [0, 1].map((k) => points.map((point) => point[k])), size = points.length > 1 ? Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)) : 0;
  const scale = size > 0 ? size / PATH : 0.1, [px, py] = own.joints[own.at], [cx, cy] = points.length ? [(Math.max(...xs) + Math.min(...xs)) / 2, (Math.max(...ys) + Math.min(...ys)) / 2] : [scale * px, scale * py];
  const short = (/** @type {number} */ value) => Number(value.toPrecision(6)), place = (/** @type {[number, number]} */ [x, y]) => [short(cx + scale * (x - px)), short(cy + scale * (y - py))];
  const joints = Object.fromEntries(Object.entries(own.joints).map(([name, at]) => [name, place(at)])), needs = type === "function" ? { output: `${own.link}.angle` } : { point: `${own.link}.P`, ...(type === "motion" && { body: own.link }) };
  return { ...none, crank_turns: null, transmission: null, linkage, joints, marks: { [own.link]: { P: place(own.joints[own.at]) } }, reach: short(REACH * scale), ...needs };
}
