// Page of the studio: the drawing beside the text, with undo, saving and problems.

/** @import { Change } from "./operations.js" */
/** @import { Document, Message, PictureMessage, TextMessage } from "./types.d.ts" */

import { CommandQueue } from "./command_queue.js";
import { Completion } from "./completion.js";
import { Crosshair } from "./crosshair.js";
import { Exports, chooseFile } from "./dialogs.js";
import { bindDivider } from "./divider.js";
import { byId } from "./dom.js";
import { Drawing } from "./drawing.js";
import { Editor } from "./editor.js";
import { REFUSAL } from "./field_values.js";
import { FileBar } from "./file_bar.js";
import { Guide } from "./guide.js";
import { addInsight } from "./insight.js";
import { Link } from "./link.js";
import { bindKeys } from "./page_keys.js";
import { Palette } from "./palette.js";
import { Photo } from "./photo.js";
import { Pictures } from "./pictures.js";
import { ProblemList } from "./problem_list.js";
import { Properties } from "./properties.js";
import { lastChange } from "./rejoining.js";
import { Saving } from "./saving.js";
import { Sheets } from "./sheets.js";
import { showShortcuts } from "./shortcuts.js";
import { writeSliders } from "./slider_values.js";
import { Space } from "./space.js";
import { SpaceStructure } from "./space_structure.js";
import { StatusLine } from "./status_line.js";
import { Structure } from "./structure.js";
import { Theme } from "./theme.js";

/** Upper limit of the length of a text, as of the server [characters]. */
const LONGEST = 2_000_000;
const REPLACED = "another page has changed the model; what was typed last is not in it";
const MEANWHILE = "your text, typed without a connection, replaces changes of another page; undo returns them";
const DRAWN = "another page has changed the model; what was drawn without a connection is not in it";
const WAITING = "not connected; this is carried out when the program answers";
const REFUSED = "not connected; repeat this when the program answers";
const MODIFIER = /Mac|iPhone|iPad/.test(navigator.platform) ? "⌘" : "Ctrl+";

