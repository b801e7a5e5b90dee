// The dialog in which the series of a plot are chosen.

class Picker {
  constructor(dialog, motion) {
    Object.assign(this, { dialog, motion });
    this.search = el("input", { type: "search", id: "search", placeholder: "Search name, unit or group", "aria-label": "Search series", autocomplete: "off", spellcheck: "false", oninput: () => this.filter() });
    this.body = el("div", { class: "choices" });
    this.status = el("p", { class: "status", "aria-live": "polite" });
    dialog.append(
      el("div", { class: "picker-head" }, el("h2", { id: "picker-title" }, "Choose series"), iconButton("close", "Close", () => dialog.close())),
      this.search, this.body,
      el("div", { class: "picker-foot" }, this.status,
        el("button", { type: "button", class: "button", onclick: () => this.clear() }, "Clear"),
        el("button", { type: "button", class: "button primary", onclick: () => dialog.close() }, "Done")));
    dialog.addEventListener("click", (e) => { if (e.target === dialog) dialog.close(); });
    dialog.addEventListener("keydown", (e) => { if (e.key === "Enter" && e.target === this.search) dialog.close(); });
  }

  build() {
    const groups = new Map();
    for (const s of this.motion.series) groups.set(s.group, [...(groups.get(s.group) || []), s]);
    this.rows = [];
    this.body.replaceChildren(...[...groups].map(([group, members]) => el("fieldset", {}, el("legend", {}, group),
      members.map((series) => {
        const box = el("input", { type: "checkbox", onchange: () => this.change() });
        const node = el("label", { class: "choice" }, box, el("span", { class: "name" }, series.name), el("span", { class: "unit" }, series.unit === "1" ? "–" : series.unit));
        this.rows.push({ series, box, node, text: `${series.name} ${series.unit} ${group}`.toLowerCase() });
        return node;
      }))));
  }

  // The series of a plot, or the one that runs to the right in it.
  open(plot, across = false) {
    if (!this.rows) this.build();
    Object.assign(this, { plot, across });
    byId("picker-title").textContent = across ? "Choose the x-axis" : "Choose series";
    for (const { series, box } of this.rows) box.checked = across ? plot.against === series : plot.series.includes(series);
    this.search.value = "";
    this.filter();
    this.allow();
    this.dialog.showModal();
    this.search.focus();
  }

  filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { node, text } of this.rows) node.hidden = !words.every((word) => text.includes(word));
    for (const set of this.body.children) set.hidden = ![...set.querySelectorAll(".choice")].some((n) => !n.hidden);
  }

  // Keeps the order in which the series were chosen.
  change() {
    if (this.across) {
      const more = this.rows.find((r) => r.box.checked && r.series !== this.plot.against)?.series;
      const kept = this.rows.find((r) => r.box.checked)?.series;
      for (const { series, box } of this.rows) box.checked = series === (more ?? kept);
      this.plot.setAgainst(more ?? kept ?? null);
      this.allow();
      return;
    }
    const chosen = new Set(this.rows.filter((r) => r.box.checked).map((r) => r.series));
    const kept = this.plot.series.filter((s) => chosen.delete(s));
    this.plot.setSeries([...kept, ...chosen]);
    this.allow();
  }

  allow() {
    for (const { series, box, node } of this.rows) {
      box.disabled = !this.across && !box.checked && !this.plot.takes(series);
      node.title = box.disabled ? "A plot shows at most two units" : "";
    }
    const n = this.plot.series.length;
    if (this.across) { this.status.textContent = this.plot.against?.name ?? "Time"; return; }
    this.status.textContent = n ? `${n} selected` : "None selected";
  }

  clear() {
    for (const { box } of this.rows) box.checked = false;
    this.change();
  }
}
