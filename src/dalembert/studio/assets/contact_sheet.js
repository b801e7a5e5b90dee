// Sheet "Contacts": shapes by groups, and friction and restitution between two groups.

/** @import { Document } from "./types.d.ts" */

import { numberField } from "./analysis.js";
import { pairAt, pairChange } from "./contact_laws.js";
import { collisionsIn, groupsOf } from "./contact_shapes.js";
import { button, el } from "./dom.js";
import { accept } from "./field_values.js";
import { isSpatialMechanism } from "./model_dimension.js";
import { valueChange } from "./row_changes.js";

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
    const isSpatial = isSpatialMechanism(document);
    const focused = /** @type {HTMLInputElement | null} */ (this.node.querySelector(":focus")), same = () => /** @type {NodeListOf<HTMLElement>} */ (this.node.querySelectorAll(`[name="${CSS.escape(focused?.name ?? "")}"]`)), at = [...same()].indexOf(/** @type {HTMLElement} */ (focused));
    const about = isSpatial ? "Shapes of contacts of spatial models are written in the text." : "Shapes are attached to bodies by clicks.";
    const tools = el("div", { class: "chips" }, [["circle", "Circle"], ["capsule", "Capsule"], ["polygon", "Polygon"], ["halfplane", "Half plane"]].map(([tool, title]) => button(title, () => this.actions.draw(tool))));
    this.node.replaceChildren(el("p", { class: "muted" }, `${about} Bodies with shapes touch each other; groups of shapes may have their own friction and restitution.`), ...(isSpatial ? [] : [tools]), ...collisionsIn(document).map(([name, entry]) => this.element(name, entry)));
    same()[at]?.focus();
  }

  /** @param {string} name @param {any} entry */
  element(name, entry) {
    const groups = groupsOf(entry), names = Object.keys(groups), pairs = names.flatMap((one, k) => names.slice(k).map((other) => [one, other]));
    const change = (/** @type {string} */ label, /** @type {import("./operations.js").Operation[]} */ operations) => void (operations.length && this.actions.edit(label, operations));
    const keys = Object.entries(COEFFICIENTS).filter(([key]) => key !== "restitution" || !entry.law);
    const all = el("div", { class: "fields" }, keys.map(([key, label]) => numberField({ key, label, empty: "0" }, entry[key], (value) => change(`${value === null ? "remove" : "set"} ${key}`, valueChange(["forces", name], entry, key, value)))), entry.law && el("p", { class: "muted" }, `Normal force: ${entry.law.type ?? entry.law}`));
    const drop = (/** @type {string} */ group, /** @type {number} */ k) => {
      if (groups[group].length > 1) return change("remove shape", [{ op: "remove_item", keys: ["forces", name, "shapes", ...(group ? [group] : []), k] }]);
      if (names.length < 2) return this.actions.edit("remove contacts", [{ op: "remove", section: "forces", name }]);
      this.actions.edit("remove group", [{ op: "remove group", name, group }]);
    };
    const list = names.map((group) => el("fieldset", {}, el("legend", {}, group || "shapes"), el("ul", { class: "plain" }, groups[group].map((shape, k) => el("li", {}, typeof shape === "string" ? shape : `${shape.type}${shape.radius === undefined ? "" : `, radius ${shape.radius}`} `, button("×", () => drop(group, k), { class: "button quiet", "aria-label": `Remove shape ${k + 1} of ${group || "the list"}` }))))));
    const table = names.length > 1 || names[0] ? el("table", {}, el("thead", {}, el("tr", {}, ["groups", ...Object.values(COEFFICIENTS), "touch"].map((text) => el("th", { scope: "col" }, text)))), el("tbody", {}, pairs.map((pair) => this.row(name, entry, pair)))) : "";
    return el("div", { class: "form" }, el("h3", {}, name), all, ...list, table);
  }

  /** Own law of two groups. @param {string} name @param {any} entry @param {string[]} groups */
  row(name, entry, groups) {
    const pair = entry.pairs?.[pairAt(entry, groups)] ?? {};
    const change = (/** @type {string} */ key, /** @type {unknown} */ value) => {
      const operations = pairChange(name, entry, groups, key, value);
      if (operations.length) this.actions.edit(`${value === null ? "remove" : "set"} ${key} of ${groups.join("/")}`, operations);
    };
    const touch = el("input", { type: "checkbox", name: `touch-${groups.join("-")}`, "aria-label": `${groups.join(" and ")} touch`, onchange: () => change("touching", touch.checked ? null : false) });
    touch.checked = pair.touching !== false;
    const cells = Object.keys(COEFFICIENTS).map((key) => {
      const law = key === "restitution" && (pair.law ?? entry.law), old = pair[key] ?? "";
      const input = el("input", { name: `${key}-${groups.join("-")}`, value: String(old), placeholder: law ? law.type ?? law : String(entry[key] ?? 0), inputmode: "text", disabled: pair.touching === false || Boolean(law), title: "number or formula; empty for the value of all contacts", "aria-label": `${key} of ${groups.join(" and ")}`, spellcheck: "false", autocomplete: "off", onchange: () => accept(input, {}, old, (value) => change(key, value)) });
      return el("td", {}, input);
    });
    return el("tr", {}, el("th", { scope: "row" }, groups.join(" / ")), ...cells, el("td", {}, touch));
  }
}
