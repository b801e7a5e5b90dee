// Designs of a table in a live page: a selected design sets the sliders, and sliders may leave it.

/** @import { Design } from "./live_design.js" */
/** @import { ParameterPanel } from "./live_panel.js" */
/** @import { LiveData } from "./types.d.ts" */

import { choice } from "./cards.js";

/** Number of the design that an address names; -1 without any. @param {string} address */
const designIn = (address) => Number(/^#design=(\d{1,9})$/.exec(address)?.[1] ?? -1);

/** Let the sliders follow the selected design and the selection the sliders; parameters that vary come first.
 * @param {Design} design @param {ParameterPanel} panel @param {LiveData} live */
export function linkDesigns(design, panel, { designs: rows, parameters }) {
  panel.node.querySelector(".parameters")?.prepend(...panel.rows.filter((_, k) => parameters[k].varies).map(({ node }) => node));
  if (!choice?.count || !rows) return;
  const first = choice.chosen, designs = choice;
  const presents = (/** @type {number} */ k) => rows[k]?.every((value, i) => value === design.values[i]) ?? false;
  const follow = () => designs.choose(presents(designs.chosen) ? designs.chosen : rows.findIndex((_, k) => presents(k)));
  design.row = () => (designs.chosen < 0 ? null : designs.chosen === first ? "" : `#design=${designs.chosen}`);

  const saved = document.documentElement.dataset.design ?? "", address = [location.hash, saved].find((text) => /^#(p|design)=/.test(text)) ?? "";
  if (!address.startsWith("#p=")) design.replace(rows[designIn(address)] ?? rows[first], "table");
  follow();
  design.onChange.on(follow);
  designs.onChoose.on((k) => {
    if (k < 0 || presents(k)) return;
    design.begin();
    design.replace(rows[k], "table");
    design.write();
  });
  addEventListener("hashchange", () => designs.choose(rows[designIn(location.hash)] ? designIn(location.hash) : designs.chosen));
}
