// Sheet with the elements of the model: a tree, and the values of the selected one.

/** @import { Choice } from "./space_targets.js" */
/** @import { Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */

import { button, el } from "./dom.js";
import { accept } from "./field_values.js";
import { isRemovable, removal } from "./space_targets.js";

/** Sections of the tree, with their titles. */
const SECTIONS = /** @type {const} */ ([["bodies", "Bodies"], ["joints", "Joints"], ["drivers", "Drivers"], ["forces", "Forces"], ["parameters", "Parameters"]]);
/** Fields that are not edited here. */
const FIXED = ["type"];

/** @typedef {{ select: (choice: Choice) => void, edit: (label: string, operations: Operation[]) => void, hide: (name: string) => void, isolate: (name: string) => void, showAll: () => void }} TreeActions */

/** Whether two choices are the same. @param {Choice | null} a @param {Choice | null} b */
export const isSame = (a, b) => Boolean(a && b && a.section === b.section && a.name === b.name && a.part === b.part && a.key === b.key);

export class ModelTree {
  /** @param {TreeActions} actions */
  constructor(actions) {
    this.actions = actions;
    /** What is shown: the document, and a text of the rest. @type {[Document | null, string]} */
    this.shown = [null, ""];
    this.tree = el("div", { class: "tree", role: "tree", "aria-label": "Elements of the model" });
    this.values = el("div", { class: "values" });
    this.node = el("div", { class: "sheet model", id: "model" }, this.tree, this.values);
  }

  /** @param {Document | null} document @param {Choice | null} selected @param {Set<string>} hidden names of bodies @param {boolean} hides whether bodies can be hidden */
  show(document, selected, hidden, hides) {
    const rest = JSON.stringify([selected, [...hidden], hides]);
    if (!document || (this.shown[0] === document && this.shown[1] === rest)) return;  // such as while the pointer moves
    this.shown = [document, rest];
    const bodies = Object.keys(document.bodies ?? {}), parts = SECTIONS.filter(([section]) => Object.keys(document[section] ?? {}).length || section === "bodies");
    const ground = this.children({ section: "ground", name: "ground" }, document.ground, selected);
    this.tree.replaceChildren(...(ground.length ? [el("div", { class: "heading" }, el("h2", {}, "Ground")), ...ground] : []), ...parts.flatMap(([section, title]) => [
      el("div", { class: "heading" }, el("h2", {}, title), section === "bodies" && hides && hidden.size > 0 && button("Show all", this.actions.showAll, { class: "link" })),
      ...Object.entries(document[section] ?? {}).flatMap(([name, entry]) => this.rows({ section, name }, entry, selected, hides && section === "bodies" ? hidden : null)),
      !bodies.length && section === "bodies" && el("p", { class: "muted" }, "No elements yet: choose a tool."),
    ].filter((node) => node !== false)));
    this.showValues(document, selected);
  }

  /** @param {Choice} choice @param {any} entry @param {Choice | null} selected @param {Set<string> | null} hidden */
  rows(choice, entry, selected, hidden) {
    const { name, section } = choice, off = hidden?.has(name) ?? false;
    const eye = hidden && button(off ? "○" : "●", () => this.actions.hide(name), { class: "eye", title: off ? `Show ${name}` : `Hide ${name}`, "aria-label": off ? `Show ${name}` : `Hide ${name}`, "aria-pressed": String(!off) });
    const alone = hidden && button("only", () => this.actions.isolate(name), { class: "link only", title: `Show only ${name}`, "aria-label": `Show only ${name}` });
    return [this.row(choice, name, entry?.type ?? (section === "bodies" ? "Body" : ""), selected, off, eye, alone), ...this.children(choice, section === "bodies" ? entry : null, selected)];
  }

  /** Points and frames of a body. @param {Choice} owner @param {any} entry @param {Choice | null} selected */
  children(owner, entry, selected) {
    return /** @type {const} */ (["points", "frames"]).flatMap((part) => Object.keys(entry?.[part] ?? {}).map((key) =>
      this.row({ ...owner, part, key }, key, part === "points" ? "point" : "frame", selected, false)));
  }

