"""A spatial structure is drawn in the studio from nothing, by typed numbers and clicks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from browser import browser  # noqa: F401
from studio_desk import opened, reset
from studio_runs import Studio
from test_studio_space import SpaceDesk

import dalembert as da
from dalembert.io import load_model_file

COVERED = """(() => {
    const box = (node) => node.getBoundingClientRect();
    const panel = box([...document.querySelectorAll('.properties')].find((node) => !node.hidden));
    const drawing = box(studio.pictures.frame);
    return panel.left < drawing.right && panel.width > 0;
})()"""
INSIDE = """(() => {
    const { view, canvas } = studio.pictures.page.scene, [u, v] = view.screen([0, 0, 7]);
    return u > 0 && v > 0 && u < canvas.clientWidth && v < canvas.clientHeight;
})()"""


class FrameDesk(SpaceDesk):
    """Page of a studio with a spatial structure."""

    def typed(self, text: str) -> None:
        """Type a value and await its picture; the picture does not have the focus."""
        self.page.keyboard.type(text)
        self.changed(lambda: self.page.keyboard.press("Enter"))

    def use(self, key: str, *place: float, typed: str) -> None:
        """Use a tool on a node, with a typed value."""
        self.page.keyboard.press(key)
        self.click(*place)
        self.typed(typed)


@pytest.fixture(scope="module")
def desk(browser: Any, still_server: Studio) -> Any:  # noqa: F811
    """A page with a new spatial structure."""
    reset(still_server, structure=True, dimension=3)
    with opened(browser, still_server, "0", (1300, 800), FrameDesk) as visit:
        visit.until("document.documentElement.dataset.structure === 'true'", 20)
        yield visit


@pytest.mark.thorough
def test_a_cantilever_with_two_loads_and_a_torque(desk: FrameDesk, tmp_path: Path) -> None:
    """Displacements are F L³/(3 E I) along both axes; the rotation is T L/(G J)."""
    keyboard = desk.page.keyboard
    desk.js("document.activeElement?.blur()")
    keyboard.press("e")
    keyboard.type("0, 0, 0")
    keyboard.press("Enter")
    desk.typed("0, 0, 7")  # digits are keys of the picture of a mechanism
    keyboard.press("Escape")
    assert desk.document["nodes"] == {"n1": [0, 0, 0], "n2": [0, 0, 7]}
    assert desk.js(INSIDE)  # the view follows what is typed outside it
    desk.draw("c", (0, 0, 0))
    desk.use("f", 0, 0, 7, typed="12, 0, 0")
    desk.use("f", 0, 0, 7, typed="0, -3.5, 0")
    desk.use("q", 0, 0, 7, typed="24 Nm")
    path = tmp_path / "drawn.toml"
    path.write_text(desk.text, encoding="utf-8")
    result = da.solve_statics(load_model_file(path).model())
    beam = desk.document["elements"]["beam1"]
    bending = 7.0**3 / (3 * beam["modulus"])
    about_x, about_y = beam["second_moment_y"], beam["second_moment_z"]
    assert about_x == about_y  # a square tube
    assert float(result["n2.ux"]) == pytest.approx(12 * bending / about_y, rel=1e-9)
    assert float(result["n2.uy"]) == pytest.approx(-3.5 * bending / about_x, rel=1e-9)
    twist = 24 * 7.0 / (beam["shear_modulus"] * beam["torsion_constant"])
    assert float(result["n2.rz"]) == pytest.approx(twist, rel=1e-9)
    shown = desk.js("studio.pictures.page.motion.symbols.filter((s) => s.moment).length")
    assert shown == 1  # the moment is in the picture


@pytest.mark.thorough
def test_a_node_is_moved_deleted_and_restored(desk: FrameDesk) -> None:
    before = desk.text
    desk.page.keyboard.press("Escape")
    desk.page.keyboard.press("Escape")
    desk.click(0, 0, 7)
    assert not desk.js(COVERED)  # properties are beside the drawing
    field = desk.page.locator(".properties input[aria-label=z]")
    field.fill("6 m")
    desk.changed(lambda: field.press("Enter"))
    assert desk.document["nodes"]["n2"][2] == "6 m"
    desk.press("Control+z")
    desk.js("studio.spaceStructure.select([{ section: 'points', name: 'n2' }])")
    desk.js("document.activeElement?.blur()")
    desk.press("Delete")
    assert "elements" not in desk.document or not desk.document["elements"]
    desk.press("Control+z")
    assert desk.text == before


SOLID = """format = 1
kind = "structure"
supports = [{ nodes = "block", where = { x = 0.0 } }]
tractions = [{ elements = "block", nodes = "block", where = { x = 1.0 }, tz = -1e5 }]

