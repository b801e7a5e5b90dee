// Dialog in which the series of a plot, or its x-axis, are chosen.

/** @import { Series } from "./types.d.ts" */
/** @import { Plot } from "./plots.js" */
/** @import { Timeline } from "./timeline.js" */

import { el, iconButton } from "./dom.js";

/** @typedef {{ series: Series, box: HTMLInputElement, node: HTMLElement, text: string }} Row */

export class Picker {
  /** @param {HTMLDialogElement} dialog @param {Timeline} motion */
  constructor(dialog, motion) {
    this.dialog = dialog;
    this.motion = motion;
    /** Rows of the series, built when first needed. @type {Row[] | null} */
    this.rows = null;
    /** @type {Plot | null} */
    this.plot = null;
    /** Whether the x-axis is chosen. */
    this.across = false;
    this.title = el("h2", { id: "picker-title" });
    this.search = el("input", { type: "search", id: "search", placeholder: "Search name, unit or group", "aria-label": "Search series", autocomplete: "off", spellcheck: "false", oninput: () => this.filter() });
    this.body = el("div", { class: "choices" });
    this.status = el("p", { class: "status", "aria-live": "polite" });
    dialog.append(
      el("div", { class: "picker-head" }, this.title, iconButton("close", "Close", () => dialog.close())),
      this.search, this.body,
      el("div", { class: "picker-foot" }, this.status,
        el("button", { type: "button", class: "button", onclick: () => this.clear() }, "Clear"),
        el("button", { type: "button", class: "button primary", onclick: () => dialog.close() }, "Done")));
    dialog.addEventListener("click", (e) => { if (e.target === dialog) dialog.close(); });
    dialog.addEventListener("keydown", (e) => { if (e.key === "Enter" && e.target === this.search) dialog.close(); });
  }

  build() {
    /** @type {Row[]} */
    const rows = [];
    this.body.replaceChildren(...this.motion.groups.map(([group, members]) => el("fieldset", {}, el("legend", {}, group),
      members.map((series) => {
        const { name, unit } = series, box = el("input", { type: "checkbox", onchange: () => this.change() });
        const node = el("label", { class: "choice" }, box, el("span", { class: "name" }, name), el("span", { class: "unit" }, unit === "1" ? "–" : unit));
        rows.push({ series, box, node, text: `${name} ${unit} ${group}`.toLowerCase() });
        return node;
      }))));
    this.rows = rows;
    return rows;
  }

  /** Choose the series of a plot, or its x-axis. @param {Plot} plot */
  open(plot, across = false) {
    this.plot = plot;
    this.across = across;
    this.title.textContent = across ? "Choose the x-axis" : "Choose series";
    for (const { series, box } of this.rows ?? this.build()) box.checked = across ? plot.against === series : plot.series.includes(series);
    this.search.value = "";
    this.filter();
    this.allow();
    this.dialog.showModal();
    this.search.focus();
  }

  filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { node, text } of this.rows ?? []) node.hidden = !words.every((word) => text.includes(word));
    for (const group of /** @type {Iterable<HTMLElement>} */ (this.body.children)) group.hidden = !group.querySelector(".choice:not([hidden])");
  }

  /** Apply the choice; series keep the order in which they were chosen. */
  change() {
    const { plot, rows, across } = this;
    if (!plot || !rows) return;
    const checked = rows.filter(({ box }) => box.checked).map(({ series }) => series);
    if (across) {
      const series = checked.find((s) => s !== plot.against) ?? checked[0] ?? null;
      for (const row of rows) row.box.checked = row.series === series;
      plot.setAgainst(series);
    } else plot.setSeries([...plot.series.filter((s) => checked.includes(s)), ...checked.filter((s) => !plot.series.includes(s))]);
    this.allow();
  }

  /** Disable series of a third unit; show the choice. */
  allow() {
    const { plot, across } = this;
    if (!plot) return;
    for (const { series, box, node } of this.rows ?? []) {
      box.disabled = !across && !box.checked && !plot.accepts(series);
      node.title = box.disabled ? "A plot shows at most two units" : "";
    }
    this.status.textContent = across ? plot.against?.name ?? "Time" : `${plot.series.length || "None"} selected`;
  }

  clear() {
    for (const { box } of this.rows ?? []) box.checked = false;
    this.change();
  }
}
