"""Editing of drawn elements: what is moved, mirrored or copied moves as the original does."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_tools import CRANK, HEADER

import dalembert as da
from dalembert.io import load_model_file

MECHANISM = (
    HEADER
    + """
[parameters]
l = { value = 0.3, bounds = [0.2, 0.4] }  # of the crank

[bodies]
crank = { type = "Bar", length = "l", mass = 1, position = [0.15, 0.1], angle = 0.1 }
rod = { type = "Bar", length = 0.5, mass = 1, position = [0.55, 0.2], angle = 0.4 }
block = { mass = 1, inertia = 0.1, position = [0.8, 0], angle = 0.2, points = { P = [0.1, 0.05] } }

[joints]
A = { type = "Revolute", connect = [{ body = "ground", at = [0, 0.1] }, "crank.start"] }
B = { type = "Revolute", connect = ["crank.end", "rod.start"] }
C = { type = "Revolute", connect = ["rod.end", "block.P"] }
guide = { type = "Prismatic", connect = [{ body = "ground", at = [0.7, 0] }, "block"], angle = 0.2 }

[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "crank"], law = "0.1 + 2*t" }
"""
)
ALL = '["crank", "rod", "block"]'


def points(text: str, path: Path, names: list[str]) -> np.ndarray:
    """Positions of points over time: shape (points, 2, instants)."""
    path.write_text(text)
    motion = da.solve_kinematics(load_model_file(path).model(), 1.0, outputs=6)
    return np.array([[motion[f"{name}.{axis}"].values for axis in "xy"] for name in names])


def change(visit: Desk, script: str) -> str:
    """Text after a change of the selection."""
    revision = visit.js("studio.file.revision")
    visit.js(script)
    visit.settle(revision + 1)
    assert not visit.errors_shown(), visit.errors_shown()
    return visit.text


POINTS = ["crank.start", "rod.start", "rod.end", "block.P", "block"]
MAPS = {
    "r": lambda x, y, c: (
        c[0] + np.cos(np.pi / 12) * (x - c[0]) - np.sin(np.pi / 12) * (y - c[1]),
        c[1] + np.sin(np.pi / 12) * (x - c[0]) + np.cos(np.pi / 12) * (y - c[1]),
    ),
    "h": lambda x, y, c: (2 * c[0] - x, y),
    "H": lambda x, y, c: (x, 2 * c[1] - y),
    "ArrowUp": lambda x, y, c: (x, y + c[2]),
}


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.mark.thorough
def test_a_transformed_mechanism_moves_as_the_original(
    desk: tuple[Desk, Studio],
    tmp_path: Path,
) -> None:
    visit, _ = desk
    original = points(MECHANISM, tmp_path / "a.toml", POINTS)
    visit.show(MECHANISM)
    visit.js(
        """(async () => {
            const load = name => import(new URL(`assets/${name}.js`, location));
            [window.selection, window.snapping] = [await load("selection"), await load("snapping")];
        })()"""
    )
    for key, image in MAPS.items():
        visit.js(f"studio.drawing.rest(); studio.drawing.select({ALL})")
        box = visit.js("selection.bounds(studio.pictures.page, studio.drawing.selection)")
        step = visit.js("snapping.gridStep(studio.pictures.page.scene.view.s)")
        visit.page.locator("#palette button").first.focus()
        visit.press(key)
        text = visit.text
        moved = points(text, tmp_path / "b.toml", POINTS)
        wanted = np.array([image(x, y, (box["x"], box["y"], step)) for x, y in original])
        assert moved == pytest.approx(wanted, abs=1e-6), key
        assert "# of the crank" in text and 'length = "l"' in text
        visit.press("Control+z")
        assert visit.text == MECHANISM


@pytest.mark.thorough
def test_a_copy_has_the_joints_between_its_parts(
    desk: tuple[Desk, Studio],
    tmp_path: Path,
) -> None:
    visit, _ = desk
    visit.show(MECHANISM)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("Control+a")
    visit.press("Control+d")
    text = visit.text
    data = tomllib.loads(text)
    assert set(data["joints"]) == {"A", "B", "C", "guide", "D", "E", "F", "guide1"}
    assert data["joints"]["E"]["connect"] == ["crank1.end", "rod1.start"]
    assert data["bodies"]["crank1"]["length"] == "l"
    names = ["crank1.start", "rod1.end", "block1"]
    both = points(text, tmp_path / "c.toml", ["crank.start", "rod.end", "block", *names])
    offset = (both[3:] - both[:3]).reshape(3, 2, -1)
    assert offset == pytest.approx(np.broadcast_to(offset[:1, :, :1], offset.shape), abs=1e-6)
    visit.press("Control+z")
    assert visit.text == MECHANISM


@pytest.mark.thorough
def test_bodies_are_dragged_and_their_neighbours_follow(
    desk: tuple[Desk, Studio],
) -> None:
    visit, _ = desk
    text = CRANK + 'B = { type = "Revolute", connect = ["crank.end", "rod.start"] }\n'
    visit.show(text)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("v")
    visit.page.mouse.move(*visit.place(0.6, 0.2))
    visit.page.mouse.down()
    visit.page.mouse.move(*visit.place(0.6, 0.5), steps=4)
    revision = visit.js("studio.file.revision")
    visit.page.mouse.up()
    visit.settle(revision + 1)
    bodies = visit.js("studio.file.document.bodies")
    assert bodies["rod"]["position"] == pytest.approx([0.6, 0.5])
    assert bodies["rod"]["length"] == 0.4
    assert bodies["crank"]["length"] == pytest.approx(0.5)  # from (0, 0.2) to (0.4, 0.5)
    visit.press("Control+z")
    assert visit.text == text


@pytest.mark.thorough
def test_selection_properties_and_names(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(CRANK)
    page = visit.page
    page.locator("#palette button").first.focus()
    page.keyboard.press("v")
    visit.click(0.6, 0.2)
    page.keyboard.down("Shift")
    visit.click(0.2, 0.2)
    page.keyboard.up("Shift")
    assert set(visit.js("[...studio.drawing.selection]")) == {"rod", "crank"}
    page.mouse.move(*visit.place(0.35, 0.4))
    page.mouse.down()
    page.mouse.move(*visit.place(0.9, 0.1), steps=3)
    page.mouse.up()
    assert visit.js("[...studio.drawing.selection]") == ["rod"]

    revision = visit.js("studio.file.revision")
    page.locator(".properties input[aria-label=length]").fill("450 mm")
    page.keyboard.press("Enter")
    visit.settle(revision + 1)
    assert 'rod = { type = "Bar", length = "450 mm"' in visit.text
    page.locator(".properties [aria-label='make mass a parameter']").click()
    visit.settle(revision + 2)
    assert visit.js("studio.file.document.parameters.rod_mass.value") == 1
    visit.page.locator("#palette button").first.focus()
    page.keyboard.press("F2")
    page.locator("#ask input").fill("coupler")
    page.keyboard.press("Enter")
    visit.settle(revision + 3)
    assert "coupler" in visit.js("studio.file.document.bodies")
    visit.until("studio.drawing.selected === 'coupler'", 5)
    for _ in range(3):
        visit.press("Control+z")
    assert visit.text == CRANK
