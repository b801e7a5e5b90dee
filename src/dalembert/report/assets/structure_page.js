// Puts the page of a structure together.

const byId = (id) => document.getElementById(id);
if (begun) Object.assign(payload, begun);
byId("subtitle").textContent = payload.subtitle || "";
byId("subtitle").hidden = !payload.subtitle;

Theme.read();
const structure = new Structure(payload);
const scene = new StructureScene(structure, byId("scene"), byId("tip"));

function choice(id, label, names, chosen, onchange) {
  const select = el("select", { id, onchange: () => onchange(Number(select.value)) }, names.map((name, k) => el("option", { value: String(k) }, name)));
  select.value = String(chosen);
  return el("label", { class: "chooser" }, el("span", { class: "caption" }, label), select);
}

function buildToolbar() {
  const choosers = [];
  const label = structure.kindOfState === "load case" ? "Case" : structure.kindOfState[0].toUpperCase() + structure.kindOfState.slice(1);
  if (structure.cases.length > 1 && !structure.sequence) choosers.push(choice("case", label, structure.cases, 0, (k) => structure.set({ case: k })));
  const names = ["none", ...structure.fields.map((f) => f.name.replaceAll("_", " "))];
  const usual = structure.relative ? ["shape"] : ["von_mises", "stress", "force"];
  const first = structure.fields.findIndex((f) => usual.includes(f.name));
  structure.state.field = structure.fields[Math.max(first, 0)] || null;
  choosers.push(choice("field", "Colours", names, Math.max(first, 0) + 1, (k) => structure.set({ field: k ? structure.fields[k - 1] : null })));
  const toggle = (key, text, title) => toggleButton(text, scene.show[key], (on) => { scene.show[key] = on; scene.invalidate(); }, { id: `show-${key}`, title });
  scene.show.labels = structure.nodes.length <= 12;
  const chips = [toggle("rest", "Undeformed"), toggle("loads", "Loads"), toggle("supports", "Supports"), toggle("labels", "Names")];
  if (structure.ghost) chips.unshift(toggle("ghost", payload.other ? `Other run: ${payload.other}` : "First design"));
  const members = structure.lines.reduce((sum, s) => sum + s.owners.length, 0);
  if (members && members <= FEW_MEMBERS && structure.fields.some((f) => !f.atVertices)) chips.push(toggle("values", "Values", "Values of the members"));
  if (structure.faces.length) chips.push(toggle("mesh", "Mesh"));
  byId("toolbar").append(el("div", { class: "chips" }, choosers), el("div", { class: "chips" }, chips));
}

// A slider that shows how far it is.
function slider(id, label, max, step, oninput) {
  const input = el("input", { type: "range", min: "0", max: String(max), step: String(step), value: "0", id, "aria-label": label });
  input.addEventListener("input", () => oninput(Number(input.value)));
  const show = (value, text) => {
    input.value = String(value);
    input.style.setProperty("--p", clamp(value / max, 0, 1));
    input.setAttribute("aria-valuetext", text);
  };
  return { node: el("div", { class: "track" }, input), show };
}

// The scale of the displacements, from none to three times what shows well.
function buildScale() {
  const told = el("span", { class: "now", id: "factor" });
  const track = slider("scale", "Scale of the displacements", 3, 0.01, (factor) => structure.set({ factor }));
  structure.onState.on(() => {
    const { factor } = structure.state;
    told.textContent = structure.relative ? `up to ${metres(factor * structure.scale)}` : `× ${+(factor * structure.scale).toPrecision(3)}`;
    track.show(Math.min(3, factor), told.textContent);
  });
  const chip = (id, text, title, factor) => el("button", { type: "button", class: "chip", id, title, onclick: () => structure.set({ factor: factor() }) }, text);
  return [el("span", { class: "caption" }, "Displacements"), track.node, told,
    ...(structure.relative ? [] : [chip("true-scale", "1 : 1", "True scale", () => 1 / structure.scale)]),
    chip("auto-scale", "auto", "Automatic scale", () => AUTO)];
}

// The states one after the other.
function buildSteps() {
  const last = structure.cases.length - 1;
  const told = el("span", { class: "now", id: "state" });
  const track = slider("step", structure.kindOfState, last, 1, (k) => structure.set({ case: k }));
  structure.onState.on(() => {
    told.textContent = structure.cases[structure.state.case];
    track.show(structure.state.case, told.textContent);
  });
  return [track.node, told];
}

// Runs through the states in six seconds, or swings between rest and the displaced place.
function buildPlay() {
  let began = null;
  const last = structure.cases.length - 1;
  const show = (seconds) => {
    if (structure.sequence) structure.set({ case: Math.floor((seconds / 6) * (last + 1)) % (last + 1) });
    else scene.share = Math.sin((TAU * seconds) / 2.4);
    scene.invalidate();
  };
  const tick = (now) => {
    if (began === null) return;
    show(Math.max(0, now - began) / 1000);
    requestAnimationFrame(tick);
  };
  const toggle = () => {
    began = began !== null ? null : performance.now() - (structure.sequence && structure.state.case < last ? (6000 * structure.state.case) / (last + 1) : 0);
    play.replaceChildren(icon(began === null ? "play" : "pause"));
    scene.share = 1;
    scene.invalidate();
    if (began !== null) requestAnimationFrame(tick);
  };
  const play = iconButton("play", structure.sequence ? "Play (space)" : "Animate (space)", () => toggle(), { id: "play", class: "icon primary" });
  return { play, toggle };
}

function buildPlayer() {
  const { play, toggle } = buildPlay();
  byId("player").append(play, ...(structure.sequence ? buildSteps() : []), ...buildScale());
  byId("player").hidden = false;
  return { toggle };
}

