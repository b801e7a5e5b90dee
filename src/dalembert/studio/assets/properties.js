// Properties of the selected element: its numbers with units, its name, and what can be done with it.

/** @import { Completion } from "./completion.js" */
/** @import { Drawing } from "./drawing.js" */

import { ask } from "./ask.js";
import { button, el } from "./dom.js";
import { remove, rename } from "./editing.js";
import { accept } from "./field_values.js";
import { sectionOf } from "./selection.js";

/** Keys that are not numbers of an element. */
const OTHER = ["type", "joint", "reaction_on", "description"];

/** @typedef {(string | number)[]} Keys */

export class Properties {
  /** @param {HTMLElement} parent whose last child, the problems, it precedes @param {Drawing} drawing @param {() => Completion | null} completion */
  constructor(parent, drawing, completion) {
    this.drawing = drawing;
    this.completion = completion;
    this.node = el("aside", { class: "properties", "aria-label": "Properties of the selection", hidden: true });
    parent.insertBefore(this.node, parent.lastElementChild);
    this.shown = "";
  }

  /** Show the selection as it is in the file. */
  show() {
    const { document, selection } = this.drawing;
    if (!document) return;
    const names = [...selection].filter((name) => sectionOf(document, name));
    const state = JSON.stringify(names.map((name) => [name, document[sectionOf(document, name) ?? ""]?.[name]]));
    if (state === this.shown) return;
    this.shown = state;
    this.node.hidden = !names.length;
    this.node.replaceChildren(...(names.length === 1 ? this.element(names[0]) : this.several(names)).filter((child) => child !== null));
  }

  /** @param {string[]} names */
  several(names) {
    const { drawing } = this;
    return [el("h3", {}, `${names.length} elements`), el("div", { class: "chips" }, button("Duplicate", () => drawing.keys.duplicate(), { title: "Ctrl+D" }), button("Mirror", () => drawing.keys.mirror(), { title: "Left and right (H)" }), button("Rotate", () => drawing.keys.rotate(1), { title: "By 15° (R)" }), button("Delete", () => this.remove(names), { title: "Delete" }))];
  }

  /** @param {string} name */
  element(name) {
    const document = /** @type {import("./types.d.ts").Document} */ (this.drawing.document), section = sectionOf(document, name) ?? "", entry = document[section]?.[name] ?? {};
    const rows = numbersOf(entry, []).map(({ keys, value }) => this.row([section, name, ...keys], value, section, name));
    const missing = this.fields(section, name).filter(([key]) => !(key in entry)).map(([key]) => this.row([section, name, key], "", section, name));
    const more = missing.length ? el("details", {}, el("summary", {}, "More"), missing) : null;
    const type = el("span", { class: "type" }, String(entry.type ?? section.slice(0, -1)));
    const body = section === "bodies";
    return [el("h3", {}, button(name, () => void this.rename(name), { class: "name", title: "Rename (F2)" }), type), el("div", { class: "rows" }, rows), more,
      el("div", { class: "chips" }, body && button("Duplicate", () => this.drawing.keys.duplicate(), { title: "Ctrl+D" }), button("Delete", () => this.remove([name]), { title: "Delete" }))];
  }

  /** Fields of numbers that the schema allows. @param {string} section @param {string} name @returns {[string, any][]} */
  fields(section, name) {
    const tables = this.completion()?.tables([section, name]).slice(0, 1) ?? [];
    return tables.flatMap((node) => Object.entries(node.properties)).filter(([key, node]) => !OTHER.includes(key) && (node.type === "integer" || (Array.isArray(node.type) && node.type.includes("number"))));
  }

  /** A number with its unit, and a button that makes it a parameter. @param {Keys} keys @param {unknown} value @param {string} section @param {string} name */
  row(keys, value, section, name) {
    const own = keys.slice(2), label = own.map((key, k) => (typeof key === "number" && own[k - 1] !== "connect" ? "xyz"[key] : String(key))).join(" "), unit = this.unit(section, name, own);
    const input = el("input", { type: "text", value: String(value), "aria-label": label, spellcheck: "false", autocomplete: "off", title: value === "" ? "not stated in the file" : "number, number with a unit, or formula" });
    input.addEventListener("change", () => accept(input, { required: value === "" ? "" : "A number is needed here; the former one is kept" }, value, (typed) => typed !== null && this.write(keys, typed)));
    input.addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        input.value = String(value);
        input.blur();
      }
      if (event.key === "Enter") input.blur();
    });
    const known = typeof value === "number", parameter = button("p", () => this.drawing.actions.change({ label: `parameter of ${name}`, operations: [{ op: "extract", keys }] }), { class: "make", title: "Make this number a parameter with a slider", "aria-label": `make ${label} a parameter`, disabled: !known });
    return el("label", { class: "number" }, el("span", {}, label), input, el("span", { class: "unit" }, unit), parameter);
  }

  /** Unit of a field, from its description in the schema. @param {string} section @param {string} name @param {Keys} keys */
  unit(section, name, keys) {
    if (["points", "connect", "at", "vertices"].includes(String(keys[0]))) return "m";
    const [node] = this.completion()?.tables([section, name]) ?? [], match = /\[([^\]]*)\]/.exec(node?.properties?.[keys[0]]?.description ?? "");
    return match && match[1] !== "1" ? match[1] : "";
  }

  /** @param {Keys} keys @param {string | number} value */
  write(keys, value) {
    this.drawing.actions.change({ label: `set ${keys.slice(1).join(".")}`, operations: [{ op: "set", keys, value, written: true }] });
  }

  /** @param {string} name */
  async rename(name) {
    const reply = await ask(`Rename ${name}`, "References and formulas get the new name.", { rename: "Rename" }, { name: "Name", value: name }), { document } = this.drawing;
    const to = reply?.value.trim() ?? "", change = document && reply && rename(document, name, to);
    if (!change) return;
    this.drawing.actions.change(change);
    this.drawing.select([to]);
  }

  /** @param {string[]} names */
  remove(names) {
    const { document } = this.drawing, change = document && remove(document, names);
    this.drawing.select([]);
    if (change) this.drawing.actions.change(change);
  }
}

/** Numbers and formulas of an entry with their keys. @param {any} value @param {Keys} keys @returns {{ keys: Keys, value: any }[]} */
function numbersOf(value, keys) {
  if (typeof value === "number" || (typeof value === "string" && !OTHER.includes(String(keys[0])) && !["connect", "body", "point", "type"].includes(String(keys.at(typeof keys.at(-1) === "number" ? -2 : -1))))) return [{ keys, value }];
  if (typeof value !== "object" || value === null || keys.length > 4 || (Array.isArray(value) && value.length > 12)) return [];
  return Object.entries(value).flatMap(([key, item]) => numbersOf(item, [...keys, Array.isArray(value) ? Number(key) : key]));
}
