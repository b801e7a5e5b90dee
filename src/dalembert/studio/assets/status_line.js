// Line below the drawing: the summary of the model, notices, and whether a picture is being made.

/** @import { PictureMessage } from "./types.d.ts" */

import { byId } from "./dom.js";

const ENDED = "the program has ended: its model is kept, saved or not, and comes back when it is started again; later changes are only in this tab";
const OUTDATED = "the program was started again: open the address that it printed; changes of this page that were not confirmed are not in it";
/** Time for which a notice is shown [ms]. */
const SHOWN = 6000;
/** Time after which the line says that a picture is being made [ms]. */
const SLOW = 1200;

export class StatusLine {
  constructor() {
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.timer = undefined;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.slow = undefined;
  }

  /** @param {string} text @param {boolean} [failed] @param {boolean} [passes] whether it disappears after a while */
  say(text, failed = false, passes = !failed) {
    const notice = byId("notice");
    notice.textContent = text;
    notice.classList.toggle("error", failed);
    clearTimeout(this.timer);
    if (passes) this.timer = setTimeout(() => { notice.textContent = ""; }, SHOWN);
  }

  /** Show why there is no connection. @param {boolean} connected @param {import("./link.js").Link | undefined} link */
  connected(connected, link) {
    const node = byId("link");
    node.textContent = connected ? "" : link?.outdated ? OUTDATED : link?.stopped ? "stopped" : link?.ended ? ENDED : "not connected; changes are sent when the program answers";
    node.classList.toggle("error", !connected);
  }

  /** Show that a picture is being made, if it takes a while. @param {() => boolean} isWorking */
  watch(isWorking) {
    clearTimeout(this.slow);
    byId("work").hidden = true;
    this.slow = setTimeout(() => { byId("work").hidden = !isWorking(); }, SLOW);
  }

  /** Show degrees of freedom and redundant constraints; returns them. @param {PictureMessage} message */
  summarise({ summary = "", facts = {} }) {
    byId("summary").textContent = summary;
    const redundant = facts.redundant ? `${facts.redundant} redundant constraint${facts.redundant > 1 ? "s" : ""} (${(facts.redundancies ?? []).join("; ")})` : "";
    Object.assign(byId("freedom"), { textContent: redundant, title: redundant });  // a long one is cut off
    return [summary, redundant].filter(Boolean).join("; ");
  }
}
