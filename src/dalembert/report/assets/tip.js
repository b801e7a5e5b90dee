// Tip with the name and the values of the object under the pointer.

/** @import { Hit } from "./scene_types.d.ts" */
/** @import { Scene } from "./scene.js" */

import { el } from "./dom.js";
import { clamp } from "./numbers.js";
import { distance } from "./timeline.js";
import { inUnits, quantity } from "./units.js";

/** Show the tip beside the pointer, or hide it. @param {Scene} scene */
export function drawTip({ canvas: { clientWidth: w, clientHeight: h }, hover, motion, pointer, size, tip }) {
  tip.hidden = !hover || !pointer;
  if (!hover || !pointer) return;
  const { name, description, rows } = describe(hover, motion, size);
  tip.replaceChildren(el("strong", {}, name || description), el("span", { class: "what" }, name ? description : ""),
    el("dl", {}, rows.map(([label, value]) => [el("dt", {}, label), el("dd", {}, value)])));
  const [x, y] = pointer, left = x + 16 + tip.offsetWidth > w ? x - 14 - tip.offsetWidth : x + 16;
  tip.style.transform = `translate(${Math.max(4, left)}px, ${clamp(y + 14, 4, Math.max(4, h - tip.offsetHeight - 4))}px)`;
}

/** @param {Hit} hit @param {Scene["motion"]} motion @param {number} size */
function describe({ kind, item }, motion, size) {
  /** @type {[string, string][]} */
  const rows = [];
  if (motion.mesh && (kind === "node" || kind === "element")) {
    const { name, description, rows: values } = motion.mesh.describe(kind, item);
    return { name, description, rows: values.map(({ name, unit, value }) => [name, quantity(value, unit)]) };
  }
  if (kind === "link") {
    const [p, q] = [item.i, item.j].map(({ body, point }) => motion.at(body, point));
    if (p && q) rows.push(["length", inUnits([distance(p, q)], "m")]);
  } else {
    const place = kind === "body" ? motion.at(item, motion.point(null)) : motion.placeOf({ node: null, at: null, ...item });
    if (place) rows.push([motion.axes.join(", "), inUnits(place, "m", { scale: size })]);
  }
  if (kind === "body") rows.push(motion.rotationRow(item));
  if (kind === "point") rows.push(["on", item.body.name], ...item.names.slice(1).map((/** @type {string} */ name) => ["also", name]));
  for (const [key, unit] of /** @type {["force" | "moment", string][]} */ ([["force", "N"], ["moment", "N m"]])) {
    const value = motion.vectorOf(item[key] ?? null);
    if (!value?.every(Number.isFinite)) continue;
    rows.push([key, inUnits([value.length > 1 ? Math.hypot(...value) : value[0]], unit)]);
    if (value.length > 1) rows.push([motion.axes.map((axis) => `${key[0].toUpperCase()}${axis}`).join(", "), inUnits(value, unit)]);
  }
  return { name: item.name, description: item.description || kind, rows };
}
