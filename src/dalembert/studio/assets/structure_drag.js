// Dragging in the drawing of a structure: nodes, corners, radii, tips of loads, and the rectangle of a selection.

/** @import { Change, Operation } from "./operations.js" */
/** @import { Page } from "./pictures.js" */
/** @import { Place } from "./snapping.js" */
/** @import { Part, Structure } from "./structure.js" */
/** @import { Handle, Loop, Spot } from "./structure_plan.js" */
/** @import { Tip } from "./structure_tips.js" */

import { neat } from "./neat.js";
import { valuesAfter } from "./preview.js";
import { placed } from "./snapping.js";
import { circle } from "./structure_plan.js";
import { tipAt, tipChange } from "./structure_tips.js";

/** What is dragged: handles with the nodes that follow, the tip of a load, or a rectangle of selection.
 * @typedef {{ kind: "handle" | "tip" | "box", handles: Handle[], tip: Tip | null, from: Place, to: Place, moved: boolean, values: number[] }} Drag */

/** Begin to drag, or select. @param {Structure} structure @param {PointerEvent} event @param {Spot} pixel */
export function grasp(structure, event, pixel) {
  const page = /** @type {Page} */ (structure.page), plan = /** @type {import("./structure_plan.js").Plan} */ (structure.plan), at = structure.world(pixel), values = [...(page.design?.values ?? [])];
  const begin = (/** @type {Drag["kind"]} */ kind, /** @type {Handle[]} */ handles, /** @type {Tip | null} */ tip, /** @type {Spot} */ [x, y]) => {
    page.scene.view.fitted = false;  // the drawing stays below the pointer
    structure.drag = { kind, handles, tip, from: placed(x, y), to: placed(x, y), moved: false, values };
  };
  const tip = structure.document && tipAt(page, structure.document, pixel);
  if (tip) {
    structure.select([{ section: "points", name: tip.node }], plan.targetAt(plan.nodes.get(tip.node) ?? at, structure.reach));
    begin("tip", [], tip, at);
    return true;
  }
  const handle = plan.handles.filter((one) => Math.hypot(one.at[0] - at[0], one.at[1] - at[1]) < structure.reach).sort((a, b) => Math.hypot(a.at[0] - at[0], a.at[1] - at[1]) - Math.hypot(b.at[0] - at[0], b.at[1] - at[1]))[0];
  const target = plan.targetAt(at, structure.reach * 0.7, true), region = plan.regionAt(at);
  const seen = handle || target ? null : page.motion.mesh?.hit(pixel, page.scene.seen()), pictured = seen?.kind === "element" ? String(page.motion.mesh.elements[seen.item]).split("[")[0] : "";
  const part = handle ? { section: "points", name: handle.name } : target?.kind === "edge" ? { section: "edges", name: target.name } : target ? { section: "elements", name: target.name } : region ? { section: "meshes", name: region.name } : ["elements", "meshes"].filter((section) => structure.document?.[section]?.[pictured]).map((section) => ({ section, name: pictured }))[0] ?? null;
  const has = (/** @type {Part} */ one) => structure.selection.some(({ section, name }) => section === one.section && name === one.name);
  if (!part && (event.pointerType === "touch" || event.altKey)) return false;  // pans
  if (event.shiftKey && part) structure.select(has(part) ? structure.selection.filter(({ name }) => name !== part.name) : [...structure.selection, part]);
  else if (part && !(has(part) && structure.selection.length > 1)) structure.select([part], target);
  else if (!part && !event.shiftKey) structure.select([]);
  const points = structure.selection.filter(({ section }) => section === "points").map(({ name }) => name);
  if (handle) begin("handle", points.includes(handle.name) ? plan.handles.filter(({ name }) => points.includes(name)) : [handle], null, handle.at);
  else if (!part) begin("box", [], null, at);
  return true;
}

/** End of a drag: its change, or the selection of a rectangle. @param {Structure} structure @param {PointerEvent} event */
export function release(structure, event) {
  const { drag, plan } = structure;
  structure.drag = null;
  if (!drag || !plan) return structure.tool.name !== "select";
  if (drag.kind === "box") {
    const { from: p, to: q } = drag, inside = (/** @type {Spot} */ [x, y]) => (x - p.x) * (x - q.x) <= 0 && (y - p.y) * (y - q.y) <= 0;
    const parts = [...plan.handles.filter(({ kind, at }) => kind !== "radius" && inside(at)).map(({ name }) => ({ section: "points", name })), ...plan.bars.filter(({ ends }) => ends.every(inside)).map(({ name }) => ({ section: "elements", name }))];
    structure.select([...(event.shiftKey ? structure.selection : []), ...(drag.moved ? parts : [])]);
  } else if (drag.moved) {
    structure.actions.commands.do(() => {
      const change = changeOf(structure, drag);
      if (change) structure.send(change);
    }, false);
  }
  structure.refresh();
  return true;
}

/** Change of the file by what is dragged. @param {Structure} structure @param {Drag} drag @returns {Change | null} */
export function changeOf(structure, { kind, handles, tip, from, to }) {
  const page = /** @type {Page} */ (structure.page);
  if (kind === "tip") return tip && structure.document && tipChange(structure.document, tip, structure.world(page.scene.view.screen([to.x, to.y])), page);
  return moved(handles, [to.x - from.x, to.y - from.y], [to.x, to.y]);
}

/** Let a live page compute what is dragged; at the place of the text it shows the text again. @param {Structure} structure @param {Drag} drag */
export function preview(structure, drag) {
  const { page, document } = structure, design = page?.design;
  if (!page || !document || !design || design.parameters.length !== drag.values.length) return;
  const next = valuesAfter(page, document, drag.values, changeOf(structure, drag)?.operations ?? []);
  if (next) design.replace(next, "drawing");
}

/** Place of a handle while others are dragged. @param {Structure} structure @param {Spot} p @returns {Spot} */
export function shifted(structure, p) {
  const { drag } = structure, held = drag?.kind === "handle" && drag.moved && drag.handles.find(({ at, kind }) => kind !== "radius" && at[0] === p[0] && at[1] === p[1]);
  return held && drag ? [p[0] + drag.to.x - drag.from.x, p[1] + drag.to.y - drag.from.y] : p;
}

/** Loops of a region while handles are dragged. @param {Structure} structure @param {Loop[]} loops @returns {Spot[][]} */
export function loopsNow(structure, loops) {
  const { drag } = structure, held = drag?.kind === "handle" && drag.moved ? drag.handles.find(({ kind }) => kind === "radius") : null;
  return loops.map(({ spots, center, radius }) => {
    if (!center || radius === undefined) return spots.map((p) => shifted(structure, p));
    const grows = held && drag && held.of === center;
    return circle(shifted(structure, center), grows ? Math.hypot(drag.to.x - center[0], drag.to.y - center[1]) : radius);
  });
}

/** Change that moves handles; a radius goes to a place. @param {Handle[]} handles @param {Spot} way @param {Spot | null} to @returns {Change | null} */
export function moved(handles, [dx, dy], to) {
  const operations = handles.flatMap(({ keys, kind, at: [x, y], of }) => {
    if (kind === "radius") return to && of ? [{ op: "set", keys, value: neat(Math.hypot(to[0] - of[0], to[1] - of[1])) }] : [];
    return [dx, dy].flatMap((shift, k) => (shift ? [{ op: "set", keys: [...keys, k], value: neat([x, y][k] + shift) }] : []));
  });
  return operations.length ? { label: `move ${handles.length > 1 ? `${handles.length} points` : handles[0].name}`, operations: /** @type {Operation[]} */ (operations) } : null;
}

