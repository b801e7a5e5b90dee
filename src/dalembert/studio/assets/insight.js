// Insight and design tasks of the studio: their sheets, and what they draw on the picture.

/** @import { StudioPage } from "./studio.js" */
/** @import { PictureMessage, TaskMessage } from "./types.d.ts" */

import { AnalysisSheet } from "./analysis.js";
import { ContactSheet } from "./contact_sheet.js";
import { DesignSheet, titleOf } from "./design.js";
import { Ghosts } from "./ghosts.js";
import { OverlayBar } from "./overlay_bar.js";
import { SynthesisSheet } from "./synthesis.js";
import { TargetDrag } from "./target_drag.js";
import { drawTargets } from "./targets.js";
import { ResultPanel } from "./tasks.js";

/** Add the sheets to the studio. @param {StudioPage} studio */
export function addInsight(studio) {
  const ghosts = new Ghosts(studio.pictures, {
    request: (kind, more) => void studio.request(kind, more),
    edit: (label, operations) => studio.change({ label, operations }),
    refuse: (text) => studio.say(text, true),
    rest: () => studio.drawing.rest(),
    document: () => studio.file.document,
    revision: () => studio.file.revision,
    selects: () => studio.drawing.tool.name === "select",
  });
  const overlays = new OverlayBar(studio.pictures, ghosts, () => studio.drawing.selection, () => studio.drawing.possible && studio.drawing.tool.name !== "select", (text) => studio.say(text));
  const drag = new TargetDrag(studio.pictures, { edit: (label, operations) => studio.change({ label, operations }), document: () => studio.known, selects: () => studio.drawing.tool.name === "select" });
  let marked = -1;
  const result = new ResultPanel(({ section }, values) => studio.change({ label: `adopt ${section}`, operations: Object.entries(values).map(([name, value]) => ({ op: "parameter", name, value })) }));
  const shared = {
    request: (/** @type {string} */ kind, more = {}) => void studio.request(kind, more),
    edit: (/** @type {string} */ label, /** @type {Record<string, unknown>[]} */ operations) => studio.change({ label, operations }),
    draw: (/** @type {string} */ tool) => studio.drawing.choose(tool),
    start: (/** @type {string} */ section) => {
      studio.say("");  // a refusal before it
      studio.request("start", { section });
    },
    stop: () => void studio.request("stop task"),
    open: (/** @type {TaskMessage} */ task) => result.open(task, titleOf(task.section)),
    digest: () => studio.file.digest,
    measures: () => (studio.pictures.page?.motion.series ?? []).map((/** @type {{ name: string }} */ { name }) => name),
    reveal: (/** @type {string} */ section) => {
      const at = studio.editor.text.search(new RegExp(`^\\s*\\[+${section}\\b`, "m"));
      studio.sheets.show("text");
      if (at >= 0) studio.editor.select(studio.editor.text.indexOf("[", at), studio.editor.text.indexOf("]", at) + 1);
    },
    fit: () => { const view = studio.pictures.page?.scene.view; if (view) view.fitted = true; },  // of the next picture
    mark: (/** @type {number} */ entry) => { marked = entry; studio.pictures.page?.scene.invalidate(); },
  };
  const analysis = new AnalysisSheet(shared, [overlays.node]), design = new DesignSheet(shared), synthesis = new SynthesisSheet(shared), contacts = new ContactSheet(shared);
  studio.sheets.add({ name: "analysis", title: "Analysis", node: analysis.node });
  studio.sheets.add({ name: "design", title: "Design", node: design.node, onShow: () => design.render() });
  studio.sheets.add({ name: "synthesis", title: "Synthesis", node: synthesis.node, mechanism: true });
  studio.sheets.add({ name: "contacts", title: "Contacts", node: contacts.node, mechanism: true });
  studio.onDocument.push((document) => { if (document) { contacts.show(document); studio.sheets.offer(/** @type {unknown} */ (document.kind) !== "structure"); } analysis.show(document); design.show(document); synthesis.show(document); });
  studio.handlers.assemblies = (message) => ghosts.receive(message);
  studio.handlers.preview = (message) => analysis.receive(message);
  studio.handlers.task = (/** @type {TaskMessage} */ task) => {
    design.receive(task);
    synthesis.receive(task);
  };
  studio.pictures.onShow.push((page) => {
    page.scene.overlays.push((/** @type {{ ctx: CanvasRenderingContext2D }} */ { ctx }) => {
      const colour = getComputedStyle(document.documentElement).getPropertyValue("--error").trim();
      if (page.scene.view && "s" in page.scene.view) drawTargets(ctx, page, drag.document, colour, marked);
    });
  });
  return { analysis, design, synthesis, overlays, ghosts, result, describe: (/** @type {PictureMessage} */ message) => analysis.describe(message) };
}