// The colours and what they stand for.
function buildBar() {
  const bar = el("canvas", { class: "ramp", width: 1, height: 256 });
  const marks = el("div", { class: "ramp-marks" });
  const name = el("span", { class: "ramp-name" });
  const node = el("div", { class: "ramp-box", id: "colours" }, name, el("div", { class: "ramp-row" }, bar, marks));
  byId("view").append(node);
  scene.beside = node;
  structure.onState.on(() => {
    const { field } = structure;
    node.hidden = !field;
    if (!field) return;
    const [lo, hi] = structure.range(field);
    const ramp = new Ramp([lo, hi]);
    const ctx = bar.getContext("2d");
    ramp.steps.forEach((colour, k) => { ctx.fillStyle = colour; ctx.fillRect(0, 255 - k, 1, 1); });
    name.textContent = field.name.replaceAll("_", " ");
    marks.replaceChildren(...[hi, (3 * hi + lo) / 4, (lo + hi) / 2, (hi + 3 * lo) / 4, lo].map((v) => el("span", {}, quantity(Math.abs(v) < 1e-12 * (hi - lo) ? 0 : v, field.unit, 3))));
  });
}

function buildFrame() {
  byId("zoom").append(
    iconButton("plus", "Zoom in (+)", () => scene.zoom(1.25)),
    iconButton("minus", "Zoom out (−)", () => scene.zoom(0.8)),
    iconButton("fit", "Fit (F)", () => scene.fit(), { id: "fit" }));
  byId("tools").append(
    shareMenu(scene, structure, null),
    iconButton("theme", "Light or dark", () => setTheme(Theme.name === "dark" ? "light" : "dark"), { id: "theme" }),
    iconButton("print", "Print", () => window.print()));
  byId("stage").setAttribute("aria-label", "Structure");
  byId("scene").setAttribute("aria-label", `Drawing of ${structure.title}: ${structure.nodes.length} nodes, ${structure.elements.length} elements. Wheel zooms, drag ${structure.solid ? "rotates, with shift pans" : "pans"}.`);
  const hints = [["Space", structure.sequence ? "play" : "animate"], ["F", "fit"], ["+ −", "zoom"], ...(structure.solid ? [["Shift", "pan"]] : [])];
  byId("footer").append(
    el("span", {}, "Made with dalembert. Values without a unit are in SI units."),
    el("span", { class: "keys" }, hints.map(([key, what]) => [el("kbd", {}, key), ` ${what} `])));
}

function buildPanels() {
  const statistics = payload.designs ? [] : list(payload.statistics), below = viewPanels(false), beside = viewPanels(true);
  byId("panels").append(...below.filter((node) => node.classList.contains("wide")));
  const columns = [
    [optimumPanel(payload.optimum), ...half(below, 0), diagnosisPanel(payload.diagnosis), payload.optimum || payload.designs ? null : parameterPanel(payload.parameters)],
    [convergencePanel(payload.optimum), ...half(below, 1), statistics.length ? panel("Statistics", "statistics", pairs(statistics)) : null],
  ].map((column) => column.filter(Boolean)).filter((column) => column.length);
  byId("panels").append(...columns.map((column) => el("div", { class: "column" }, column)));
  byId("board").setAttribute("aria-label", "Tables");
  if (beside.length) byId("board").append(el("div", { class: "beside" }, beside));
  byId("board").append(el("div", { class: "tables" }, structureTables(structure)));
  verdict(byId("verdict"), payload.diagnosis);
  decisionVerdict(byId("verdict"));
}

// The cards of one of two columns; wide ones stand over both.
const half = (cards, side) => cards.filter((node) => !node.classList.contains("wide")).filter((_, k) => k % 2 === side);

// Another design is shown in place of this one.
function showDesign(k) {
  const next = choosing.alternatives[k];
  if (!next?.scene) return;
  history.replaceState(null, "", `#design=${k}`);
  const { onState, state } = structure, field = state.field?.name;
  Object.assign(structure, new Structure({ ...payload, ...next }), { onState, state });
  state.case = Math.min(state.case, structure.cases.length - 1);
  structure.set({ field: structure.fields.find((f) => f.name === field) ?? null });
}
choosing?.onChoose.on(showDesign);

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  Theme.read();
  scene.restyle();
  Theme.listeners.emit();
}

function bindStructureKeys(player) {
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || e.target.closest("input, select, button, summary, dialog")) return;
    const actions = { " ": () => player.toggle(), f: () => scene.fit(), "+": () => scene.zoom(1.25), "-": () => scene.zoom(0.8) };
    const action = actions[e.key.toLowerCase()];
    if (!action) return;
    e.preventDefault();
    action();
  });
}

// On paper: light, sharp, and drawn in the size of the sheet.
function prepareStructurePrint() {
  let before = null;
  const redraw = (paper, theme) => {
    document.documentElement.classList.toggle("paper", paper);
    scene.ratio = paper ? 3 : undefined;
    setTheme(theme);
    scene.resize();
    scene.draw();
  };
  window.addEventListener("beforeprint", () => { before ??= Theme.name; redraw(true, "light"); });
  window.addEventListener("afterprint", () => { redraw(false, before || Theme.name); before = null; });
}

buildToolbar();
buildBar();
buildFrame();
buildPanels();
const player = buildPlayer();
bindStructureKeys(player);
prepareStructurePrint();
setTheme(Theme.name);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (e) => setTheme(e.matches ? "dark" : "light"));
structure.set({});
scene.fit();

window.dalembert = { structure, scene, player, choice: choosing };
