// Kept designs of a live page: a table of their parameters and responses side by side.

/** @import { LiveResult } from "./types.d.ts" */
/** @import { Snapshot } from "./live_ghosts.js" */
/** @import { Design } from "./live_design.js" */
/** @import { LivePicture } from "./live_picture.js" */
/** @import { ResponseTable } from "./live_table.js" */

import { el, icon, iconButton } from "./dom.js";
import { designSnapshot } from "./live_ghosts.js";
import { valueIn } from "./live_table.js";
import { tidy } from "./numbers.js";
import { raised } from "./units.js";

/** @typedef {{ letter: string, values: number[], result: LiveResult, snapshot: Snapshot, shown: boolean }} Kept */

/** Letters of the k-th design: A … Z, AA … @param {number} k @returns {string} */
const lettersOf = (k) => (k < 26 ? "" : lettersOf(Math.floor(k / 26) - 1)) + String.fromCharCode(65 + (k % 26));

export class KeptDesigns {
  /** @param {Design} design @param {ResponseTable} table @param {LivePicture} picture */
  constructor(design, table, picture) {
    this.design = design;
    this.table = table;
    this.picture = picture;
    /** @type {Kept[]} */
    this.designs = [];
    this.count = 0;
    this.button = el("button", { type: "button", class: "button", id: "keep", title: "Keep this design for comparison", onclick: () => this.keep() }, icon("plus"), "Keep");
    this.head = el("tr");
    this.body = el("tbody");
    this.node = el("section", { class: "card live kept", id: "kept", "aria-label": "Kept designs", hidden: true }, el("div", { class: "plot-head" }, el("h2", {}, "Designs")),
      el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of designs" }, el("table", { class: "figures" }, el("thead", {}, this.head), this.body)));
    for (const signal of [table.onList, table.onSelect]) signal.on(() => this.fill());
    design.onChange.on(() => this.mark());
  }

  /** Keep the design that is drawn. */
  keep() {
    const { result } = this.picture;
    if (!result) return;
    const values = Array.from(result.parameters), letter = lettersOf(this.count++);
    this.designs.push({ letter, values, result, snapshot: designSnapshot(`design ${letter}`), shown: false });
    this.fill();
  }

  /** @param {Kept} kept */
  remove(kept) {
    this.designs = this.designs.filter((other) => other !== kept);
    this.draw();
    this.fill();
  }

  /** Draw the shown designs as ghosts. */
  draw() {
    this.picture.ghosts.kept = this.designs.filter(({ shown }) => shown).map(({ snapshot }) => snapshot);
    this.picture.renew();
  }

  /** @param {Kept} kept */
  heading(kept) {
    const { letter } = kept;
    const recall = el("button", { type: "button", class: "sort letter", title: `Return to design ${letter}`, onclick: () => { this.design.begin(); this.design.replace(kept.values, "kept"); } }, letter);
    const eye = el("button", { type: "button", class: "icon tiny", "aria-pressed": String(kept.shown), "aria-label": `Show design ${letter} in the drawing`, title: `Show design ${letter} in the drawing`, onclick: () => {
      kept.shown = !kept.shown;
      eye.setAttribute("aria-pressed", String(kept.shown));
      this.draw();
    } }, icon("eye"));
    return el("th", { scope: "col", class: "right" }, el("span", { class: "kept-head" }, recall, eye, iconButton("close", `Remove design ${letter}`, () => this.remove(kept), { class: "icon tiny" })));
  }

  fill() {
    this.node.hidden = !this.designs.length;
    const { parameters, initial } = this.design, { responses } = this.table, first = this.table.initial;
    /** @type {{ values: number[], result: LiveResult | null }[]} */
    const columns = [{ values: initial, result: first }, ...this.designs];
    this.head.replaceChildren(el("th", { scope: "col", "aria-label": "Quantity" }), el("th", { scope: "col", class: "right" }, "Initial"), ...this.designs.map((kept) => this.heading(kept)), el("th", { scope: "col" }, "Unit"));
    const row = (/** @type {string} */ name, /** @type {string} */ unit, /** @type {number[]} */ values, look = "") => el("tr", { class: look }, el("th", { scope: "row" }, name),
      values.map((value) => el("td", { class: `right${value === values[0] ? " same" : ""}` }, tidy(value, 5))), el("td", { class: "unit" }, unit && unit !== "1" ? raised(unit) : ""));
    this.body.replaceChildren(
      ...parameters.flatMap(({ name, unit, factor, drawn }, k) => drawn ? [] : row(name, unit, columns.map(({ values }) => values[k] / factor))),
      ...responses.map((response, k) => row(response.label, response.unit, columns.map(({ result }) => (result ? valueIn(result, response) : NaN)), k ? "" : "first-response")));
    this.mark();
  }

  /** Mark the design that is present. */
  mark() {
    this.designs.forEach(({ values }, k) => {
      const present = values.every((value, i) => value === this.design.values[i]), cell = this.head.cells[k + 2];
      if (present) cell?.setAttribute("aria-current", "true"); else cell?.removeAttribute("aria-current");
    });
  }
}
