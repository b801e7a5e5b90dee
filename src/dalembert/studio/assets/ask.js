// Questions in a dialog.

import { button, byId, el } from "./dom.js";

/** Ask for a text or a decision; the result is the chosen answer, null if cancelled.
 * @param {string} title @param {string} text @param {Record<string, string>} answers value → label, the first is the default
 * @param {{ name: string, value: string, choices?: { text: string, value: string }[] } | null} [field] @returns {Promise<{ answer: string, value: string } | null>} */
export function ask(title, text, answers, field = null) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("ask"));
  return new Promise((resolve) => {
    const input = field && el("input", { type: "text", value: field.value, "aria-label": field.name, spellcheck: "false", autocomplete: "off", list: field.choices ? "ask-choices" : null });
    const choices = field?.choices && el("datalist", { id: "ask-choices" }, field.choices.map(({ text, value }) => el("option", { value }, text)));
    const close = (/** @type {string | null} */ answer) => {
      dialog.close();
      resolve(answer === null ? null : { answer, value: input ? input.value : "" });
    };
    const buttons = Object.entries(answers).map(([answer, label], k) => el("button", { type: k ? "button" : "submit", class: k ? "button" : "button primary", onclick: k ? () => close(answer) : null }, label));
    const form = el("form", {}, el("h2", { id: "ask-title" }, title), text && el("p", {}, text), input, choices, el("div", { class: "chips" }, button("Cancel", () => close(null)), buttons.reverse()));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      close(Object.keys(answers)[0]);
    });
    dialog.oncancel = () => resolve(null);
    dialog.replaceChildren(form);
    dialog.showModal();
    input?.select();
  });
}
