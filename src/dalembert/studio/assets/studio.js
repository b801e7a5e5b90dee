// Page of the studio: the drawing beside the text, with undo, saving and problems.

/** @import { Page } from "./pictures.js" */
/** @import { Document, Fix, Message, PictureMessage, Problem, TextMessage } from "./types.d.ts" */

import { ask } from "./ask.js";
import { Completion } from "./completion.js";
import { Crosshair } from "./crosshair.js";
import { Exports, chooseFile } from "./dialogs.js";
import { Drawing } from "./drawing.js";
import { CommandQueue } from "./command_queue.js";
import { addInsight } from "./insight.js";
import { button, byId, el } from "./dom.js";
import { Editor } from "./editor.js";
import { Guide } from "./guide.js";
import { Link } from "./link.js";
import { Palette } from "./palette.js";
import { Photo } from "./photo.js";
import { Pictures } from "./pictures.js";
import { Properties } from "./properties.js";
import { Sheets } from "./sheets.js";
import { showShortcuts } from "./shortcuts.js";
import { Space } from "./space.js";
import { SpaceStructure } from "./space_structure.js";
import { Structure } from "./structure.js";

/** Time for which a notice is shown [ms]. */
const SHOWN = 6000;
/** Time without a change after which values of sliders are written into the text [ms]. */
const REST = 250;
/** Time after which the page says that a picture is being made [ms]. */
const SLOW = 1200;
/** Upper limit of the length of a text, as of the server [characters]. */
const LONGEST = 2_000_000;
const REPLACED = "another page has changed the model; what was typed last is not in it";
const MEANWHILE = "your text, typed without a connection, replaces changes of another page; undo returns them";
const MODIFIER = /Mac|iPhone|iPad/.test(navigator.platform) ? "⌘" : "Ctrl+";

