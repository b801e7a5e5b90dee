# ruff: noqa: F811
"""Parts of structures in the studio: types of elements, sections, rollers, heat, the crosshair."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import pytest
from browser import browser  # noqa: F401
from structure_desk import NEW, desk, page, solved, start, use  # noqa: F401
from studio_desk import Desk


def data(visit: Desk) -> dict[str, Any]:
    return tomllib.loads(visit.text)


def choose(visit: Desk, label: str, value: str) -> None:
    """A choice of the panel of properties."""
    revision = visit.js("studio.file.revision")
    visit.page.select_option(f".properties select[aria-label='{label}']", value)
    visit.until(f"studio.file.revision > {revision} && !studio.pending", 20)


@pytest.mark.thorough
def test_an_inclined_roller(desk: Desk, tmp_path: Path) -> None:
    """Beam with a load in the middle; the roller at the right end rolls along a line of 30°.

    Moments about the left end: N cos 30° L = P L / 2, and the pin takes N sin 30° along x.
    """
    use(desk, "e", [(0, 0.5), (1, 0.5), (2, 0.5)], "", "Escape", shown=False)
    use(desk, "o", [(0, 0.5)], shown=False)
    rolls = (2 + 0.5 * math.cos(math.pi / 6), 0.5 + 0.5 * math.sin(math.pi / 6))
    use(desk, "r", [(2, 0.5), rolls], shown=False)
    use(desk, "f", [(1, 0.5)], "6 kN<-90", "Enter")
    model = data(desk)
    link = model["elements"]["link1"]
    assert link["type"] == "AxialSpring"
    end, foot = (model["nodes"][name] for name in link["connect"])
    normal = math.atan2(end[1] - foot[1], end[0] - foot[0])
    assert normal == pytest.approx(math.radians(120), abs=1e-6)
    result = solved(desk.text, tmp_path)
    pin = next(name for name, place in model["nodes"].items() if place == [0, 0.5])
    reaction = 3e3 / math.cos(math.pi / 6)
    assert float(result["link1.force"]) == pytest.approx(-reaction, rel=1e-6)
    assert float(result[f"{pin}.fx"]) == pytest.approx(reaction / 2, rel=1e-6)
    assert float(result[f"{pin}.fy"]) == pytest.approx(3e3, rel=1e-6)
    u = [float(result[f"{link['connect'][0]}.{d}"]) for d in ("ux", "uy")]
    across = u[0] * math.cos(normal) + u[1] * math.sin(normal)
    assert abs(across) < 1e-5 * math.hypot(*u)  # it rolls


@pytest.mark.thorough
def test_types_and_sections_of_beams(desk: Desk, tmp_path: Path) -> None:
    """Cantilever under a line load: w = q L⁴/(8 E I) + q L²/(2 G A), by Timoshenko; then others."""
    desk.page.locator("#structure-palette [data-tool=beam]").click()
    desk.page.select_option("#structure-beam", "TimoshenkoFrame")
    desk.page.select_option("#structure-section", "Timber 100 × 200")
    desk.page.select_option("#structure-material", "Timber")
    use(desk, "e", [(0, 0.5), (1, 0.5)], "", "Escape", shown=False)
    use(desk, "c", [(0, 0.5)], shown=False)
    use(desk, "f", [(0.5, 0.5)], "0, -2 kN", "Enter", shown=False)
    q, length = 2e3, 1.0

    def sag(text: str) -> float:
        beam = tomllib.loads(text)["elements"]["beam1"]
        return -float(solved(text, tmp_path)[f"{beam['connect'][1]}.uy"])

    beam = data(desk)["elements"]["beam1"]
    assert beam["second_moment"] == pytest.approx(0.1 * 0.2**3 / 12, rel=1e-4)
    assert beam["shear_area"] == pytest.approx(5 / 6 * 0.02, rel=1e-4)
    bending = q * length**4 / (8 * beam["modulus"] * beam["second_moment"])
    shear = q * length**2 / (2 * beam["shear_modulus"] * beam["shear_area"])
    assert sag(desk.text) == pytest.approx(bending + shear, rel=1e-9)
    timoshenko = beam
    desk.page.keyboard.press("v")
    desk.click(0.5, 0.5)
    choose(desk, "element", "Frame")
    beam = data(desk)["elements"]["beam1"]
    assert set(timoshenko) - set(beam) == {"shear_modulus", "shear_area"}
    assert sag(desk.text) == pytest.approx(bending, rel=1e-9)
    choose(desk, "element", "TimoshenkoFrame")
    assert data(desk)["elements"]["beam1"] == timoshenko  # as it was
    choose(desk, "cross-section", "IPE 200")
    choose(desk, "material", "Steel")
    beam = data(desk)["elements"]["beam1"]
    assert (beam["area"], beam["second_moment"], beam["modulus"]) == (28.5e-4, 1943e-8, 210e9)
    assert beam["shear_modulus"] == pytest.approx(210e9 / 2.6, rel=1e-4)
    choose(desk, "element", "Truss")
    beam = data(desk)["elements"]["beam1"]
    assert set(beam) == {"type", "connect", "area", "modulus", "density"}


@pytest.mark.thorough
def test_heat_and_typed_moments(desk: Desk, tmp_path: Path) -> None:
    """A bar between two pins: σ = −E α ΔT. A typed moment keeps its sign."""
    use(desk, "e", [(0, 0.5), (2, 0.5)], "", "Escape", shown=False)
    use(desk, "o", [], "0,0.5", "Enter", shown=False)  # the palette has the focus
    desk.page.locator("#canvas").focus()
    revision = desk.js("studio.file.revision")
    desk.page.keyboard.type("2,0.5")
    desk.page.keyboard.press("Enter")
    desk.until(f"studio.file.revision > {revision} && !studio.pending", 20)
    desk.page.keyboard.press("f")
    for typed in ("2,0.5", "5 kN<-90"):  # a space is no click
        desk.page.keyboard.type(typed)
        desk.page.keyboard.press("Enter")
    desk.until("studio.file.document.loads && !studio.pending", 20)
    assert data(desk)["loads"] == [{"nodes": "n2", "fx": 0, "fy": -5000}]
    desk.press("Control+z")
    use(desk, "t", [(1, 0.5)], "40 K", "Enter", shown=False)
    model = data(desk)
    beam = model["elements"]["beam1"]
    assert model["temperatures"] == [{"elements": "beam1", "temperature": 40}]
    stress = float(solved(desk.text, tmp_path)["beam1.stress"])
    assert stress == pytest.approx(-beam["modulus"] * beam["expansion"] * 40, rel=1e-9)
    desk.page.locator("#structure-palette button").first.focus()
    desk.page.keyboard.press("q")
    for place, typed in (((0, 0.5), "2 kNm"), ((2, 0.5), "-3 kNm")):
        revision = desk.js("studio.file.revision")
        desk.click(*place)
        desk.page.mouse.move(*desk.place(place[0] - 0.3, 0.6))
        desk.page.keyboard.type(typed)
        desk.page.keyboard.press("Enter")
        desk.until(f"studio.file.revision > {revision} && !studio.pending", 20)
    assert [load["mz"] for load in data(desk)["loads"]] == [2e3, -3e3]


PLATE = """format = 1
kind = "structure"