[meshes.block]
type = "Hexahedron20"
box = { size = [1.0, 0.1, 0.1], counts = [4, 1, 1] }
modulus = 210e9
"""


def test_a_solid_without_nodes_is_a_spatial_structure(desk: FrameDesk) -> None:
    """Beams are drawn beside it; its stresses are those at the centres of its elements."""
    desk.js("studio.spaceStructure.choose('select')")
    desk.page.evaluate("text => { studio.editor.show(text); studio.sendText(text); }", SOLID)
    desk.until("studio.pictures.page.motion.mesh?.faces.length", 60)
    desk.until("studio.spaceStructure.possible", 20)
    assert "whose arrows move it" in desk.js("document.getElementById('hint').textContent")
    legend = "studio.pictures.frame.contentDocument.querySelector('.ramp-box').innerText"
    assert desk.js(legend).startswith("von mises\nat element centres")
    frame = desk.page.frame_locator("#canvas iframe:not(.loading)")
    frame.locator("#field").select_option(label="displacement")
    assert "centres" not in desk.js(legend)
    desk.page.locator("#canvas").focus()
    desk.page.keyboard.press("e")
    for place in ("0, 0, 0.5", "1, 0, 0.5"):
        desk.page.keyboard.type(place)
        desk.page.keyboard.press("Enter")
    desk.until("Object.keys(studio.file.document?.elements ?? {}).length === 1", 20)
    assert desk.document["nodes"] == {"n1": [0, 0, 0.5], "n2": [1, 0, 0.5]}


@pytest.mark.thorough
def test_nodes_of_a_solid_are_supported_and_loaded_by_clicks(
    desk: FrameDesk, tmp_path: Path
) -> None:
    """Reactions balance the clicked force; a support elsewhere stays, and a moment is refused."""
    desk.page.evaluate("text => { studio.editor.show(text); studio.sendText(text); }", SOLID)
    desk.until("studio.spaceStructure.possible && studio.spaceStructure.plan.solidNodes.length", 60)
    desk.settle()
    desk.js("studio.pictures.page.scene.fit()")
    desk.draw("r", (1, 0, 0))
    desk.use("f", 1, 0.1, 0.1, typed="0, 300, -5 kN")
    text = desk.text
    assert desk.document["supports"] == [
        {"nodes": "block", "where": {"x": 0}},
        {"nodes": "block", "nearest": [1, 0, 0], "uz": 0},
    ]
    load = {"nodes": "block", "nearest": [1, 0.1, 0.1], "fy": 300, "fz": -5000}
    assert desk.document["loads"] == [load]
    desk.page.keyboard.press("q")
    desk.click(1, 0.1, 0.1)
    assert "has no rotation" in desk.js("document.getElementById('notice').textContent")
    assert desk.text == text
    path = tmp_path / "solid.toml"
    path.write_text(text.replace("tz = -1e5", "tz = 0.0"), encoding="utf-8")
    (state,) = da.solve_statics(load_model_file(path).model()).summary()["states"]
    reactions = state["sum of reactions"]
    assert [reactions[f"f{x}"] for x in "xyz"] == pytest.approx([0, -300, 5000], abs=1e-5)
