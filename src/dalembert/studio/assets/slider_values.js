// Values of the sliders of a live picture, which are written into the text when they rest.

/** @import { Operation } from "./operations.js" */
/** @import { Page } from "./pictures.js" */

/** Time without a change after which values of sliders are written into the text [ms]. */
const REST = 250;

/** Write the values of the sliders of a live page. @param {Page} page @param {(label: string, operations: Operation[]) => void} write @param {(act: () => void) => void} later carries out after the changes before, if the page is still shown */
export function writeSliders({ design }, write, later) {
  if (!design) return;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;
  let written = [...design.values];
  design.onChange.on((/** @type {string} */ origin) => {
    clearTimeout(waiting);
    if (origin === "drawing") return;  // written when it is released
    waiting = setTimeout(() => later(() => {
      const changed = design.parameters.flatMap((/** @type {{ name: string, drawn?: unknown }} */ { name, drawn }, /** @type {number} */ k) => (drawn || design.values[k] === written[k] ? [] : [{ op: "parameter", name, value: design.values[k] }]));
      written = [...design.values];
      if (changed.length) write(`set ${changed.map((/** @type {{ name: string }} */ { name }) => name).slice(0, 3).join(", ")}`, changed);
    }), REST);
  });
}
