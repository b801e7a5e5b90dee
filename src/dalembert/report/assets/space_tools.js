// Controls that only a drawing in space has: directions of view, see-through, section.

function buildSpaceTools(scene, toolbar) {
  const [zoom, view] = [byId("zoom"), byId("view")];
  const see = [["x", "along x (1)"], ["y", "along y (2)"], ["z", "along z (3)"]];
  zoom.append(...see.map(([axis, what]) => el("button", { type: "button", class: "icon axis", id: `look-${axis}`, title: `Look ${what}`, "aria-label": `Look ${what}`, onclick: () => scene.look(axis) }, axis)),
    el("button", { type: "button", class: "icon axis", id: "look-all", title: "Oblique view from above (4)", "aria-label": "Oblique view from above", onclick: () => scene.look(null) }, "3D"));
  const box = sectionBox(scene);
  view.append(box.node);
  const inertia = scene.motion.bodies.some((body) => body.shapes.some((s) => s.kind === "ellipsoid"));
  if (inertia) toolbar.append(toggleButton("Inertia", true, (on) => scene.showInertia(on), { id: "inertia", title: "Inertia ellipsoids of bodies without a shape" }));
  toolbar.append(
    toggleButton("See-through", false, (on) => scene.setClear(on), { id: "clear", title: "Transparent bodies" }),
    toggleButton("Section", false, (on) => box.show(on), { id: "section", title: "Cut through the bodies" }));
}

// Where the section lies: along which axis, how far, which side is left out.
function sectionBox(scene) {
  const axis = el("select", { id: "section-axis", "aria-label": "Axis of the section" }, Object.keys(AXES).map((a) => el("option", { value: a }, a)));
  const place = el("input", { type: "range", min: "-1", max: "1", step: "0.005", value: "0", id: "section-place", "aria-label": "Position of the section" });
  const flip = toggleButton("Other side", false, () => update(), { id: "section-flip" });
  const node = el("div", { class: "section-box", hidden: true }, el("span", { class: "caption" }, "Section along"), axis, el("div", { class: "track" }, place), flip);
  const update = () => {
    place.style.setProperty("--p", (place.valueAsNumber + 1) / 2);
    scene.setSection(node.hidden ? null : axis.value, place.valueAsNumber, flip.getAttribute("aria-pressed") === "true");
  };
  axis.addEventListener("change", update);
  place.addEventListener("input", update);
  return { node, show: (on) => { node.hidden = !on; update(); } };
}