class Studio {
  constructor() {
    this.status = new StatusLine();
    /** State of the file. @type {TextMessage} */
    this.file = { kind: "text", revision: -1, opened: 0, text: null, digest: "", name: "", path: "", changed: false, undo: "", redo: "", document: null };
    /** Revisions sent and not yet confirmed. */
    this.pending = 0;
    /** Revision whose change by the drawing is not yet answered. @type {number | null} */
    this.editing = null;
    /** That change. @type {import("./rejoining.js").Sent | null} */
    this.sent = null;
    /** Whether the text of the server is known: a connection has been made, and its first message has come. */
    this.joined = false;
    /** Commands of the keyboard that read text and picture. */
    this.commands = new CommandQueue((pictured) => this.isAnswered && (!pictured || this.isPictured));
    /** The last message about a still picture. @type {PictureMessage | null} */
    this.described = null;
    /** Text that was typed while there was no connection, and the revision that it changes. @type {{ text: string, revision: number } | null} */
    this.unsent = null;
    this.pictures = new Pictures(byId("canvas"));
    this.pictures.onShow.push((page) => writeSliders(page, (label, operations) => this.writeOwn(label, operations), (act) => this.commands.do(() => { if (this.pictures.page?.design === page.design) act(); }, false)));
    this.photo = new Photo(this.pictures, byId("canvas"), (text, failed) => this.say(text, failed));  // before the drawing, whose clicks it may take
    const keys = [
      { key: "Mod-s", run: () => this.saving.save() }, { key: "Mod-Shift-s", run: () => this.saving.saveAs() },
      { key: "Mod-e", run: () => this.extract() },
      { key: "Mod-z", run: () => this.undo() }, { key: "Mod-y", run: () => this.redo() }, { key: "Mod-Shift-z", run: () => this.redo() },
    ];
    this.editor = new Editor(byId("text"), (text) => this.sendText(text), keys, (text, at, explicit) => this.completion?.options(text, at, explicit) ?? null);
    this.problems = new ProblemList(this.editor, () => this.described?.revision === this.file.revision && !this.editor.waits && !this.pending, (text) => this.say(text, true));
    /** Completion, when its schema has been read, after the first picture. @type {Completion | null} */
    this.completion = null;
    /** Reading of the schema. @type {Promise<void> | null} */
    this.reading = null;
    this.pictures.onShow.push(() => this.readSchema());
    /** Contents of the last valid text. @type {Document | null} */
    this.known = null;
    this.saving = new Saving((kind, more) => this.request(kind, more), () => this.file);
    this.bar = new FileBar(MODIFIER, {
      open: () => this.request("files"), save: () => this.saving.save(), saveAs: () => this.saving.saveAs(), export: () => this.exports.open(),
      undo: () => this.undo(), redo: () => this.redo(), parameter: () => this.extract(),
      help: () => this.help(), theme: () => this.theme.turn(), stop: () => this.stop(),
    }, this.photo.opener);
    this.exports = new Exports((kind, more) => this.request(kind, more), () => this.share);
    this.theme = new Theme((name) => this.pictures.setTheme(name));
    this.drawing = new Drawing(this.pictures, {
      change: (change) => this.change(change),
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
    this.guide = new Guide(byId("writing"), () => ({ ...this.file, document: this.known, tool: this.drawing.tool.name }));
    this.space = new Space(this.pictures, this.drawing.actions, byId("canvas"));
    this.structure = new Structure(this.pictures, this.drawing.actions, byId("canvas"), byId("writing"), () => this.completion);
    this.spaceStructure = new SpaceStructure(this.pictures, this.drawing.actions, byId("canvas"), byId("writing"), () => this.completion);
    this.crosshair = new Crosshair(byId("canvas"), [this.drawing, this.structure]);
    this.sheets = new Sheets(byId("sheets"), byId("writing"), [{ name: "text", title: "Text", node: byId("text") }, { name: "model", title: "Model", node: this.space.tree.node, mechanism: true }]);
    /** Requests of other parts by the kind of their answer. @type {Record<string, (message: any) => void>} */
    this.handlers = { export: (message) => this.exports.receive(message) };
    /** Listeners to the contents of the file. @type {((document: Document | null) => void)[]} */
    this.onDocument = [];
    this.insight = addInsight(this);
    this.link = new Link((message) => this.receive(message), (connected) => this.connected(connected));
    this.bind();
  }

  bind() {
    bindKeys(this);
    document.addEventListener(REFUSAL, (event) => this.say(/** @type {CustomEvent<string>} */ (event).detail, true, true));
    window.addEventListener("pagehide", () => this.editor.flush());
    window.addEventListener("beforeunload", (event) => { if (!this.joined && (this.unsent || this.editing !== null || this.commands.waiting.length)) event.preventDefault(); });
    document.addEventListener("visibilitychange", () => this.editor.flush());
    this.pictures.onShow.push(() => this.commands.proceed());
    byId("cancel").addEventListener("click", () => this.request("cancel"));
    bindDivider(byId("divider"), byId("desk"), byId("writing"));
  }

  /** Read the schema of model files for completion, once. */
  readSchema() {
    this.reading ??= fetch("assets/schema.json").then((reply) => reply.json()).then((schema) => { this.completion = new Completion(schema, () => this.known, () => this.points); }).catch(() => { this.reading = null; });
  }

  /** Instant of the picture as a fraction of the motion. */
  get share() {
    const page = this.pictures.page, time = page ? page.player.time - page.motion.start : 0;
    return page && page.motion.end > page.motion.start ? Math.min(1, Math.max(0, time / (page.motion.end - page.motion.start))) : 0;
  }

  /** Names of the points of the picture. @returns {string[]} */
  get points() { return this.pictures.page?.motion.points?.map((/** @type {{ name: string }} */ { name }) => name) ?? []; }

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
        if (message.problems) this.problems.show(message.problems);
        if (message.summary !== undefined) {
          this.drawing.status = this.status.summarise(message);
          this.drawing.refresh();
        }
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
      case "conflict": return void this.saving.resolve(message);
      default: this.handlers[/** @type {{ kind: string }} */ (message).kind]?.(message);
    }
  }

