// Live page: sliders run the analysis again, and the drawing, plots and responses follow.

/** @import { Dimension } from "./scene_types.d.ts" */
/** @import { LiveCode, LiveData, LiveFailure, LiveResult } from "./types.d.ts" */
/** @import { Motion } from "./motion.js" */
/** @import { Board } from "./plot_board.js" */
/** @import { Player } from "./player.js" */
/** @import { Scene } from "./scene.js" */

import { byId, el } from "./dom.js";
import { addMenu, firstResponses } from "./live_add.js";
import { linkDesigns } from "./live_choice.js";
import { Design } from "./live_design.js";
import { PathDrag } from "./live_drag.js";
import { KeptDesigns } from "./live_kept.js";
import { Improvement } from "./live_improve.js";
import { ParameterPanel } from "./live_panel.js";
import { LivePicture } from "./live_picture.js";
import { designMenu } from "./live_share.js";
import { Solver } from "./live_solver.js";
import { ResponseTable } from "./live_table.js";
import { tidy } from "./numbers.js";
import { payload } from "./payload.js";
import { Signal } from "./theme.js";
import { withUnit } from "./units.js";

/** Time without a change after which the address follows the design [ms]. */
const WRITING = 300;

/** Time without a change after which a drag that shows the first instant alone is followed by the whole motion [ms]. */
const FOLLOWS = 400;

/** Text about a design that cannot be computed. @param {LiveFailure} failure */
function failureText({ failure: { outcome, message }, open }) {
  const gap = open ? `: ${open.name} stays open by ${withUnit(tidy(open.gap, 3), open.unit)}` : "";
  return `${message.includes(outcome) ? message : `${outcome}: ${message}`}${gap}`.replace(/^./, (c) => c.toUpperCase()) + ". The picture is that of the last valid design.";
}

/** Note that extremes and means are those of the outputs, where Python looks inside the steps. @param {LiveData} live */
const reductionNote = (live) => live.adaptive && el("p", { class: "caption note" },
  `Responses of these ${live.times?.length ?? 0} outputs; under error control Python also looks for extremes inside the steps.`);

/** @param {{ motion: Motion, scene: Scene, player: Player, board: Board | null }} page @param {Dimension} dimension */
export function buildLive(page, dimension) {
  const code = /** @type {LiveCode} */ (payload.live), numbers = JSON.parse(code.exact);
  /** @type {LiveData} */
  const live = { ...code, ...numbers }, solver = new Solver(live), design = new Design(live.parameters), picture = new LivePicture(live, page, dimension);
  const panel = new ParameterPanel(design), table = new ResponseTable(firstResponses(live)), drag = new PathDrag(page, design, live);
  const improvement = new Improvement(design, table, solver), add = addMenu(live, (response) => table.add(response));
  const card = el("section", { class: "card live", id: "live", "aria-label": "Parameters and responses" },
    panel.node, el("div", { class: "plot-head" }, el("h2", {}, "Responses"), el("div", { class: "live-tools" }, improvement.toggle, add)), table.node, reductionNote(live), improvement.node);
  const kept = new KeptDesigns(design, table, picture);
  panel.tools.append(kept.button, designMenu(design, (text) => panel.say(text)));
  if (live.parameters.some(({ drawn }) => !drawn)) {
    byId("board").hidden = false;  // also where there is nothing to plot
    document.body.classList.remove("single");
    byId("board").prepend(card, kept.node);
  }
  linkDesigns(design, panel, live);

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let pause;
  const request = (origin = "") => {
    clearTimeout(pause);
    const first = origin === "drawing" && picture.slow;
    if (first) pause = setTimeout(request, FOLLOWS);
    return solver.request({ first, parameters: design.values, responses: table.responses, gradients: table.responses.length && origin !== "drawing" ? [table.selected] : [], point: drag.request });
  };
  const connect = () => {
    solver.onResult.on((/** @type {LiveResult} */ result) => {
      if (result.first) {
        picture.showFirst(result);
        page.scene.drawEarly();
        document.documentElement.dataset.live = String(result.number);
        return;
      }
      picture.show(result);
      page.scene.drawEarly();
      card.classList.remove("stale");
      table.show(result.values);
      const { success, outcome, message, warning } = result.status;
      if (!success) panel.say(`${outcome}: ${message}`.replace(/^./, (c) => c.toUpperCase()), "error"); else if (warning) panel.say(`${warning}.`, "warning"); else if (panel.failed) panel.say("");
      document.documentElement.dataset.live = String(result.number);
    });
    solver.onSlopes.on((answer) => {
      if (!answer.slopes.length && !answer.jacobian && table.responses.length) return;  // of the first instant alone
      panel.showSlopes(answer.slopes[table.selected] ?? null, table.responses[table.selected] ?? null);
      drag.receive(answer);
    });
    solver.onFailure.on((failure) => {
      panel.say(failureText(failure), "error");
      card.classList.add("stale");
      document.documentElement.dataset.live = String(failure.number);
      drag.retreat();
    });
    solver.onBusy.on((time) => panel.busy(time, solver.duration));
    design.onChange.on((origin) => { if (origin !== "improve") request(origin); });
    for (const signal of [table.onSelect, table.onList, drag.onHold]) /** @type {Signal<any>} */ (signal).on(() => request());
    request();
  };
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let writing;
  design.onChange.on(() => { clearTimeout(writing); writing = setTimeout(() => design.write(), WRITING); });
  solver.ready.then(async () => {
    const answer = await solver.request({ parameters: design.initial, responses: [], gradients: [] });
    if (answer && "result" in answer) {
      table.initial = answer.result;
      if (live.designs) picture.compareWith(answer.result);
    }
    connect();
  }, (error) => {
    card.replaceChildren(el("p", { class: "live-status", role: "status" }, `This browser cannot run the mechanism again: ${error.message}. The report shows the initial design.`));
    card.classList.add("unavailable");
    document.documentElement.dataset.live = "unavailable";
  });
  Object.assign(/** @type {any} */ (window).dalembert, { design, solver, table, drag, picture, improvement, kept });
}
