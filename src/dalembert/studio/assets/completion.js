// Completion of the text: keys and types from the schema of model files, names from the model.

/** @import { Document } from "./types.d.ts" */

/** @typedef {Record<string, any>} Schema */
/** Context of a place in the text: keys of the table there, key of the value there or null in a key, whether in a string.
 * @typedef {{ path: string[], key: string | null, text: boolean, from: number }} Context */

/** Sections of a file whose elements are named in formulas. */
const NAMED = ["parameters", "derived", "inputs", "outputs", "bodies", "joints", "drivers", "forces", "blocks"];

/** Word before a place. @param {string} text @param {number} at */
const wordStart = (text, at) => at - (/[\w.$]*$/.exec(text.slice(Math.max(0, at - 200), at))?.[0].length ?? 0);

/** Keys of a header or a dotted key. @param {string} text */
const keysOf = (text) => [...text.matchAll(/"([^"]*)"|'([^']*)'|([\w-]+)/g)].map((match) => match[1] ?? match[2] ?? match[3]);

/** Context of a place. @param {string} text @param {number} at @returns {Context | null} */
export function contextOf(text, at) {
  const lines = text.slice(0, at).split("\n");
  let first = lines.length - 1;
  while (first > 0 && !/^\s*(?:[\w."'-]+\s*=|\[|$)/.test(lines[first])) first--;  // values of several lines
  if (/^\s*\[\[?[\w.]*$/.test(lines.at(-1) ?? "")) return { path: [], key: null, text: false, from: wordStart(text, at) };
  const header = lines.slice(0, first).findLast((line) => /^\s*\[[^\]]+\]\]?\s*(?:#.*)?$/.test(line)), base = header ? keysOf(header.replace(/#.*/, "")) : [];
  const row = lines.slice(first).join("\n");
  /** Open brackets: their kind, and the key of the value. @type {{ bracket: string, key: string | null }[]} */
  const open = [{ bracket: "", key: null }];
  let word = "", quote = "";
  for (const c of row) {
    const top = /** @type {typeof open[number]} */ (open.at(-1));
    if (quote) {
      if (c === quote) quote = "";
      else word += c;
    } else if (c === '"' || c === "'") [quote, word] = [c, ""];
    else if (c === "#") return null;
    else if (c === "\n" && open.length === 1) [top.key, word] = [null, ""];
    else if (c === "=") [top.key, word] = [word.trim(), ""];
    else if (c === "{" || c === "[") {
      open.push({ bracket: c, key: null });
      word = "";
    } else if (c === "}" || c === "]") {
      open.pop();
      if (!open.length) return null;
    } else if (c === ",") {
      if (top.bracket === "{") top.key = null;
      word = "";
    } else word += c;
  }
  const tables = open.slice(0, -1).flatMap(({ key }) => (key === null ? [] : keysOf(key))), top = /** @type {typeof open[number]} */ (open.at(-1));
  const list = top.bracket === "[", key = list ? keysOf(open.at(-2)?.key ?? "").at(-1) ?? "" : top.key && keysOf(top.key).at(-1);
  const path = [...base, ...(list ? tables.slice(0, -1) : tables)];
  return { path, key: key ?? null, text: quote !== "", from: wordStart(text, at) };
}

export class Completion {
  /** @param {Schema} schema @param {() => Document | null} document @param {() => string[]} points names of the points of the picture */
  constructor(schema, document, points) {
    this.schema = schema;
    this.document = document;
    this.points = points;
  }

  /** Names for references and formulas: parameters, elements, points. */
  names() {
    const document = this.document(), grounded = Object.keys(document?.ground?.points ?? {}).map((name) => `ground.${name}`);
    return [...new Set([...NAMED.flatMap((section) => Object.keys(document?.[section] ?? {})), ...this.points(), ...grounded])];
  }

  /** @param {Schema | undefined} node @returns {Schema} */
  resolved(node) { return node?.$ref ? this.schema.$defs[node.$ref.split("/").at(-1)] : node ?? {}; }

  /** Schema of the whole file. */
  get root() {
    const document = /** @type {any} */ (this.document() ?? {}), { gravity } = document, spatial = document.dimension === 3 || (document.dimension === undefined && gravity?.length === 3 && typeof gravity[0] !== "object");
    return this.schema.$defs[document.kind === "structure" ? "StructureDocument" : spatial ? "SpatialDocument" : "PlanarDocument"];
  }

  /** Alternatives of a table. @param {Schema} node @returns {Schema[]} */
  variants(node) {
    const own = this.resolved(node), list = own.oneOf ?? own.anyOf;
    return list ? list.flatMap((/** @type {Schema} */ item) => this.variants(item)) : [own];
  }

  /** Schemas of the table at a path; those of its type, if it states one. @param {string[]} path @returns {Schema[]} */
  tables(path) {
    let nodes = [this.root], value = /** @type {any} */ (this.document());
    for (const key of path) {
      value = value?.[key];
      nodes = nodes.flatMap((node) => this.variants(node)).flatMap((node) => this.variants(node.properties?.[key] ?? (typeof node.additionalProperties === "object" ? node.additionalProperties : {})));
      nodes = nodes.map((node) => (node.type === "array" ? this.resolved(node.items) : node)).flatMap((node) => this.variants(node));
      const typed = nodes.filter((node) => node.properties?.type?.enum?.includes(value?.type));
      if (typed.length) nodes = typed;
    }
    return nodes.filter((node) => node.properties);
  }

  /** Completions at a place. @param {string} text @param {number} at @param {boolean} explicit */
  options(text, at, explicit) {
    const context = contextOf(text, at);
    if (!context || (!explicit && context.from === at && !context.text)) return null;
    const { path, key, from } = context;
    if (/^\s*\[\[?[\w.]*$/.test(text.slice(text.lastIndexOf("\n", at - 1) + 1, at))) return { from, options: this.keys([this.root], null) };
    if (key === null) return { from, options: this.keys(this.tables(path), this.valueAt(path)) };
    const nodes = this.tables(path).map((node) => this.resolved(node.properties?.[key])), values = nodes.flatMap((node) => this.variants(node)).flatMap((node) => node.enum ?? (node.const === undefined ? node.properties?.type?.enum ?? [] : [node.const]));
    const stated = [...new Set(values)].filter((value) => typeof value === "string" && (path.length < 2 || !value.includes(".")));
    const options = [...stated.map((label) => ({ label: context.text ? label : `"${label}"`, type: "enum" })), ...(context.text && key !== "type" ? this.names().map((label) => ({ label, type: "variable" })) : [])];
    return options.length ? { from, options } : null;
  }

  /** @param {string[]} path */
  valueAt(path) { return path.reduce((value, key) => value?.[key], /** @type {any} */ (this.document())); }

  /** Keys that a table may have and has not. @param {Schema[]} nodes @param {Record<string, unknown> | null | undefined} present */
  keys(nodes, present) {
    const entries = nodes.flatMap((node) => Object.entries(node.properties ?? {})).filter(([key]) => !(present && key in present));
    return [...new Map(entries)].map(([label, node]) => ({ label, type: "property", info: this.resolved(node).description ?? "" }));
  }
}