  /** @param {TextMessage} file */
  showFile(file) {
    const { text, name } = file, last = this.joined || this.file.revision < 0 ? null : lastChange(file, this.file.revision, this.editing, this.sent);
    this.joined = true;
    if (last === "replaced" && this.commands.clear()) this.say(DRAWN, true);
    if (this.editing !== null && (file.revision > this.editing || text !== null)) this.editing = null;
    if (text === null) this.pending--;
    else if (!this.editor.waits || file.revision !== this.file.revision) {
      if (this.editor.waits && text !== this.editor.text) this.say(REPLACED, true);
      this.pending = 0;
      this.editor.show(text);
    }
    if (file.opened !== this.file.opened) this.pictures.forget();
    this.file = file;
    this.drawing.show(file.document);
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
    if (last === "lost" && this.sent) this.make(this.sent);
    void this.photo.show(file.path || name);
    this.bar.show(file);
    document.documentElement.dataset.revision = String(file.revision);
    for (const listener of this.onDocument) listener(file.document);
    this.guide?.check();
    this.working();
    this.commands.proceed();
  }

  /** Whether the server has answered all changes of this page. */
  get isAnswered() { return this.joined && this.editing === null && this.pending === 0 && !this.editor.waits; }

  /** Whether the picture of the text is shown, or there is none. */
  get isPictured() {
    const { described, file, pictures } = this;
    return described !== null && described.revision >= file.revision && (!described.page || pictures.shown >= described.number);
  }

  /** Show that a picture is being made, if it takes a while. */
  working() { this.status.watch(() => (this.described?.revision ?? -1) < this.file.revision && this.link.connected); }

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
    else if (!this.joined && kind === "save") this.later(() => this.request(kind, more));
    else if (!this.link.send({ kind, ...more })) this.say(REFUSED, true);
    return true;
  }

  undo() { return this.turnBack("undo"); }

  redo() { return this.turnBack("redo"); }

  /** Undo or redo, after the changes before are answered. @param {"undo" | "redo"} kind */
  turnBack(kind) {
    this.editor.flush();
    this.later(() => this.make({ kind }));
    return true;
  }

  /** Turn the number at the cursor into a parameter. */
  extract() {
    this.editor.flush();
    return this.edit("add parameter", [{ op: "extract", at: this.editor.cursor }]);
  }

  /** Change of the drawing, after those before are answered. @param {Change} change */
  change({ label, operations }) {
    this.say("");  // a refusal before it
    this.editor.flush();
    if (this.isAnswered) this.edit(label, operations);
    else this.later(() => this.edit(label, operations));
  }

  /** Carry out after the changes before are answered. @param {() => void} act */
  later(act) {
    if (!this.joined) this.say(WAITING);
    this.commands.do(act, false);
  }

  /** @param {string} label @param {Record<string, unknown>[]} operations */
  edit(label, operations) {
    this.editor.flush();
    if (this.joined) this.make({ kind: "edit", label, operations });
    else this.later(() => this.edit(label, operations));
    return true;
  }

  /** Send a change, which is sent again if the connection ends before it arrives. @param {import("./rejoining.js").Sent} change */
  make(change) {
    const revision = this.file.revision + this.pending;
    [this.editing, this.sent] = [revision, change];
    this.link.send({ ...change, revision });
  }

  /** Change of the text that the shown page has made itself. @param {string} label @param {Record<string, unknown>[]} operations */
  writeOwn(label, operations) {
    this.pictures.own = this.file.revision + this.pending + 1;
    this.edit(label, operations);
  }

  stop() {
    this.link.stopped = true;
    this.request("stop");
    this.say("The program is stopped. Unsaved changes are kept for the next time; this tab can be closed.");
  }

  /** @param {boolean} connected */
  connected(connected) {
    this.status.connected(connected, this.link);
    if (!connected && this.pending) this.unsent ??= { text: this.editor.text, revision: this.file.revision };  // it may not have arrived
    this.pending = 0;
    this.joined = false;
  }

  /** @param {string} text @param {boolean} [failed] @param {boolean} [passes] whether it disappears after a while */
  say(text, failed = false, passes = !failed) { this.status.say(text, failed, passes); }
}

/** @typedef {Studio} StudioPage */

Object.assign(window, { studio: new Studio() });
