// Page of a mechanism: drawing, player, plots, cards.

/** @import { MechanismScene, Payload } from "./types.d.ts" */
/** @import { Timeline } from "./timeline.js" */

import { buildColumns, choice, viewPanels } from "./cards.js";
import { byId, el, toggleButton } from "./dom.js";
import { buildFrame, buildZoom } from "./frame.js";
import { arrowMenu } from "./loads.js";
import { clamp, list } from "./numbers.js";
import { eventPanel, valuePanel } from "./panels.js";
import { payload } from "./payload.js";
import { Picker } from "./picker.js";
import { Player, bindKeys, buildPlayer } from "./player.js";
import { Board } from "./plot_board.js";
import { shareMenu } from "./share.js";
import { Theme } from "./theme.js";
import { preferUnits } from "./units.js";

/** Build the page, with the reader of motions, the drawing and its tools of the plane or of space.
 * @template {Timeline} M
 * @param {(data: Payload) => M} readMotion
 * @param {(motion: M) => MechanismScene} drawScene
 * @param {(scene: MechanismScene, toolbar: HTMLElement) => void} [buildTools] */
export function buildPage(readMotion, drawScene, buildTools = () => {}) {
  Theme.read();
  preferUnits(payload.units);
  const motion = readMotion(payload), scene = drawScene(motion), player = new Player(motion);
  const picker = new Picker(/** @type {HTMLDialogElement} */ (byId("picker")), motion);
  const board = motion.moves && motion.series.length ? new Board(byId("board"), motion, player, picker) : null;
  player.onTime.on((t) => { motion.setTime(t); scene.invalidate(); });

  const toggles = el("div", { class: "chips" }, shownParts(motion, scene));
  byId("toolbar").append(toggles);
  buildTools(scene, toggles);
  toggles.append(arrowMenu(scene) ?? "", followChooser(motion, scene) ?? "");
  if (motion.points.length && motion.moves) byId("toolbar").append(traceChips(motion, scene));
  byId("scene").setAttribute("aria-label", `Drawing of ${motion.title}: ${motion.bodies.length} bodies, ${motion.joints.length} joints. ${scene.hint}`);
  buildZoom(scene, "Fit the whole motion (F)");
  buildFrame({
    units: "Values without a unit are in SI units.", tools: [shareMenu(scene, motion.title, player)], scene, board, player,
    keys: [...(motion.moves ? /** @type {[string, string][]} */ ([["Space", "play"], ["← →", "step"]]) : []), ["F", "fit"], ["+ −", "zoom"]],
  });
  Theme.listeners.on(() => { for (const point of motion.points) point.swatch?.style.setProperty("--c", scene.pointColour(point)); });

  buildColumns([valuePanel(motion)], [eventPanel(motion, player)]);
  const beside = viewPanels(true);
  if (beside.length) byId("board").prepend(el("div", { class: "beside" }, beside));
  board?.addDefault(payload.default_plots);
  if (!board && !list(payload.views).some((view) => view.place === "board")) {
    byId("board").hidden = true;
    document.body.classList.add("single");
  }
  if (motion.moves) buildPlayer(byId("player"), player);
  bindKeys(player, scene);
  choice?.onChoose.on((k) => showDesign(k, motion, scene, board, readMotion, player));
  Theme.set(Theme.name);
  player.seek(motion.start);
  Object.assign(window, { dalembert: { player, motion, scene, board, choice } });
  if (motion.moves && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
}

/** Buttons that show and hide parts of the drawing. @param {Timeline} motion @param {MechanismScene} scene */
function shownParts(motion, scene) {
  const show = (/** @type {string} */ key) => (/** @type {boolean} */ on) => { scene.show[key] = on; scene.invalidate(); };
  const ghost = payload.ghost_name || (payload.optimum && "First design") || (motion.other && "Other run");
  const swatch = el("i", { class: "swatch" });
  swatch.style.setProperty("--c", "var(--force)");
  return [
    ghost && motion.ghosts.length > 0 && toggleButton(ghost, true, show("ghosts"), { id: "ghosts" }),
    scene.loaded.length > 0 && toggleButton([swatch, "Reactions"], false, show("forces"), { id: "reactions", title: "Reaction forces and moments at the joints" }),
    toggleButton("Labels", scene.show.labels, show("labels"), { id: "labels" }),
    toggleButton("Grid", true, show("grid"), { id: "grid" }),
  ];
}

/** Buttons of the traced points. @param {Timeline} motion @param {MechanismScene} scene */
function traceChips(motion, scene) {
  const chips = motion.spots.map((point) => {
    const swatch = el("i", { class: "swatch" }), text = point.names.slice(0, 2).join(" = ") + (point.names.length > 2 ? " …" : "");
    point.swatch = swatch;
    return toggleButton([swatch, el("span", {}, text)], point.traced, (on) => { point.traced = on; scene.invalidate(); }, { class: "chip trace", title: `Trace ${point.names.join(", ")}` });
  });
  return el("div", { class: "chips traces", role: "group", "aria-label": "Traced points" }, el("span", { class: "caption" }, "Trace"), chips);
}

/** Choice of the body that the view follows. @param {Timeline} motion @param {MechanismScene} scene */
function followChooser(motion, scene) {
  const bodies = motion.bodies.filter((body) => !body.of && !body.node);
  if (!motion.moves || !bodies.length) return null;
  const options = bodies.map((body, k) => el("option", { value: String(k) }, body.name));
  const select = el("select", { id: "follow", onchange: () => scene.follow(bodies[+(select.value || -1)] ?? null) }, el("option", { value: "" }, "nothing"), options);
  select.value = scene.followed ? String(bodies.indexOf(scene.followed)) : "";
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, "Follow"), select);
}

/** Show another design: at once in the plane, by loading the page again in space.
 * @template {Timeline} M
 * @param {number} k @param {M} motion @param {MechanismScene} scene @param {Board | null} board @param {(data: Payload) => M} readMotion @param {Player} player */
function showDesign(k, motion, scene, board, readMotion, player) {
  const design = choice?.alternatives[k];
  if (!design?.scene) return;
  history.replaceState(null, "", `#design=${k}`);
  if (!scene.renew) { location.reload(); return; }
  const next = readMotion({ ...payload, ...design }), traced = new Set(motion.points.filter((point) => point.traced).map(({ name }) => name)), { now } = motion;
  for (const point of next.points) point.swatch = motion.points.find(({ name }) => name === point.name)?.swatch;
  Object.assign(motion, next);
  scene.renew(traced);
  for (const plot of board?.plots ?? []) plot.setSeries(motion.named(plot.series.map(({ name }) => name)));
  Theme.set(Theme.name);
  player.seek(clamp(now, motion.start, motion.end));
}
