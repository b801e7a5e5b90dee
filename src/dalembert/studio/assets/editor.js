// Text of the model file.

/** @import { Problem } from "./types.d.ts" */

/** Time after the last key until the text is sent [ms]. */
const PAUSE = 120;

const { EditorState, EditorView, HighlightStyle, StreamLanguage, keymap, tags } = CodeMirror;

const COLOURS = HighlightStyle.define([
  { tag: tags.comment, color: "var(--muted)", fontStyle: "italic" },
  { tag: tags.string, color: "var(--good)" },
  { tag: [tags.number, tags.atom, tags.bool], color: "var(--accent)" },
  { tag: tags.propertyName, color: "var(--ink)" },
  { tag: [tags.bracket, tags.punctuation], color: "var(--muted)" },
]);

/** Smallest replacement that turns one text into another. @param {string} before @param {string} after */
export function difference(before, after) {
  const limit = Math.min(before.length, after.length);
  let from = 0, tail = 0;
  while (from < limit && before[from] === after[from]) from++;
  while (tail < limit - from && before[before.length - 1 - tail] === after[after.length - 1 - tail]) tail++;
  return { from, to: before.length - tail, insert: after.slice(from, after.length - tail) };
}

export class Editor {
  /** @param {HTMLElement} parent @param {(text: string) => void} onEdit @param {{ key: string, run: () => boolean }[]} keys @param {(text: string, at: number, explicit: boolean) => unknown} complete */
  constructor(parent, onEdit, keys, complete) {
    this.onEdit = onEdit;
    /** The text of the server is being shown. */
    this.showing = false;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    const extensions = [
      CodeMirror.lineNumbers(), CodeMirror.lintGutter(), CodeMirror.drawSelection(), CodeMirror.highlightActiveLine(), CodeMirror.highlightActiveLineGutter(),
      CodeMirror.bracketMatching(), CodeMirror.closeBrackets(), CodeMirror.indentOnInput(), CodeMirror.highlightSelectionMatches(),
      StreamLanguage.define(CodeMirror.toml), CodeMirror.syntaxHighlighting(COLOURS), EditorView.lineWrapping,
      EditorView.contentAttributes.of({ "aria-label": "Text of the model file" }),
      CodeMirror.autocompletion({ override: [(/** @type {any} */ { state, pos, explicit }) => complete(state.doc.toString(), pos, explicit)] }),
      keymap.of([...keys, ...CodeMirror.completionKeymap, ...CodeMirror.closeBracketsKeymap, ...CodeMirror.defaultKeymap, ...CodeMirror.searchKeymap]),
      EditorView.updateListener.of((/** @type {any} */ update) => {
        if (update.docChanged && !this.showing) this.edited();
      }),
    ];
    this.view = new EditorView({ state: EditorState.create({ extensions }), parent });
  }

  get text() { return /** @type {string} */ (this.view.state.doc.toString()); }

  /** Character at the cursor. @returns {number} */
  get cursor() { return this.view.state.selection.main.head; }

  /** Whether typed characters have not been sent yet. */
  get waits() { return this.timer !== undefined; }

  edited() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.flush(), PAUSE);
  }

  /** Send what was typed. */
  flush() {
    if (this.timer === undefined) return;
    clearTimeout(this.timer);
    this.timer = undefined;
    this.onEdit(this.text);
  }

  /** Show a text; the cursor stays where it is in the text. @param {string} text */
  show(text) {
    clearTimeout(this.timer);
    this.timer = undefined;
    const before = this.text;
    if (text === before) return;
    this.showing = true;
    this.view.dispatch({ changes: difference(before, text) });
    this.showing = false;
  }

  /** Replace a part of the text, as if it were typed. @param {number} from @param {number} to @param {string} insert */
  replace(from, to, insert) {
    this.view.dispatch({ changes: { from, to, insert }, selection: { anchor: from + insert.length } });
    this.flush();
    this.view.focus();
  }

  /** Mark problems at their places. @param {Problem[]} problems */
  mark(problems) {
    const { length } = this.view.state.doc;
    const marks = problems.flatMap(({ start, end, level, message }) =>
      start === null || start > length ? [] : [{ from: start, to: Math.min(end ?? start, length), severity: level === "note" ? "info" : level, message }]);
    this.view.dispatch(CodeMirror.setDiagnostics(this.view.state, marks));
  }

  /** Show an entry of the file. @param {string} section @param {string} name */
  reveal(section, name) {
    const { text } = this, written = name.replace(/[^\w]/g, "\\$&"), header = text.search(new RegExp(`^\\s*\\[${section}\\.${written}\\]`, "m"));
    const at = header >= 0 ? header : text.search(new RegExp(`^\\s*${written}\\s*=`, "m"));
    if (at >= 0) this.view.dispatch({ selection: { anchor: text.indexOf(text.slice(at).trimStart(), at) }, effects: EditorView.scrollIntoView(at, { y: "center" }) });
  }

  /** Select a place. @param {number} start @param {number} end */
  select(start, end) {
    const { length } = this.view.state.doc, at = Math.min(start, length);
    this.view.dispatch({ selection: { anchor: at, head: Math.min(end, length) }, effects: EditorView.scrollIntoView(at, { y: "center" }) });
    this.view.focus();
  }
}
