// Texts and files of the design of a live page: lines of a model file, Python, the page itself.

/** @import { LiveParameter } from "./types.d.ts" */
/** @import { Design } from "./live_design.js" */

import { download, el, fileName, icon, menu } from "./dom.js";
import { isNum } from "./numbers.js";
import { payload } from "./payload.js";

/** The page as it was loaded. */
const SOURCE = `<!DOCTYPE html>\n${document.documentElement.outerHTML}\n`;

/** A number in the unit of its parameter, without round-off of the conversion. @param {number} value @param {number} factor */
const inUnit = (value, factor) => (factor === 1 ? String(value) : String(Number((value / factor).toPrecision(15))));

/** @param {LiveParameter} parameter @param {number} value */
function tomlLine({ name, unit, factor, lower, upper, description }, value) {
  const bounds = [lower, upper].map((bound, end) => (isNum(bound) ? inUnit(bound, factor) : end ? "inf" : "-inf")), fields = [`value = ${inUnit(value, factor)}`];
  if (unit && unit !== "1") fields.push(`unit = ${JSON.stringify(unit)}`);
  if (isNum(lower) || isNum(upper)) fields.push(`bounds = [${bounds.join(", ")}]`);
  if (description) fields.push(`description = ${JSON.stringify(description)}`);
  return `${/^[\w-]+$/.test(name) ? name : JSON.stringify(name)} = { ${fields.join(", ")} }`;
}

/** Lines of a model file. @param {Design} design */
export const tomlText = ({ parameters, values }) => `[parameters]\n${parameters.flatMap((parameter, k) => (parameter.drawn ? [] : tomlLine(parameter, values[k]))).join("\n")}\n`;

/** Argument of an analysis, in SI units. @param {Design} design */
export const pythonText = ({ parameters, values }) => `parameters={${parameters.flatMap(({ name, drawn }, k) => (drawn ? [] : `${JSON.stringify(name)}: ${values[k]}`)).join(", ")}}`;

/** The page with the present design as its first view. @param {Design} design */
export const pageText = (design) => SOURCE.replace(/^(<!DOCTYPE html>\n<html\b[^>]*?)(?: data-design="[^"]*")?>/, (_, head) => `${head} data-design="${design.hash}">`);

/** Copy a text, also where pages have no clipboard. @param {string} text */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = el("textarea", { "aria-label": "Text to copy" });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

/** @param {Design} design @param {(text: string) => void} say */
export function designMenu(design, say) {
  const item = (/** @type {string} */ text, /** @type {string} */ id, /** @type {() => void} */ onclick) => el("button", { type: "button", class: "menu-item", id, onclick }, text);
  const copies = (/** @type {(design: Design) => string} */ textOf, /** @type {string} */ what) => async () => { await copy(textOf(design)); say(`${what} copied`); };
  return menu([icon("save"), "Share"], [
    item("Copy as TOML", "copy-toml", copies(tomlText, "Lines of a model file")),
    item("Copy as Python", "copy-python", copies(pythonText, "Argument in Python")),
    item("Copy the address", "copy-address", copies(() => location.href.replace(/#.*/, "") + design.hash, "Address")),
    item("Save this page as shown", "save-page", () => download(`${fileName(String(payload.title || "report"))}.html`, pageText(design), "text/html"))],
  { class: "button", id: "use-design", "aria-label": "Copy or save this design", title: "Copy or save this design" });
}
