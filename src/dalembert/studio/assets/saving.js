// Saving of the file: under its name, under another one, and the decision about a file that is there.

import { ask } from "./ask.js";

export class Saving {
  /** @param {(kind: string, more?: Record<string, unknown>) => boolean} request @param {() => { path: string, name: string }} file */
  constructor(request, file) {
    this.request = request;
    this.file = file;
  }

  save() { return this.file().path ? this.request("save") : this.saveAs(); }

  saveAs() {
    const { path, name } = this.file();
    ask("Save as", "A file name, or a path.", { save: "Save" }, { name: "File", value: path || name }).then((reply) => {
      const typed = reply?.value.trim();
      if (typed) this.request("save", { path: /[^/\\]\.[^/\\.]*$|[/\\]$/.test(typed) ? typed : `${typed}.toml` });
    });
    return true;
  }

  /** Decide about a file that is not replaced, or written again, without confirmation. @param {import("./types.d.ts").ConflictMessage} conflict */
  async resolve({ text, path, missing }) {
    /** @type {Record<string, string>} */
    const there = path ? { replace: "Replace" } : { replace: "Overwrite it", reload: "Read it again", other: "Save as…" };
    const reply = missing ? await ask("The file is not saved yet", `${text}.`, { other: "Save as…", replace: "Write it under its former name" }) : await ask("The file is not replaced yet", `${text}.`, there);
    if (reply?.answer === "replace") this.request("save", { path, replace: true });
    if (reply?.answer === "reload") this.request("reload");
    if (reply?.answer === "other") this.saveAs();
  }
}