  /** @param {Choice} choice @param {string} text @param {string} kind @param {Choice | null} selected @param {boolean} off @param {...(HTMLElement | null)} more */
  row(choice, text, kind, selected, off, ...more) {
    const chosen = isSame(choice, selected), attributes = { type: "button", class: "name", role: "treeitem", "aria-selected": String(chosen), "data-section": choice.section, "data-name": choice.name, onclick: () => this.actions.select(choice) };
    return el("div", { class: `row${chosen ? " chosen" : ""}${off ? " off" : ""}${choice.part ? " part" : ""}` }, el("button", attributes, el("span", {}, text), el("small", {}, kind)), ...more);
  }

  /** Values of the selected entry. @param {Document} document @param {Choice | null} selected */
  showValues(document, selected) {
    const entry = selected && (selected.section === "ground" ? document.ground : document[selected.section]?.[selected.name]);
    if (!selected || entry === undefined || entry === null || (selected.part && entry[selected.part]?.[selected.key ?? ""] === undefined)) return this.values.replaceChildren();
    const { section, name, part, key } = selected, root = section === "ground" ? ["ground"] : [section, name];
    const shown = part ? entry[part]?.[/** @type {string} */ (key)] : entry, keys = part ? [...root, part, /** @type {string} */ (key)] : root;
    const title = part ? `${name}.${key}` : name, rename = el("input", { type: "text", class: "rename", value: title, "aria-label": "Name", disabled: Boolean(part), onchange: () => this.actions.edit(`rename ${name}`, [{ op: "rename", section, name, to: rename.value.trim() }]) });
    const remove = isRemovable(document, selected) ? button("Delete", () => this.actions.edit(`delete ${title}`, [removal(selected)])) : null;
    this.values.replaceChildren(el("div", { class: "heading" }, rename, remove), ...this.fields(keys, shown, ""));
  }

  /** Inputs of the numbers of a value. @param {(string | number)[]} keys @param {any} value @param {string} label @returns {HTMLElement[]} */
  fields(keys, value, label) {
    const input = (/** @type {(string | number)[]} */ path, /** @type {any} */ old, /** @type {string} */ name) => {
      const field = el("input", { type: "text", value: String(old), "aria-label": name, spellcheck: "false", onchange: () => accept(field, { required: "A value is needed here; the former one is kept" }, old, (value) => this.write(path, old, value, name)) });
      return field;
    };
    const plain = (/** @type {any} */ part) => typeof part === "number" || typeof part === "string";
    if (plain(value)) return FIXED.includes(String(keys.at(-1))) ? [] : [el("label", { class: "field" }, el("span", {}, label), el("span", { class: "inputs" }, input(keys, value, label)))];
    if (Array.isArray(value) && value.every((part) => typeof part === "number" || typeof part === "string") && keys.at(-1) !== "connect") {
      return [el("div", { class: "field" }, el("span", {}, label || "at"), el("span", { class: "inputs" }, value.map((part, k) => input([...keys, k], part, `${label || "at"} ${"xyz"[k] ?? k + 1}`))))];
    }
    if (Array.isArray(value)) return value.flatMap((part, k) => (plain(part) ? [el("div", { class: "field" }, el("span", {}, label === "connect" ? `end ${k + 1}` : ""), el("span", { class: "muted" }, String(part)))] : this.fields([...keys, k], part, label === "connect" ? part.body : String(k + 1))));
    if (!value || typeof value !== "object") return [];
    return Object.entries(value).filter(([key]) => !["points", "frames", "body"].includes(key)).flatMap(([key, part]) => this.fields([...keys, key], part, label && label !== "connect" ? `${label}.${key}` : key));
  }

  /** @param {(string | number)[]} keys @param {unknown} old @param {string | number | null} value @param {string} name */
  write(keys, old, value, name) {
    if (String(value) !== String(old)) this.actions.edit(`set ${name}`, [{ op: "set", keys, value }]);
  }
}
