// Tables of the displacements, elements and reactions of a structure.

/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */
/** @import { Row } from "./sorted_table.js" */

import { el } from "./dom.js";
import { panel } from "./panels.js";
import { SortedTable } from "./sorted_table.js";
import { quantity } from "./units.js";

/** Rows of the supported nodes. @param {Mesh} mesh @param {string[]} forces @returns {Row[]} */
function reactionRows({ nodes, reactions, state }, forces) {
  /** @type {Map<string, Row>} */
  const rows = new Map();
  for (const { node, name, values } of reactions) {
    const row = rows.get(node) ?? /** @type {Row} */ ([node, ...forces.map(() => null)]);
    row[1 + forces.indexOf(name)] = values[state];
    rows.set(node, row);
  }
  const order = new Map(nodes.map((name, k) => [name, k]));
  return [...rows.values()].sort((a, b) => (order.get(a[0]) ?? 0) - (order.get(b[0]) ?? 0));
}

/** Cards of a structure, which follow its state. @param {Motion} motion @param {Mesh} mesh */
export function structureTables(motion, mesh) {
  const title = mesh.relative ? "Shape" : "Displacements", forces = ["fx", "fy", "fz", "mx", "my", "mz"].filter((force) => mesh.reactions.some(({ name }) => name === force));
  const displacements = new SortedTable(title, [{ name: "node" }, ...mesh.directions.map((name) => ({ name, unit: mesh.unitOf(name) }))]);
  const reactions = new SortedTable("Reactions", [{ name: "node" }, ...forces.map((name) => ({ name, unit: name[0] === "m" ? "N m" : "N" }))]);
  const measured = mesh.fields.filter(({ atVertices }) => !atVertices);
  const elements = new SortedTable("Elements", [{ name: "element" }, ...measured.map(({ name, unit }) => ({ name: name.replaceAll("_", " "), unit: unit === "1" ? "" : unit }))]);
  const total = el("p", { class: "caption note" });
  /** State and mesh of the rows. */
  let shown = { state: -1, mesh };
  const refresh = () => {
    const { mesh: present, state } = motion;
    if (!present || (state === shown.state && present === shown.mesh)) return;
    shown = { state, mesh: present };
    present.cursor = motion.cursor;
    displacements.fill(present.nodes.map((name, k) => [name, ...present.components(k).map((c) => c?.value)]));
    elements.fill(present.elements.map((name, k) => [name, ...present.fields.filter(({ atVertices }) => !atVertices).map((field) => present.valueOf(field, k))]));
    const rows = reactionRows(present, forces), largest = Math.max(0, ...rows.flatMap(([, ...values]) => values.map((v) => Math.abs(Number(v ?? 0)))));
    reactions.fill(rows);
    const sums = forces.filter((name) => name[0] === "f").map((name) => {
      const sum = rows.reduce((s, row) => s + (Number(row[1 + forces.indexOf(name)]) || 0), 0);
      return `${name} ${quantity(Math.abs(sum) < 1e-10 * largest ? 0 : sum, "N")}`;
    });
    total.textContent = `sum: ${sums.join(", ")}`;
  };
  motion.onState.on(refresh);
  refresh();
  const relative = "Relative to the largest displacement, because a mode shape has no absolute scale. Element values are relative to the largest value as well.";
  return el("div", { class: "tables" },
    panel(title, "displacements", displacements.node, mesh.relative && el("p", { class: "caption note" }, relative)),
    measured.length > 0 && panel("Elements", "elements", elements.node),
    mesh.reactions.length > 0 && panel("Reactions", "reactions", reactions.node, total));
}
