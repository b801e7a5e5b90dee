// Page of a mechanism or a structure: drawing, player, plots or tables, cards.

/** @import { Child } from "./types.d.ts" */
/** @import { Dimension } from "./scene_types.d.ts" */
/** @import { Motion } from "./motion.js" */

import { buildColumns, choice, viewPanels } from "./cards.js";
import { stateCharts } from "./charts.js";
import { byId, el, toggleButton } from "./dom.js";
import { buildFrame, buildZoom } from "./frame.js";
import { arrowMenu } from "./loads.js";
import { clamp, list } from "./numbers.js";
import { eventPanel, valuePanel } from "./panels.js";
import { payload } from "./payload.js";
import { Picker } from "./picker.js";
import { Player, bindKeys, buildPlayer } from "./player.js";
import { Board } from "./plot_board.js";
import { Scene } from "./scene.js";
import { shareMenu } from "./share.js";
import { Theme } from "./theme.js";
import { preferUnits } from "./units.js";

/** Build the page with the view of a dimension, and the tools that only that view has; returns its parts.
 * @param {Dimension} dimension @param {(scene: Scene, toolbar: HTMLElement) => void} [buildTools] */
export function buildPage(dimension, buildTools = () => {}) {
  Theme.read();
  preferUnits(payload.units);
  const motion = new dimension.Motion(payload, dimension), { mesh } = motion, scene = new Scene(motion, /** @type {HTMLCanvasElement} */ (byId("scene")), byId("tip"), dimension), player = new Player(motion);
  const picker = new Picker(/** @type {HTMLDialogElement} */ (byId("picker")), motion);
  const board = motion.moves && !motion.swings && motion.series.length ? new Board(byId("board"), motion, player, picker) : null;
  player.onTime.on((t) => { motion.setTime(t); scene.invalidate(); });
  player.onState.on(() => { if (motion.swings && !player.playing) player.seek(motion.home); });

  const toggles = el("div", { class: "chips" }, shownParts(motion, scene));
  byId("toolbar").append(toggles);
  buildTools(scene, toggles);
  toggles.append(arrowMenu(scene) ?? "", followChooser(motion, scene) ?? "");
  if (motion.points.length && motion.moves && !motion.swings) byId("toolbar").append(traceChips(motion, scene));
  const parts = mesh ? `${mesh.nodes.length} nodes, ${mesh.elements.length} elements` : `${motion.bodies.length} bodies, ${motion.joints.length} joints`;
  byId("scene").setAttribute("aria-label", `Drawing of ${motion.title}: ${parts}. ${scene.hint}`);
  buildZoom(scene, "Fit (F)");
  /** @type {[string, string][]} */
  const keys = motion.swings ? [["Space", "animate"], ...(motion.n > 1 ? /** @type {[string, string][]} */ ([["← →", "state"]]) : [])] : motion.moves ? [["Space", "play"], ["← →", "step"]] : [];
  buildFrame({
    units: "Values without a unit are in SI units.", tools: [shareMenu(scene, motion.title, player)], scene, board, player,
    keys: [...keys, ["F", "fit"], ["+ −", "zoom"]],
  });
  Theme.listeners.on(() => { for (const point of motion.points) point.swatch?.style.setProperty("--c", scene.pointColour(point)); });

  buildColumns([valuePanel(motion)], [eventPanel(motion, player)]);
  const beside = viewPanels(true);
  if (beside.length) byId("board").prepend(el("div", { class: "beside" }, beside));
  board?.addDefault(payload.default_plots);
  if (motion.moves) buildPlayer(byId("player"), player);
  for (const chart of stateCharts) chart.bind(motion);
  if (mesh) dimension.structure?.build(motion, mesh);
  else if (!board && !list(payload.views).some((view) => view.place === "board")) {
    byId("board").hidden = true;
    document.body.classList.add("single");
  }
  bindKeys(player, scene);
  choice?.onChoose.on((k) => showDesign(k, motion, scene, board, dimension, player));
  Theme.set(Theme.name);
  player.seek(motion.home);
  scene.fit();
  Object.assign(window, { dalembert: { player, motion, scene, board, choice, charts: stateCharts } });
  if (motion.moves && !(motion.swings && motion.mesh) && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
  return { motion, scene, player, board };
}

/** Buttons that show and hide parts of the drawing. @param {Motion} motion @param {Scene} scene @returns {Child} */
function shownParts(motion, scene) {
  const show = (/** @type {string} */ key) => (/** @type {boolean} */ on) => { scene.show[key] = on; scene.invalidate(); };
  const ghost = !("code" in (payload.live ?? {})) && (payload.ghost_name || (payload.optimum && "First design") || (motion.other && (motion.mesh ? `Other run: ${motion.other}` : "Other run"))), { mesh } = motion;
  const swatch = el("i", { class: "swatch" });
  swatch.style.setProperty("--c", mesh ? "var(--accent)" : "var(--force)");
  return [
    ghost && (motion.ghosts.length > 0 || motion.otherMesh !== null) && toggleButton(ghost, true, show("ghosts"), { id: "ghosts" }),
    scene.structure?.toggles(motion, scene, show),
    scene.applied.length > 0 && toggleButton("Loads", true, show("loads"), { id: "loads", title: "Applied forces and moments" }),
    scene.loaded.length > 0 && toggleButton([swatch, "Reactions"], false, show("forces"), { id: "reactions", title: `Reaction forces and moments at the ${mesh ? "supports" : "joints"}` }),
    toggleButton(mesh ? "Names" : "Labels", scene.show.labels, show("labels"), { id: "labels" }),
    toggleButton("Grid", scene.show.grid, show("grid"), { id: "grid" }),
  ];
}

/** Buttons of the traced points. @param {Motion} motion @param {Scene} scene */
function traceChips(motion, scene) {
  const chips = motion.spots.map((point) => {
    const swatch = el("i", { class: "swatch" }), text = point.names.slice(0, 2).join(" = ") + (point.names.length > 2 ? " …" : "");
    point.swatch = swatch;
    return toggleButton([swatch, el("span", {}, text)], point.traced, (on) => { point.traced = on; scene.invalidate(); }, { class: "chip trace", title: `Trace ${point.names.join(", ")}` });
  });
  return el("div", { class: "chips traces", role: "group", "aria-label": "Traced points" }, el("span", { class: "caption" }, "Trace"), chips);
}

/** Choice of the body that the view follows. @param {Motion} motion @param {Scene} scene */
function followChooser(motion, scene) {
  const bodies = motion.bodies.filter((body) => !body.of && !body.node);
  if (!motion.moves || motion.swings || !bodies.length) return null;
  const options = bodies.map((body, k) => el("option", { value: String(k) }, body.name));
  const select = el("select", { id: "follow", onchange: () => scene.follow(bodies[+(select.value || -1)] ?? null) }, el("option", { value: "" }, "nothing"), options);
  select.value = scene.followed ? String(bodies.indexOf(scene.followed)) : "";
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, "Follow"), select);
}

/** Show another design. @param {number} k @param {Motion} motion @param {Scene} scene @param {Board | null} board @param {Dimension} dimension @param {Player} player */
function showDesign(k, motion, scene, board, dimension, player) {
  const design = choice?.alternatives[k];
  if (!design?.scene) return;
  history.replaceState(null, "", `#design=${k}`);
  const next = new dimension.Motion({ ...payload, ...design }, dimension), traced = new Set(motion.points.filter((point) => point.traced).map(({ name }) => name)), { now } = motion;
  for (const point of next.points) point.swatch = motion.points.find(({ name }) => name === point.name)?.swatch;
  motion.replace(next);
  scene.renew(traced);
  for (const plot of board?.plots ?? []) plot.setSeries(motion.named(plot.series.map(({ name }) => name)));
  Theme.set(Theme.name);
  player.seek(clamp(now, motion.start, motion.end));
}
