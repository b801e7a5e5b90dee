// Live page: sliders run the analysis again, and the drawing, plots and responses follow.

/** @import { Dimension } from "./scene_types.d.ts" */
/** @import { LiveCode, LiveData, LiveResponse, LiveResult } from "./types.d.ts" */
/** @import { Motion } from "./motion.js" */
/** @import { Board } from "./plot_board.js" */
/** @import { Player } from "./player.js" */
/** @import { Scene } from "./scene.js" */

import { byId, el } from "./dom.js";
import { Design } from "./live_design.js";
import { PathDrag } from "./live_drag.js";
import { ParameterPanel } from "./live_panel.js";
import { Solver } from "./live_solver.js";
import { ResponseTable } from "./live_table.js";
import { clamp, list } from "./numbers.js";
import { payload } from "./payload.js";

/** Upper limit of the responses that are listed by default. */
const MAX_RESPONSES = 6;

/** Responses of the plotted series. @param {LiveData} live @returns {LiveResponse[]} */
function plottedResponses(live) {
  const rows = new Map(live.columns.filter(([path]) => path[0] === "series").map(([path, row]) => [Number(path[1]), row])), series = list(payload.series);
  const names = list(payload.default_plots).flat();
  return names.flatMap((name) => {
    const k = series.findIndex((s) => s.name === name), row = rows.get(k), unit = String(series[k]?.unit ?? "");
    return row === undefined ? [] : [/** @type {LiveResponse} */ ({ kind: "maximum", row, label: `maximum of ${name}`, unit })];
  }).slice(0, MAX_RESPONSES);
}

/** Put columns and numbers into the payload. @param {LiveData} live @param {LiveResult} result */
function putResult(live, { table, times, numbers }) {
  const n = times.length;
  const put = (/** @type {(string | number)[]} */ place, /** @type {unknown} */ value) => {
    let owner = /** @type {any} */ (payload);
    for (const key of place.slice(0, -1)) owner = owner[key];
    owner[/** @type {string} */ (place.at(-1))] = value;
  };
  for (const [place, row] of live.columns) put(place, table.subarray(n * row, n * (row + 1)));
  live.numbers.forEach((place, k) => put(place, numbers[k]));
  payload.time = times;
}

/** @param {{ motion: Motion, scene: Scene, player: Player, board: Board | null }} page @param {Dimension} dimension */
export function buildLive({ motion, scene, player, board }, dimension) {
  const code = /** @type {LiveCode} */ (payload.live), numbers = JSON.parse(code.exact);
  /** @type {LiveData} */
  const live = { ...code, ...numbers }, design = new Design(live.parameters), solver = new Solver(live);
  const panel = new ParameterPanel(design), responses = plottedResponses(live), table = new ResponseTable(responses);
  const card = el("section", { class: "card live", id: "live", "aria-label": "Parameters and responses" }, panel.node, table.node);
  byId("board").prepend(card);

  const drag = new PathDrag({ motion, scene, player }, design, live);
  const request = () => solver.request({ parameters: design.values, responses, gradient: responses.length ? table.selected : null, point: drag.request });
  /** @param {LiveResult} result */
  const show = (result) => {
    putResult(live, result);
    const next = new dimension.Motion(payload, dimension.structure), traced = new Set(motion.points.filter((point) => point.traced).map(({ name }) => name)), { now } = motion;
    for (const point of next.points) point.swatch = motion.points.find(({ name }) => name === point.name)?.swatch;
    motion.replace(next);
    scene.renew(traced);
    for (const plot of board?.plots ?? []) plot.renew(motion.named(plot.series.map(({ name }) => name)));
    player.seek(clamp(now, motion.start, motion.end));
  };
  solver.onResult.on((result) => {
    show(result);
    table.show(result.values);
    const { success, outcome, message } = result.status;
    panel.say(success ? "" : `${outcome}: ${message}`, "error");
    document.documentElement.dataset.live = String(result.number);
  });
  solver.onSlopes.on((answer) => {
    panel.showSlopes(answer.slopes, responses[table.selected] ?? null);
    drag.receive(answer);
  });
  drag.onHold.on(request);
  solver.onFailure.on(({ number, failure: { outcome, message } }) => {
    panel.say(`${outcome}: ${message}. The picture is that of the last valid design.`, "error");
    document.documentElement.dataset.live = String(number);
    drag.retreat();
  });
  solver.onBusy.on((busy) => panel.node.classList.toggle("busy", busy));
  design.onChange.on(request);
  table.onSelect.on(request);
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let writing;
  design.onChange.on(() => { clearTimeout(writing); writing = setTimeout(() => design.write(), 300); });
  solver.ready.then(request, (error) => panel.say(`This browser does not run the page: ${error.message}`, "error"));
  Object.assign(/** @type {any} */ (window).dalembert, { design, solver, table, drag });
}