class Studio {
  constructor() {
    /** State of the file. @type {TextMessage} */
    this.file = { kind: "text", revision: -1, text: null, name: "", path: "", changed: false, undo: "", redo: "", document: null };
    /** Revisions sent and not yet confirmed. */
    this.pending = 0;
    /** Revision whose change by the drawing is not yet answered. @type {number | null} */
    this.editing = null;
    /** Commands of the keyboard that read text and picture. */
    this.commands = new CommandQueue((pictured) => this.isAnswered && (!pictured || this.isPictured));
    /** The last message about a still picture. @type {PictureMessage | null} */
    this.described = null;
    /** Text that was typed while there was no connection, and the revision that it changes. @type {{ text: string, revision: number } | null} */
    this.unsent = null;
    this.pictures = new Pictures(byId("canvas"));
    this.pictures.onShow.push((page) => this.follow(page));
    this.photo = new Photo(this.pictures, byId("canvas"), (text, failed) => this.say(text, failed));  // before the drawing, whose clicks it may take
    const keys = [
      { key: "Mod-s", run: () => this.save() }, { key: "Mod-Shift-s", run: () => this.saveAs() },
      { key: "Mod-e", run: () => this.extract() },
      { key: "Mod-z", run: () => this.undo() }, { key: "Mod-y", run: () => this.redo() }, { key: "Mod-Shift-z", run: () => this.redo() },
    ];
    this.editor = new Editor(byId("text"), (text) => this.sendText(text), keys, (text, at, explicit) => this.completion?.options(text, at, explicit) ?? null);
    /** Completion, when its schema has been read, after the first picture. @type {Completion | null} */
    this.completion = null;
    /** Reading of the schema. @type {Promise<void> | null} */
    this.reading = null;
    this.pictures.onShow.push(() => this.readSchema());
    /** Contents of the last valid text. @type {Document | null} */
    this.known = null;
    this.buttons = {
      open: button("Open…", () => this.request("files"), { title: "Open a file, an example or a new model" }),
      save: button("Save", () => this.save(), { id: "save", title: `Save the file (${MODIFIER}S)` }),
      saveAs: button("Save as…", () => this.saveAs()),
      export: button("Export…", () => this.exports.open(), { title: "Page, picture, film, table, script, and files for other programs" }),
      undo: button("Undo", () => this.undo()),
      redo: button("Redo", () => this.redo()),
      photo: button("Photo…", () => this.photo.open(), { title: "Show a photo under the drawing; images can also be dropped on it" }),
      parameter: button("Parameter", () => this.extract(), { id: "make-parameter", title: `Turn the number at the cursor into a parameter with a slider (${MODIFIER}E)` }),
    };
    byId("actions").append(...Object.values(this.buttons));
    this.exports = new Exports((kind, more) => this.request(kind, more), () => this.share);
    byId("more").append(button("Help", () => this.help(), { title: "Keys, and a guided first build (?)" }), button("Theme", () => this.turnTheme(), { id: "theme", title: "Light or dark" }), button("Stop", () => this.stop(), { title: "Stop the program; unsaved changes are kept" }));
    this.setTheme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.slow = undefined;
    this.drawing = new Drawing(this.pictures, {
      change: ({ label, operations }) => {
        this.say("");  // a refusal before it
        void this.edit(label, operations);
      },
      hint: (text) => { byId("hint").textContent = text; },
      select: (section, name) => this.editor.reveal(section, name),
      refuse: (text) => this.say(text, true, true),
      onTool: (name) => {
        this.say("");
        this.palette.show(name);
        this.guide?.check();
      },
      onSelect: () => this.properties.show(),
      rename: (name) => void this.properties.rename(name),
      commands: this.commands,
    });
    this.palette = new Palette(byId("palette"), (name) => this.drawing.choose(name));
    this.properties = new Properties(byId("writing"), this.drawing, () => this.completion);
    /** The guided first build. @type {Guide | undefined} */
    this.guide = new Guide(byId("canvas"), () => ({ ...this.file, document: this.known, tool: this.drawing.tool.name }));
    this.space = new Space(this.pictures, this.drawing.actions, byId("canvas"));
    this.structure = new Structure(this.pictures, this.drawing.actions, byId("canvas"), byId("writing"), () => this.completion);
    this.spaceStructure = new SpaceStructure(this.pictures, this.drawing.actions, byId("canvas"), byId("writing"), () => this.completion);
    this.crosshair = new Crosshair(byId("canvas"), [this.drawing, this.structure]);
    this.sheets = new Sheets(byId("sheets"), byId("writing"), [{ name: "text", title: "Text", node: byId("text") }, { name: "model", title: "Model", node: this.space.tree.node }]);
    /** Requests of other parts by the kind of their answer. @type {Record<string, (message: any) => void>} */
    this.handlers = { export: (message) => this.exports.receive(message) };
    /** Listeners to the contents of the file. @type {((document: Document | null) => void)[]} */
    this.onDocument = [];
    this.insight = addInsight(this);
    this.link = new Link((message) => this.receive(message), (connected) => this.connected(connected));
    this.bind();
  }

  bind() {
    // Overlays come last: their keys are digits, which are typed numbers while one draws.
    for (const listening of [this.space, this.spaceStructure, this.structure, this.drawing, this.insight.overlays]) document.addEventListener("keydown", (event) => listening.key(event));
    document.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("pagehide", () => this.editor.flush());
    document.addEventListener("visibilitychange", () => this.editor.flush());
    this.pictures.onShow.push(() => this.pictures.frame?.contentWindow?.addEventListener("keydown", (event) => this.key(event)));
    this.pictures.onShow.push(() => this.commands.proceed());
    byId("cancel").addEventListener("click", () => this.request("cancel"));
    const divider = byId("divider"), desk = byId("desk");
    const setWidth = (/** @type {number} */ share) => {
      const width = Math.min(75, Math.max(15, share));
      desk.style.setProperty("--text-width", `${width}%`);
      divider.setAttribute("aria-valuenow", String(Math.round(width)));
    };
    divider.addEventListener("pointerdown", (event) => {
      divider.setPointerCapture(event.pointerId);
      desk.classList.add("moving");
    });
    divider.addEventListener("pointermove", (event) => {
      if (divider.hasPointerCapture(event.pointerId)) setWidth((1 - event.clientX / innerWidth) * 100);
    });
    divider.addEventListener("keydown", ({ key }) => {
      const share = (byId("writing").clientWidth / innerWidth) * 100;
      if (key === "ArrowLeft") setWidth(share + 3);
      if (key === "ArrowRight") setWidth(share - 3);
    });
  }

