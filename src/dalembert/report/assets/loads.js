// Arrows of loads, in the plane and in space: which kinds there are, how long each kind is drawn, what it reads.

const LOADS = {
  force: { name: "Reaction forces", unit: "N", reaction: true },
  moment: { name: "Reaction moments", unit: "N·m", reaction: true },
  load: { name: "Applied forces", unit: "N", reaction: false },
  twist: { name: "Applied moments", unit: "N·m", reaction: false },
};
const LENGTHS = 1.5;  // decades that a slider makes arrows longer, or shorter

const newSizes = () => Object.fromEntries(Object.keys(LOADS).map((kind) => [kind, 1]));
const loadText = (kind, value) => inUnits([value], LOADS[kind].unit.replace("·", " "), { digits: 3 });
const READABLE = 16;  // loads of one kind up to which each is labelled with its value

// A slider for each kind of arrow there is.
function arrowMenu(scene) {
  const kinds = Object.keys(LOADS).filter((kind) => scene.greatest[kind] > 0);
  if (!kinds.length) return null;
  const rows = kinds.map((kind) => {
    const { name } = LOADS[kind];
    const slider = el("input", { type: "range", min: String(-LENGTHS), max: String(LENGTHS), step: "0.01", value: "0", id: `arrows-${kind}`, "aria-label": `Length of the arrows of ${name.toLowerCase()}`,
      oninput: () => {
        scene.sizes[kind] = 10 ** slider.valueAsNumber;
        slider.style.setProperty("--p", (slider.valueAsNumber + LENGTHS) / (2 * LENGTHS));
        slider.setAttribute("aria-valuetext", `${number(scene.sizes[kind], 2)} times`);
        scene.invalidate();
      } });
    slider.style.setProperty("--p", 0.5);
    return el("label", { class: "menu-row" }, el("span", {}, name, el("small", {}, ` up to ${loadText(kind, scene.greatest[kind])}`)), el("div", { class: "track short" }, slider));
  });
  return menu("Arrows", rows, { id: "arrows", title: "Lengths of the arrows" });
}

// A button that opens a few controls below it; Escape and a click elsewhere close it.
function menu(name, rows, more = {}) {
  const { class: look = "chip", "aria-label": label, title, ...rest } = more;
  const box = el("details", { ...rest, class: "menu", "aria-label": `Menu: ${label ?? (typeof name === "string" ? name : title)}` }, el("summary", { class: look, "aria-label": label, title }, name), el("div", { class: "menu-box card" }, rows));
  box.addEventListener("keydown", (e) => { if (e.key === "Escape" && box.open) { box.open = false; box.firstChild.focus(); } });
  box.addEventListener("click", (e) => { if (e.target.closest(".menu-item") && !e.target.closest("#save-film")) box.open = false; });
  document.addEventListener("pointerdown", (e) => { if (!box.contains(e.target)) box.open = false; });
  return box;
}
