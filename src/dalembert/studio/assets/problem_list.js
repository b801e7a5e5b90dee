// List of the problems of the text, with remedies as buttons.

/** @import { Editor } from "./editor.js" */
/** @import { Fix, Problem } from "./types.d.ts" */

import { button, byId, el } from "./dom.js";

export class ProblemList {
  /** @param {Editor} editor @param {() => boolean} isCurrent whether the problems are those of the present text @param {(text: string) => void} refuse */
  constructor(editor, isCurrent, refuse) {
    this.editor = editor;
    this.isCurrent = isCurrent;
    this.refuse = refuse;
  }

  /** @param {Problem[]} problems */
  show(problems) {
    this.editor.mark(problems);
    byId("problems").replaceChildren(...problems.map(({ level, message, start, end, line, fixes }) =>
      el("li", { class: level }, el("button", { type: "button", onclick: () => start !== null && this.editor.select(start, end ?? start) },
        el("span", { class: "level" }), el("span", { class: "place" }, line ? `line ${line}` : ""), el("span", {}, message)),
      ...(fixes ?? []).map((fix) => button(fix.title, () => this.fix(fix), { class: "button small fix" })))));
  }

  /** Carry out the remedy of a problem. @param {Fix} fix */
  fix({ start, end, insert }) {
    if (this.isCurrent()) this.editor.replace(start, end, insert);
    else this.refuse("The text has changed meanwhile; wait for its problems.");
  }
}
