// Bar of the file: its name and state, and the buttons of the page.

/** @import { TextMessage } from "./types.d.ts" */

import { button, byId } from "./dom.js";

/** @typedef {Record<"open" | "save" | "saveAs" | "export" | "undo" | "redo" | "parameter" | "help" | "theme" | "stop", () => unknown>} BarActions */

export class FileBar {
  /** @param {string} modifier name of the key Ctrl @param {BarActions} act @param {HTMLElement} photo button of the photo */
  constructor(modifier, act, photo) {
    this.modifier = modifier;
    this.undo = button("Undo", act.undo);
    this.redo = button("Redo", act.redo);
    this.save = button("Save", act.save, { id: "save", title: `Save the file (${modifier}S)` });
    byId("actions").append(
      button("Open…", act.open, { title: "Open a file, an example or a new model" }), this.save, button("Save as…", act.saveAs),
      button("Export…", act.export, { title: "Page, picture, film, table, script, and files for other programs" }), this.undo, this.redo,
      photo,
      button("Parameter", act.parameter, { id: "make-parameter", class: "button drawn", title: `Turn the number at the cursor into a parameter with a slider (${modifier}E)` }),
    );
    byId("more").append(
      button("Help", act.help, { title: "Keys, and a guided first build (?)" }), button("Theme", act.theme, { id: "theme", title: "Light or dark" }),
      button("Stop", act.stop, { title: "Stop the program; unsaved changes are kept" }),
    );
  }

  /** @param {TextMessage} file */
  show({ name, path, changed, undo, redo }) {
    byId("name").textContent = name;
    byId("name").title = path;
    byId("changed").hidden = !changed;
    document.title = `${changed ? "• " : ""}${name} – studio`;
    for (const [node, label, key] of /** @type {const} */ ([[this.undo, undo, "Z"], [this.redo, redo, "Y"]])) {
      node.disabled = !label;
      node.title = label ? `${node.textContent} ${label} (${this.modifier}${key})` : "";
    }
    this.save.disabled = !changed && Boolean(path);
  }
}
