// Puts the page together.

const byId = (id) => document.getElementById(id);
if (begun) Object.assign(payload, begun);
byId("subtitle").textContent = payload.subtitle || "";
byId("subtitle").hidden = !payload.subtitle;

Theme.read();
chooseUnits(payload.units);
const motion = readMotion(payload);
const player = new Player(motion);
const scene = drawScene(motion);
const picker = new Picker(byId("picker"), motion);
const board = motion.moves && motion.series.length ? new Board(byId("board"), motion, player, picker) : null;

player.onTime.on((t) => { motion.setTime(t); scene.invalidate(); });

function buildToolbar() {
  const show = (key) => (on) => { scene.show[key] = on; scene.invalidate(); };
  const toggles = [toggleButton("Labels", scene.show.labels, show("labels"), { id: "labels" }), toggleButton("Grid", true, show("grid"), { id: "grid" })];
  if (scene.loaded.length) {
    const legend = el("i", { class: "swatch" });
    legend.style.setProperty("--c", "var(--force)");
    toggles.unshift(toggleButton("Reactions", false, show("forces"), { id: "reactions", title: "Reaction forces and moments at the joints" }));
    toggles[0].prepend(legend);
  }
  const ghost = payload.ghost_name || (payload.optimum && "First design") || (motion.other && "Other run");
  if (ghost && motion.ghosts.length) toggles.unshift(toggleButton(ghost, true, show("ghosts"), { id: "ghosts" }));
  const chips = el("div", { class: "chips" }, toggles);
  byId("toolbar").append(chips);
  moreTools(scene, chips);
  chips.append(...[arrowMenu(scene), followChooser()].filter(Boolean));
  if (!motion.points.length || !motion.moves) return;
  const traces = motion.spots.map((point) => {
    const swatch = el("i", { class: "swatch" });
    point.swatch = swatch;
    const chip = toggleButton(swatch, point.traced, (on) => { point.traced = on; scene.invalidate(); }, { class: "chip trace", title: `Trace ${point.names.join(", ")}` });
    chip.append(el("span", {}, point.names.slice(0, 2).join(" = ") + (point.names.length > 2 ? " …" : "")));
    return chip;
  });
  byId("toolbar").append(el("div", { class: "chips traces", role: "group", "aria-label": "Traced points" }, el("span", { class: "caption" }, "Trace"), traces));
}

// The body that the view goes with.
function followChooser() {
  const bodies = motion.bodies.filter((body) => !body.of && !body.node);
  if (!motion.moves || !bodies.length) return null;
  const select = el("select", { id: "follow", onchange: () => scene.follow(bodies[select.value] ?? null) },
    el("option", { value: "" }, "nothing"), bodies.map((body, k) => el("option", { value: String(k) }, body.name)));
  select.value = scene.followed ? String(bodies.indexOf(scene.followed)) : "";
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, "Follow"), select);
}

function buildFrame() {
  byId("zoom").append(
    iconButton("plus", "Zoom in (+)", () => scene.zoom(1.25)),
    iconButton("minus", "Zoom out (−)", () => scene.zoom(0.8)),
    iconButton("fit", "Fit the whole motion (F)", () => scene.fit(), { id: "fit" }));
  byId("tools").append(
    shareMenu(scene, motion, player),
    iconButton("theme", "Light or dark", () => setTheme(Theme.name === "dark" ? "light" : "dark"), { id: "theme" }),
    iconButton("print", "Print", () => window.print()));
  byId("scene").setAttribute("aria-label",
    `Drawing of ${motion.title}: ${motion.bodies.length} bodies, ${motion.joints.length} joints. ${scene.hint}`);
  const hints = motion.moves ? [["Space", "play"], ["← →", "step"], ["F", "fit"], ["+ −", "zoom"]] : [["F", "fit"], ["+ −", "zoom"]];
  byId("footer").append(
    el("span", {}, "Made with dalembert. Values without a unit are in SI units."),
    el("span", { class: "keys" }, hints.map(([key, what]) => [el("kbd", {}, key), ` ${what} `])));
}

function buildPanels() {
  const statistics = payload.designs ? [] : list(payload.statistics), below = viewPanels(false);
  byId("panels").append(...below.filter((node) => node.classList.contains("wide")));
  const columns = [
    [optimumPanel(payload.optimum), ...half(below, 0), diagnosisPanel(payload.diagnosis), valuePanel(motion), payload.optimum || payload.designs ? null : parameterPanel(payload.parameters)],
    [convergencePanel(payload.optimum), ...half(below, 1), statistics.length ? panel("Statistics", "statistics", pairs(statistics)) : null, eventPanel(motion, player)],
  ].map((column) => column.filter(Boolean)).filter((column) => column.length);
  byId("panels").append(...columns.map((column) => el("div", { class: "column" }, column)));
  verdict(byId("verdict"), payload.diagnosis);
  decisionVerdict(byId("verdict"));
  const beside = viewPanels(true);
  byId("board").prepend(...(beside.length ? [el("div", { class: "beside" }, beside)] : []));
}

// The cards of one of two columns; wide ones stand over both.
const half = (cards, side) => cards.filter((node) => !node.classList.contains("wide")).filter((_, k) => k % 2 === side);

// Another design is shown in place of this one: at once in the plane, by opening the page anew in space.
function showDesign(k) {
  const next = choosing.alternatives[k];
  if (!next?.scene) return;
  history.replaceState(null, "", `#design=${k}`);
  if (!scene.renew) { location.reload(); return; }
  const after = readMotion({ ...payload, ...next }), traced = new Set(motion.points.filter((p) => p.traced).map((p) => p.name)), { now } = motion;
  for (const point of after.points) point.swatch = motion.points.find((p) => p.name === point.name)?.swatch;
  Object.assign(motion, after);
  scene.renew(traced);
  for (const plot of board?.plots ?? []) plot.setSeries(plot.series.map((s) => motion.seriesByName.get(s.name)).filter(Boolean));
  setTheme(Theme.name);
  player.seek(clamp(now, motion.start, motion.end));
}

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  Theme.read();
  for (const point of motion.points) point.swatch?.style.setProperty("--c", scene.pointColour(point));
  scene.restyle();
  board?.restyle();
  Theme.listeners.emit();
}

// On paper: light, sharp, at rest, and drawn in the size of the sheet.
function preparePrint() {
  const style = document.documentElement;
  let before = null;
  const redraw = (paper, theme) => {
    style.classList.toggle("paper", paper);
    scene.ratio = paper ? 3 : undefined;
    if (board) board.ratio = scene.ratio;
    setTheme(theme);
    scene.resize();
    scene.draw();
  };
  window.addEventListener("beforeprint", () => {
    before ??= Theme.name;
    player.pause();
    redraw(true, "light");
  });
  window.addEventListener("afterprint", () => {
    redraw(false, before || Theme.name);
    before = null;
  });
}

buildToolbar();
buildFrame();
buildPanels();
if (motion.moves) buildPlayer(byId("player"), player);
choosing?.onChoose.on(showDesign);
if (board) {
  const wanted = list(payload.default_plots).map((names) => list(names).filter((n) => motion.seriesByName.has(n))).filter((names) => names.length);
  for (const names of wanted.length ? wanted : fallbackPlots(motion)) board.add(names);
} else if (!list(payload.views).some((view) => view.place === "board")) {
  byId("board").hidden = true;
  document.body.classList.add("single");
}
bindKeys(player, scene);
preparePrint();
setTheme(Theme.name);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (e) => setTheme(e.matches ? "dark" : "light"));
player.seek(motion.start);

window.dalembert = { player, motion, scene, board, choice: choosing };
if (motion.moves && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
