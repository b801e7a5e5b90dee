// Dialogs of the page: files and examples to open, exports, shortcuts.

/** @import { ExportMessage, FilesMessage } from "./types.d.ts" */

import { button, byId, el } from "./dom.js";

/** Show content in the dialog; the result closes it. @param {string} title @param {Node[]} content @param {() => void} [onClose] */
export function showSheet(title, content, onClose = () => {}) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("sheet"));
  const heading = el("h2", { id: "sheet-title" }, title), close = button("Close", () => dialog.close(), { class: "button", autofocus: true });
  dialog.replaceChildren(el("div", { class: "sheet-frame" }, el("div", { class: "sheet-head" }, heading, close), ...content));
  dialog.onclose = onClose;
  if (!dialog.open) dialog.showModal();
  return dialog;
}

const base = (/** @type {string} */ path) => path.split(/[\\/]/).at(-1) ?? path;

/** Entries of the dialog Open that contain the typed word. */
const FITS = "[data-words]:not([hidden])";

/** Choose a file, an example or a new model. @param {FilesMessage} listed @param {(choice: Record<string, unknown>) => void} open */
export function chooseFile({ folder, files, recent, examples }, open) {
  const act = (/** @type {Record<string, unknown>} */ choice) => () => {
    dialog.close();
    open(choice);
  };
  const input = el("input", { type: "text", "aria-label": "File", placeholder: "Path of a model file, or a word to search for", spellcheck: "false", autocomplete: "off" });
  const entry = (/** @type {string} */ path, /** @type {string} */ note) => el("li", { "data-words": path.toLowerCase() }, el("button", { type: "button", class: "row", title: path, onclick: act({ path }) }, el("b", {}, base(path)), el("span", {}, note)));
  const list = (/** @type {string} */ title, /** @type {Node[]} */ rows) => rows.length > 0 && el("section", {}, el("h3", {}, title), el("ul", { class: "rows" }, rows));
  const cards = examples.map(({ example, name, description }) => el("li", { "data-words": `${example} ${name} ${description}`.toLowerCase() },
    el("button", { type: "button", class: "example", onclick: act({ example }) }, el("img", { src: `examples/${example}`, alt: "", loading: "lazy" }), el("b", {}, name || example), el("span", {}, description))));
  const sections = [
    list("Recent", (recent ?? []).map((path) => entry(path, path.slice(0, -base(path).length - 1)))),
    list(`In ${folder}`, files.map((path) => entry(path, ""))),
    el("section", {}, el("h3", {}, "Examples"), el("ul", { class: "examples" }, cards)),
  ].filter((section) => section !== false);
  const form = el("form", { class: "open-path" }, input, el("button", { type: "submit", class: "button primary" }, "Open"));
  const fresh = el("div", { class: "chips", role: "group", "aria-label": "New files" }, button("New model", act({})), button("New spatial model", act({ dimension: 3 })), button("New structure", act({ structure: true })), button("New spatial structure", act({ structure: true, dimension: 3 })));
  const dialog = showSheet("Open", [form, fresh, el("div", { class: "sheet-body" }, sections)]);
  input.addEventListener("input", () => {
    const word = input.value.trim().toLowerCase();
    for (const item of /** @type {NodeListOf<HTMLElement>} */ (dialog.querySelectorAll("[data-words]"))) item.hidden = Boolean(word) && !item.dataset.words?.includes(word);
    for (const section of /** @type {NodeListOf<HTMLElement>} */ (dialog.querySelectorAll("section"))) section.hidden = !section.querySelector(FITS);
  });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const value = input.value.trim(), example = examples.find((item) => item.example === value.replace(/^example: /, ""))?.example;
    const near = files.find((path) => base(path) === value), fitting = /** @type {NodeListOf<HTMLElement>} */ (dialog.querySelectorAll(`${FITS} button`));
    if (value && !example && !near && fitting.length && !/[\\/~]|\.\w+$/.test(value)) fitting.length > 1 ? fitting[0].focus() : fitting[0].click();  // a word
    else if (value) act(example ? { example } : { path: near ?? (/[\\/~]/.test(value) ? value : `${folder}/${value}`) })();
  });
  input.focus();
}

/** @typedef {{ to: string, title: string, group: string, suffix: string }} Choice */

/** Choose a kind of file, follow its export, and download it. */
export class Exports {
  /** @param {(kind: string, more?: Record<string, unknown>) => void} request @param {() => number} share instant of the picture as a fraction of the motion */
  constructor(request, share) {
    this.request = request;
    this.share = share;
    /** Number of the export that is followed. */
    this.number = 0;
    this.state = el("div", { class: "export-state", role: "status", "aria-live": "polite" });
  }

  async open() {
    /** @type {Choice[] | null} */
    const choices = await fetch("assets/exports.json").then((reply) => reply.json()).catch(() => null);
    if (!choices) return void this.request("stop export");  // which says that there is no connection
    const groups = [...new Set(choices.map(({ group }) => group))].map((group) => el("section", {}, el("h3", {}, group), el("div", { class: "chips" },
      choices.filter((choice) => choice.group === group).map(({ to, title, suffix }) => button(title, () => this.start(to), { title: suffix, "data-to": to })))));
    this.state.replaceChildren(el("p", {}, "The file is made of the present text, saved or not, and downloaded by the browser when it is complete."));
    showSheet("Export", [el("div", { class: "sheet-body" }, groups), this.state], () => this.number && this.request("stop export"));
  }

  /** @param {string} to */
  start(to) {
    this.number = -1;
    this.request("export", { to, share: this.share() });
    this.say("exporting…", 0);
  }

  /** @param {string} text @param {number | null} share of the work that is done; null at its end @param {boolean} [failed] */
  say(text, share, failed = false) {
    const progress = /** @type {HTMLProgressElement | null} */ (this.state.querySelector("progress"));
    if (share && progress) return void (progress.value = share);  // the button stays, so that a press of it is not lost
    const running = share === null ? [] : [el("progress", { max: "1", value: share || null, "aria-label": "Progress" }), button("Stop", () => this.request("stop export"))];
    this.state.replaceChildren(el("p", { class: failed ? "error" : null }, text), ...running);
  }

  /** @param {ExportMessage} message */
  receive(message) {
    this.number = message.number;
    if (message.state === "progress") return this.say("exporting…", message.share ?? 0);
    this.number = 0;
    if (message.state === "failed") return this.say(message.text ?? "", null, true);
    if (message.state === "stopped") return this.say("The export was stopped; nothing was written.", null);
    const link = el("a", { href: message.address, download: message.name }, message.name), left = message.omissions ?? [];
    const list = el("details", { hidden: !left.length }, el("summary", {}, `${left.length} part${left.length > 1 ? "s" : ""} not contained`), el("ul", {}, left.map((text) => el("li", {}, text))));
    this.state.replaceChildren(el("p", {}, "Downloaded: ", link), list);
    link.click();
  }
}
