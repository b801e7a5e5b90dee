// Palette of tools: one button for each group, which opens its tools.

import { el } from "./dom.js";
import { icon } from "./icons.js";
import { GROUPS, TOOLS } from "./tools.js";

export class Palette {
  /** @param {HTMLElement} parent @param {(name: string) => void} choose */
  constructor(parent, choose) {
    this.parent = parent;
    this.choose = choose;
    /** Tool of each group that was used last. @type {Map<string, string>} */
    this.latest = new Map(GROUPS.map((group) => [group, TOOLS.find((tool) => tool.group === group)?.name ?? ""]));
    this.groups = GROUPS.map((group) => this.groupOf(group));
    parent.append(...this.groups);
    this.show("select");
    document.addEventListener("pointerdown", ({ target }) => { if (!parent.contains(/** @type {Node} */ (target))) this.close(); });
    window.addEventListener("blur", () => this.close());
  }

  /** Button of a group and the list of its tools. @param {string} group */
  groupOf(group) {
    const tools = TOOLS.filter((tool) => tool.group === group), single = tools.length === 1;
    const items = tools.map(({ name, title, key, hint }) => el("button", { type: "button", class: "button tool", "data-tool": name, title: hint.join("; then "), onclick: () => this.use(name) }, icon(name), el("span", {}, title), key && el("kbd", {}, keyName(key))));
    const list = el("div", { class: "flyout", role: "group", "aria-label": group, hidden: true }, items);
    const main = el("button", { type: "button", class: "button group", "data-group": group, "aria-pressed": false, onclick: () => this.use(this.latest.get(group) ?? "") });
    const more = !single && el("button", { type: "button", class: "more", "aria-label": `${group}: all tools`, "aria-expanded": false, onclick: () => this.toggle(list) }, "▸");
    return el("div", { class: "entry" }, main, more, !single && list);
  }

  /** @param {string} name */
  use(name) {
    this.close();
    this.choose(name);
  }

  /** @param {HTMLElement} list */
  toggle(list) {
    const { hidden } = list;
    this.close();
    list.hidden = !hidden;
    list.previousElementSibling?.setAttribute("aria-expanded", String(hidden));
  }

  close() {
    for (const list of this.parent.querySelectorAll(".flyout")) {
      /** @type {HTMLElement} */ (list).hidden = true;
      list.previousElementSibling?.setAttribute("aria-expanded", "false");
    }
  }

  /** Show the chosen tool. @param {string} chosen */
  show(chosen) {
    const tool = TOOLS.find(({ name }) => name === chosen);
    if (tool) this.latest.set(tool.group, tool.name);
    GROUPS.forEach((group, k) => {
      const main = /** @type {HTMLElement} */ (this.groups[k].firstElementChild), latest = TOOLS.find(({ name }) => name === this.latest.get(group));
      main.setAttribute("aria-pressed", String(tool?.group === group));
      main.title = `${group}: ${latest?.title}${latest?.key ? ` (${keyName(latest.key)})` : ""}`;
      main.setAttribute("aria-label", latest?.title ?? group);
      main.dataset.tool = latest?.name ?? "";
      main.replaceChildren(icon(latest?.name ?? ""), el("span", { class: "caption" }, latest?.title ?? group));
    });
  }
}

/** Name of the key of a tool. @param {string} key */
export const keyName = (key) => (key === key.toUpperCase() ? `⇧${key}` : key.toUpperCase());
