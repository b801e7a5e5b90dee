// Events of the pointer and the keyboard that a drawing takes before the picture does.

/** @import { Page } from "./pictures.js" */

/** @typedef {(event: PointerEvent, at: [number, number]) => boolean} Act what a drawing does at a pixel; whether the picture does not get the event */

/** Let a drawing take events of the pointer over a picture.
 * @param {Page} page @param {Window} view of the picture @param {() => boolean} isActive whether the picture can be drawn on @param {() => boolean} holds whether something is dragged, also beyond the drawing @param {Record<string, Act>} acts by the type of the event */
export function takePointer({ scene: { canvas } }, view, isActive, holds, acts) {
  for (const [type, act] of Object.entries(acts)) view.addEventListener(type, (event) => {
    if ((event.target !== canvas && !holds()) || !isActive()) return;
    const { clientX, clientY } = /** @type {PointerEvent} */ (event), { left, top } = canvas.getBoundingClientRect();
    if (act(/** @type {PointerEvent} */ (event), [clientX - left, clientY - top])) event.stopImmediatePropagation();
  }, true);
}

/** Whether a key is typed into a field. @param {KeyboardEvent} event */
export const isTyped = ({ target }) => Boolean(/** @type {HTMLElement | null} */ (target)?.closest?.("input, select, textarea, .cm-editor, dialog"));
