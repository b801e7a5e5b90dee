// Changes of the page whose answers have not come when the connection ends: sent again, or given up.

/** @import { TextMessage } from "./types.d.ts" */

/** A change by the drawing, undo or redo. @typedef {{ kind: "edit" | "undo" | "redo", label?: string, operations?: Record<string, unknown>[] }} Sent */

/** What the text of the server says about the last change: it has not arrived, it is made, or another page has changed the text; null if no page has.
 * @param {TextMessage} file as the server has it @param {number} before revision of the page @param {number | null} editing revision that the change was made for, if it is not answered @param {Sent | null} sent the change
 * @returns {"lost" | "made" | "replaced" | null} */
export function lastChange(file, before, editing, sent) {
  if (editing === null) return file.revision === before ? null : "replaced";
  if (file.revision <= editing) return "lost";
  const isOwn = sent?.kind !== "edit" || file.undo === sent.label?.slice(0, 60);
  return file.revision === editing + 1 && isOwn ? "made" : "replaced";
}
