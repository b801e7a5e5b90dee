// Sheet "Contacts": shapes by groups, and friction and restitution between two groups.

/** @import { Document } from "./types.d.ts" */

import { numberField } from "./analysis.js";
import { collisionsIn, groupsOf } from "./contact_shapes.js";
import { button, el } from "./dom.js";
import { entered } from "./field_values.js";

const COEFFICIENTS = { friction: "Friction", restitution: "Restitution" };

export class ContactSheet {
  /** @param {{ edit: (label: string, operations: Record<string, unknown>[]) => void, draw: (tool: string) => void }} actions */
  constructor(actions) {
    this.actions = actions;
    this.node = el("section", { class: "sheet contacts" });
    this.show(null);
  }

  /** @param {Document | null} document */
  show(document) {
    const { gravity, dimension } = /** @type {any} */ (document ?? {}), isSpatial = dimension === 3 || (dimension === undefined && Array.isArray(gravity) && gravity.length === 3);
    const focused = /** @type {HTMLInputElement | null} */ (this.node.querySelector(":focus")), same = () => /** @type {NodeListOf<HTMLElement>} */ (this.node.querySelectorAll(`[name="${CSS.escape(focused?.name ?? "")}"]`)), at = [...same()].indexOf(/** @type {HTMLElement} */ (focused));
    const about = isSpatial ? "Shapes of contacts of spatial models are written in the text." : "Shapes are attached to bodies by clicks.";
    const tools = el("div", { class: "chips" }, [["circle", "Circle"], ["capsule", "Capsule"], ["polygon", "Polygon"], ["halfplane", "Half plane"]].map(([tool, title]) => button(title, () => this.actions.draw(tool))));
    this.node.replaceChildren(el("p", { class: "muted" }, `${about} Bodies with shapes touch each other; groups of shapes may have their own friction and restitution.`), ...(isSpatial ? [] : [tools]), ...collisionsIn(document).map(([name, entry]) => this.element(name, entry)));
    same()[at]?.focus();
  }

  /** @param {string} name @param {any} entry */
  element(name, entry) {
    const groups = groupsOf(entry), names = Object.keys(groups), pairs = names.flatMap((one, k) => names.slice(k).map((other) => [one, other]));
    const set = (/** @type {string} */ label, /** @type {string[]} */ keys, /** @type {unknown} */ value) => this.actions.edit(label, [{ op: "set", keys: ["forces", name, ...keys], value, written: true }]);
    const keys = Object.entries(COEFFICIENTS).filter(([key]) => key !== "restitution" || !entry.law);
    const all = el("div", { class: "fields" }, keys.map(([key, label]) => numberField({ key, label, empty: "0" }, entry[key], (value) => (value === null ? this.actions.edit(`remove ${key}`, [{ op: "drop", keys: ["forces", name, key] }]) : set(`set ${key}`, [key], value)))), entry.law && el("p", { class: "muted" }, `Normal force: ${entry.law.type ?? entry.law}`));
    const drop = (/** @type {string} */ group, /** @type {number} */ k) => {
      if (groups[group].length > 1) return this.actions.edit("remove shape", [{ op: "remove shape", name, group, index: k }]);
      if (names.length < 2) return this.actions.edit("remove contacts", [{ op: "remove", section: "forces", name }]);
      this.actions.edit("remove group", [{ op: "remove group", name, group }]);
    };
    const list = names.map((group) => el("fieldset", {}, el("legend", {}, group || "shapes"), el("ul", { class: "plain" }, groups[group].map((shape, k) => el("li", {}, typeof shape === "string" ? shape : `${shape.type}${shape.radius === undefined ? "" : `, radius ${shape.radius}`} `, button("×", () => drop(group, k), { class: "button quiet", "aria-label": `Remove shape ${k + 1} of ${group || "the list"}` }))))));
    const table = names.length > 1 || names[0] ? el("table", {}, el("thead", {}, el("tr", {}, ["groups", ...Object.values(COEFFICIENTS), "touch"].map((text) => el("th", { scope: "col" }, text)))), el("tbody", {}, pairs.map((pair) => this.row(name, entry, pair)))) : "";
    return el("div", { class: "form" }, el("h3", {}, name), all, ...list, table);
  }

  /** Own law of two groups. @param {string} name @param {any} entry @param {string[]} groups */
  row(name, entry, groups) {
    const pairs = /** @type {any[]} */ (entry.pairs ?? []), at = pairs.findIndex((pair) => [...(pair.groups ?? [])].sort().join() === [...groups].sort().join()), pair = pairs[at] ?? {};
    const change = (/** @type {Record<string, unknown>} */ fields) => {
      const next = Object.fromEntries(Object.entries({ groups, ...pair, ...fields }).filter(([, value]) => value !== null)), list = (at < 0 ? [...pairs, next] : pairs.map((old, k) => (k === at ? next : old))).filter((item) => Object.keys(item).length > 1), keys = ["forces", name, "pairs"];
      this.actions.edit(`set contact ${groups.join("/")}`, [list.length ? { op: "set list", keys, value: list } : { op: "drop", keys }]);
    };
    const touch = el("input", { type: "checkbox", name: `touch-${groups.join("-")}`, "aria-label": `${groups.join(" and ")} touch`, onchange: () => change({ touching: touch.checked ? null : false }) });
    touch.checked = pair.touching !== false;
    const cells = Object.keys(COEFFICIENTS).map((key) => {
      const law = key === "restitution" && (pair.law ?? entry.law), of = `${key} of ${groups.join(" and ")}`;
      const input = el("input", { name: `${key}-${groups.join("-")}`, value: String(pair[key] ?? ""), placeholder: law ? law.type ?? law : String(entry[key] ?? 0), inputmode: "text", disabled: pair.touching === false || Boolean(law), "aria-label": of, onchange: () => {
        const typed = entered(input.value, {}), problem = "problem" in typed ? typed.problem : "";
        input.setAttribute("aria-invalid", String(Boolean(problem)));
        input.setCustomValidity(problem);
        if ("value" in typed) change({ [key]: typed.value });
        else input.reportValidity();
      } });
      return el("td", {}, input);
    });
    return el("tr", {}, el("th", { scope: "row" }, groups.join(" / ")), ...cells, el("td", {}, touch));
  }
}