[meshes.plate]
type = "Triangle6"
thickness = 0.01
modulus = 2.1e11

[meshes.plate.polygon]
size = 0.2
vertices = [[0, 0], [2, 0], [2, 0.8], [0, 0.8]]
holes = [
  { center = [0.5, 0.4], radius = 0.1 },  # of the bolt
]
"""


@pytest.mark.thorough
def test_holes_keep_comments_and_regions_their_type(desk: Desk) -> None:
    start(desk, PLATE)
    use(desk, "h", [(1, 0.4), (1.1, 0.4)], shown=False)
    holes = data(desk)["meshes"]["plate"]["polygon"]["holes"]
    assert holes[1] == {"center": [1, 0.4], "radius": pytest.approx(0.1)}
    assert "  # of the bolt\n" in desk.text
    desk.page.keyboard.press("v")
    desk.click(0.7, 0.7)
    choose(desk, "elements", "Triangle")
    assert data(desk)["meshes"]["plate"]["type"] == "Triangle"


@pytest.mark.thorough
def test_a_crosshair_draws_a_structure(desk: Desk) -> None:
    """A bar between two places of the grid, without a mouse."""
    keys = desk.page.keyboard
    desk.page.locator("#canvas").focus()
    step = desk.js("import('./assets/snapping.js').then((m) => m.gridStep(190))")
    keys.press("b")
    keys.press("Enter")
    first = desk.js("studio.crosshair.at")
    for key in ("ArrowRight", "ArrowRight", "ArrowUp"):
        keys.press(key)
    revision = desk.js("studio.file.revision")
    keys.press("Enter")
    desk.until(f"studio.file.revision > {revision} && !studio.pending", 20)
    nodes = list(data(desk)["nodes"].values())
    second = [first[0] + 2 * step, first[1] + step]
    assert nodes == [pytest.approx(first), pytest.approx(second)]