  /** Read the schema of model files for completion, once. */
  readSchema() {
    this.reading ??= fetch("assets/schema.json").then((reply) => reply.json()).then((schema) => { this.completion = new Completion(schema, () => this.known, () => this.names()); });
  }

  /** Keys of the whole page. @param {KeyboardEvent} event */
  key(event) {
    if (event.defaultPrevented || byId("ask").hasAttribute("open")) return;
    const typing = /** @type {HTMLElement} */ (event.target)?.closest?.("input, textarea, .cm-editor");
    if (event.key === "?" && !typing) return this.help();
    if (!(event.ctrlKey || event.metaKey)) return;
    const act = { s: () => (event.shiftKey ? this.saveAs() : this.save()), o: () => this.request("files"), z: () => (event.shiftKey ? this.redo() : this.undo()), y: () => this.redo() }[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** Instant of the picture as a fraction of the motion. */
  get share() {
    const page = this.pictures.page, time = page ? page.player.time - page.motion.start : 0;
    return page && page.motion.end > page.motion.start ? Math.min(1, Math.max(0, time / (page.motion.end - page.motion.start))) : 0;
  }

  help() { showShortcuts(MODIFIER, () => this.guide?.start()); }

  /** @param {Message} message */
  receive(message) {
    switch (message.kind) {
      case "text": return this.showFile(message);
      case "picture":
        if (!message.live) {
          this.described = message;
          this.structure.describe(message.facts?.moving ?? []);
          this.working();
        }
        this.insight.describe(message);
        if (!message.page) this.readSchema();
        if (message.problems) this.showProblems(message.problems);
        if (message.summary !== undefined) this.showSummary(message);
        this.pictures.receive(message);
        return this.commands.proceed();
      case "files": return chooseFile(message, (choice) => this.request("open", choice));
      case "notice": return this.say(message.text);
      case "failure":
        if (message.request === "text") this.pending = Math.max(0, this.pending - 1);  // it was not stored
        this.editing = null;
        this.space.revert();
        this.say(message.text, true);
        return this.commands.proceed();
      case "conflict": return void this.resolve(message.text, message.path);
      default: this.handlers[/** @type {{ kind: string }} */ (message).kind]?.(message);
    }
  }

  /** @param {TextMessage} file */
  showFile(file) {
    const { text, name, changed } = file;
    if (this.editing !== null && (file.revision > this.editing || text !== null)) this.editing = null;
    if (text === null) this.pending--;
    else if (!this.editor.waits || file.revision !== this.file.revision) {
      if (this.editor.waits && text !== this.editor.text) this.say(REPLACED, true);
      this.pending = 0;
      this.editor.show(text);
    }
    this.file = file;
    this.drawing.document = file.document;
    this.space.show(file.document ?? this.known);
    this.structure.show(file.document ?? this.known);
    this.spaceStructure.show(file.document ?? this.known);
    this.properties.show();
    this.known = file.document ?? this.known;
    if (this.unsent !== null) {
      const { text: typed, revision } = this.unsent;
      this.unsent = null;
      if (revision !== file.revision && typed !== text) this.say(MEANWHILE, true);
      this.editor.show(typed);
      this.sendText(typed);
    }
    byId("name").textContent = name;
    void this.photo.show(file.path || name);
    byId("name").title = file.path;
    byId("changed").hidden = !changed;
    document.title = `${changed ? "• " : ""}${name} – studio`;
    const { undo, redo, save } = this.buttons;
    for (const [node, label, key] of /** @type {const} */ ([[undo, file.undo, "Z"], [redo, file.redo, "Y"]])) {
      node.disabled = !label;
      node.title = label ? `${node.textContent} ${label} (${MODIFIER}${key})` : "";
    }
    save.disabled = !changed && Boolean(file.path);
    document.documentElement.dataset.revision = String(file.revision);
    for (const listener of this.onDocument) listener(file.document);
    this.guide?.check();
    this.working();
    this.commands.proceed();
  }

  /** Whether the server has answered all changes of this page. */
  get isAnswered() { return this.editing === null && this.pending === 0 && !this.editor.waits; }

  /** Whether the picture of the text is shown, or there is none. */
  get isPictured() {
    const { described, file, pictures } = this;
    return described !== null && described.revision >= file.revision && (!described.page || pictures.shown >= described.number);
  }

  /** Show that a picture is being made, if it takes a while. */
  working() {
    clearTimeout(this.slow);
    byId("work").hidden = true;
    this.slow = setTimeout(() => { byId("work").hidden = (this.described?.revision ?? -1) >= this.file.revision || !this.link.connected; }, SLOW);
  }

  /** @param {string} text */
  sendText(text) {
    if (text.length > LONGEST) return this.say(`The text has more than ${LONGEST} characters; it was not stored.`, true);
    if (this.link.send({ kind: "text", text, revision: this.file.revision + this.pending })) this.pending++;
    else this.unsent = { text, revision: this.unsent?.revision ?? this.file.revision + this.pending };
  }

  /** @param {string} kind @param {Record<string, unknown>} [more] */
  request(kind, more = {}) {
    this.editor.flush();
    if (kind === "save" && this.editor.text.length > LONGEST) this.sendText(this.editor.text);
    else this.link.send({ kind, ...more });
    return true;
  }

  undo() { return this.request("undo"); }

  redo() { return this.request("redo"); }

  save() { return this.file.path ? this.request("save") : this.saveAs(); }

  saveAs() {
    ask("Save as", "A file name, or a path.", { save: "Save" }, { name: "File", value: this.file.path || this.file.name }).then((reply) => {
      if (reply?.value.trim()) this.request("save", { path: reply.value.trim() });
    });
    return true;
  }

  /** Decide about a file that is not replaced without confirmation. @param {string} text @param {string} path */
  async resolve(text, path) {
    /** @type {Record<string, string>} */
    const answers = path ? { replace: "Replace" } : { replace: "Overwrite it", reload: "Read it again", other: "Save as…" };
    const reply = await ask("The file is not replaced yet", `${text}.`, answers);
    if (reply?.answer === "replace") this.request("save", { path, replace: true });
    if (reply?.answer === "reload") this.request("reload");
    if (reply?.answer === "other") this.saveAs();
  }

  /** Names for references and formulas: parameters, elements, points. */
  names() {
    const { known } = this, sections = ["parameters", "derived", "inputs", "outputs", "bodies", "joints", "drivers", "forces", "blocks"];
    const points = this.pictures.page?.motion.points?.map((/** @type {{ name: string }} */ { name }) => name) ?? [];
    return [...new Set([...sections.flatMap((section) => Object.keys(known?.[section] ?? {})), ...points, ...Object.keys(known?.ground?.points ?? {}).map((name) => `ground.${name}`)])];
  }

  /** Turn the number at the cursor into a parameter. */
  extract() {
    this.editor.flush();
    return this.edit("add parameter", [{ op: "extract", at: this.editor.cursor }]);
  }

  /** @param {string} label @param {Record<string, unknown>[]} operations */
  edit(label, operations) {
    this.editor.flush();
    const revision = this.file.revision + this.pending;
    this.editing = this.link.connected ? revision : null;
    return this.request("edit", { label, operations, revision });
  }

  /** Write the values of the sliders of a live picture into the text. @param {Page} page */
  follow({ design }) {
    if (!design) return;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let waiting;
    let written = [...design.values];
    design.onChange.on((/** @type {string} */ origin) => {
      clearTimeout(waiting);
      if (origin === "drawing") return;  // written when it is released
      waiting = setTimeout(() => {
        if (this.pictures.page?.design !== design) return;
        const operations = design.parameters.flatMap((/** @type {{ name: string, drawn?: unknown }} */ { name, drawn }, /** @type {number} */ k) => (drawn || design.values[k] === written[k] ? [] : [{ op: "parameter", name, value: design.values[k] }]));
        written = [...design.values];
        if (!operations.length) return;
        this.pictures.own = this.file.revision + this.pending + 1;
        this.edit(`set ${operations.map((/** @type {{ name: string }} */ { name }) => name).slice(0, 3).join(", ")}`, operations);
      }, REST);
    });
  }

  stop() {
    this.link.stopped = true;
    this.request("stop");
    this.say("The program is stopped. Unsaved changes are kept for the next time; this tab can be closed.");
  }

  /** @param {boolean} connected */
  connected(connected) {
    const link = byId("link");
    link.textContent = connected ? "" : this.link?.stopped ? "stopped" : "not connected: is the program running? Changes are sent when it answers";
    link.classList.toggle("error", !connected);
    if (!connected && this.pending) this.unsent ??= { text: this.editor.text, revision: this.file.revision };  // it may not have arrived
    this.pending = 0;
    this.editing = null;
    this.commands.clear();
  }

  /** @param {Problem[]} problems */
  showProblems(problems) {
    this.editor.mark(problems);
    byId("problems").replaceChildren(...problems.map(({ level, message, start, end, line, fixes }) =>
      el("li", { class: level }, el("button", { type: "button", onclick: () => start !== null && this.editor.select(start, end ?? start) },
        el("span", { class: "level" }), el("span", { class: "place" }, line ? `line ${line}` : ""), el("span", {}, message)),
      ...(fixes ?? []).map((fix) => button(fix.title, () => this.fix(fix), { class: "button small fix" })))));
  }

  /** Carry out the remedy of a problem. @param {Fix} fix */
  fix({ start, end, insert }) {
    if (this.described?.revision !== this.file.revision || this.editor.waits || this.pending) return this.say("The text has changed meanwhile; wait for its problems.", true);
    this.editor.replace(start, end, insert);
  }

  /** @param {PictureMessage} message */
  showSummary({ summary = "", facts = {} }) {
    byId("summary").textContent = summary;
    const redundant = facts.redundant ? `${facts.redundant} redundant constraint${facts.redundant > 1 ? "s" : ""} (${(facts.redundancies ?? []).join("; ")})` : "";
    byId("freedom").textContent = redundant;
    this.drawing.status = [summary, redundant].filter(Boolean).join("; ");
    this.drawing.refresh();
  }

  /** @param {string} text @param {boolean} [failed] @param {boolean} [passes] whether it disappears after a while */
  say(text, failed = false, passes = !failed) {
    const notice = byId("notice");
    notice.textContent = text;
    notice.classList.toggle("error", failed);
    clearTimeout(this.timer);
    if (passes) this.timer = setTimeout(() => { notice.textContent = ""; }, SHOWN);
  }

  /** @param {string} name */
  setTheme(name) {
    document.documentElement.dataset.theme = name;
    localStorage.setItem("theme", name);
    this.pictures.setTheme(name);
  }

  turnTheme() { this.setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"); }
}

/** @typedef {Studio} StudioPage */

Object.assign(window, { studio: new Studio() });
