"""Tools of the studio in a browser: what each draws is a model that can be analysed."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studio_desk import Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

HEADER = 'format = 1\nname = "test"\ngravity = [0.0, -9.81]\n'
CRANK = HEADER + (
    "[bodies]\n"
    'crank = { type = "Bar", length = 0.4, mass = 1, position = [0.2, 0.2], angle = 0 }\n'
    'rod = { type = "Bar", length = 0.4, mass = 1, position = [0.6, 0.2], angle = 0 }\n'
    "[joints]\n"
    'A = { type = "Revolute", connect = [{ body = "ground", at = [0.0, 0.2] }, "crank.start"] }\n'
)
"""A pinned bar from x = 0 to 0.4 and a free one to 0.8, at the height 0.2."""
GUIDED = CRANK + (
    'G = { type = "Prismatic", connect = [{ body = "ground", at = [0.8, 0.2] }, "rod.end"] }\n'
)

TOOLS: dict[str, tuple[str, list[tuple[float, float]], str, str, dict[str, Any]]] = {
    "a": (CRANK, [(0.5, 0.5)], "bodies", "mass1", {"position": [0.5, 0.5]}),
    "e": (CRANK, [(0.1, 0.5), (0.4, 0.2)], "beams", "beam1", {"frame_j": "crank.end"}),
    "t": (CRANK, [(0.5, 0.5)], "ground", "points", {"P1": [0.5, 0.5]}),
    "u": (CRANK, [(0.4, 0.2), (0.6, 0.2), (0.7, 0.2)], "joints", "slot1", {"axis": [1, 0]}),
    "i": (CRANK, [(0.6, 0.2), (0.6, 0.3), (0.6, 0.5)], "joints", "guide1", {"axis": [0, 1]}),
    "w": (CRANK, [(0.8, 0.2)], "joints", "weld1", {"type": "Weld"}),
    "l": (CRANK, [(0.8, 0.2), (0.8, 0.5)], "joints", "link1", {"length": 0.3}),
    "G": (
        CRANK,
        [(0.0, 0.2), (0.0, 0.4), (0.3, 0.4)],
        "joints",
        "rack1",
        {"radius": 0.2, "side": -1, "axis": [1, 0]},
    ),
    "c": (GUIDED, [(0.0, 0.2), (0.8, 0.2)], "joints", "cam1", {"type": "PointOnCurve"}),
    "q": (CRANK, [(0.2, 0.2)], "forces", "torque1", {"connect": ["crank"], "value": 1}),
    "d": (CRANK, [(0.4, 0.2), (0.4, 0.5)], "forces", "damper1", {"damping": 20}),
    "y": (CRANK, [(0.0, 0.2)], "forces", "torsion1", {"connect": ["ground", "crank"]}),
    "j": (CRANK, [(0.4, 0.2), (0.4, 0.5)], "forces", "cylinder1", {"force": 100}),
    "J": (CRANK, [(0.4, 0.2), (0.4, 0.6)], "forces", "hydraulic1", {"stroke": 0.32}),
    "x": (CRANK, [(0.0, 0.2)], "forces", "stop1", {"coordinate": "A.angle", "upper": 1}),
    "n": (GUIDED, [(0.8, 0.2)], "drivers", "drive1", {"joint": "G"}),
    "N": (CRANK, [(0.4, 0.2), (0.4, 0.5)], "drivers", "stroke1", {"type": "DistanceDriver"}),
}
"""Key of a tool → start, clicks, and the section, name and fields of the new entry."""


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.mark.thorough
def test_each_tool_draws_a_model(
    desk: tuple[Desk, Studio],
    tmp_path: Path,
) -> None:
    visit, _ = desk
    receive = "studio.pictures.receive"
    for base in (CRANK, GUIDED):
        visit.show(base)
        visit.js(f"{receive} = () => {{}}")  # the picture stays
        for key, (text, clicks, section, name, fields) in TOOLS.items():
            if text != base:
                continue
            drawn = use(visit, key, clicks)
            entry = tomllib.loads(drawn).get(section, {}).get(name)
            assert entry is not None, (key, drawn)
            for field, value in fields.items():
                numbers = isinstance(value, (int, float, list)) and value != ["crank"]
                if value in (["crank"], ["ground", "crank"]) or not numbers:
                    assert entry[field] == value, (key, field)
                else:
                    assert entry[field] == pytest.approx(value, abs=1e-9), (key, field)
            (tmp_path / "drawn.toml").write_text(drawn)
            assert load_model_file(tmp_path / "drawn.toml").model().diagnosis.summary
            revision = visit.js("studio.file.revision")
            visit.page.keyboard.press("Control+z")
            visit.until(f"studio.file.revision > {revision}", 20)
            assert visit.text == base, key
        visit.js(f"delete {receive}")


def use(visit: Desk, key: str, clicks: list[tuple[float, float]]) -> str:
    """Text after a tool was used, without waiting for its picture."""
    revision = visit.js("studio.file.revision")
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press(key)
    for place in clicks:
        visit.click(*place)
    visit.until(f"studio.file.revision > {revision}", 20)
    return visit.text


@pytest.mark.thorough
def test_gears_ropes_and_contacts(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    pinned = '{ body = "ground", at = [0.8, 0.2] }'
    two = CRANK + f'B = {{ type = "Revolute", connect = [{pinned}, "rod.end"] }}\n'
    visit.show(two)
    visit.draw("g", (0.0, 0.2), (0.8, 0.2), (0.5, 0.2))
    gears = visit.js("studio.file.document.joints.gears1")
    assert (gears["radius_i"], gears["radius_j"]) == pytest.approx((0.5, 0.3))
    assert visit.page.inner_text("#summary") == "1 degree of freedom"
    for start, end in (((0.8, 0.2), (0.8, 0.6)), ((0.0, 0.2), (-0.1, 0.1))):
        before, revision = visit.text, visit.revision
        visit.page.keyboard.press("Escape")
        visit.page.keyboard.press("Escape")
        visit.drag(start, end)
        visit.settle(revision + 1)
        gears = visit.js("studio.file.document.joints.gears1")
        distance = math.dist(end, (0.0, 0.2) if start[0] else (0.8, 0.2))
        assert gears["radius_i"] + gears["radius_j"] == pytest.approx(distance)
        assert gears["radius_i"] / gears["radius_j"] == pytest.approx(5 / 3)
        visit.press("Control+z")
        assert visit.text == before
    visit.show(CRANK)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("z")
    for place in ((0.1, 0.5), (0.4, 0.2), (0.5, 0.5)):
        visit.click(*place)
    visit.press("Enter")
    assert len(visit.js("studio.file.document.forces.rope1.points")) == 3
    assert not visit.errors_shown()
    ball = "[bodies]\nball = { type = 'Particle', mass = 1, position = [0.5, 0.4] }\n"
    visit.show(HEADER + ball)
    visit.draw("C", (0.5, 0.4), (0.5, 0.2))
    assert visit.js("studio.file.document.forces.contact1.shape_i.type") == "HalfPlane"
    assert not visit.errors_shown(), visit.errors_shown()


SLOTTED = HEADER + (
    "[bodies]\n"
    'crank = { type = "Bar", length = 0.2, mass = 1, position = [0.3, 0.3], angle = 0 }\n'
    'lever = { type = "Bar", length = 0.721110255, mass = 1, position = [0.4, 0.3], '
    "angle = 0.982793723 }\n"
    "[joints]\n"
    'A = { type = "Revolute", connect = [{ body = "ground", at = [0.2, 0.3] }, "crank.start"] }\n'
    'B = { type = "Revolute", connect = [{ body = "ground", at = [0.2, 0] }, "lever.start"] }\n'
)
"""A crank whose end is on a longer lever, as they are drawn."""


@pytest.mark.thorough
def test_a_slot_turns_a_lever(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """The lever points from its pivot to the end of the crank, which turns once in 2 s."""
    visit, _ = desk
    visit.show(SLOTTED)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("u")
    visit.click(0.4, 0.3)
    visit.click(0.3, 0.15)
    assert visit.js("studio.drawing.from.names") == ["crank.end"]  # the direction is from the pin
    visit.click(0.6, 0.6)
    visit.until("studio.file.document.joints.slot1", 20)
    slot = visit.document["joints"]["slot1"]
    assert (slot["connect"][0]["at"], slot["axis"]) == ([0, 0], [1, 0])  # without noise
    visit.settle()
    visit.draw("m", (0.2, 0.3))
    (tmp_path / "drawn.toml").write_text(visit.text)
    motion = da.solve_kinematics(load_model_file(tmp_path / "drawn.toml").model(), 2.0)
    turn = np.pi * motion.time
    angle = np.arctan2(0.3 + 0.2 * np.sin(turn), 0.2 * np.cos(turn))
    assert np.asarray(motion["lever.angle"]) == pytest.approx(angle, abs=1e-8)


@pytest.mark.thorough
def test_a_weld_replaces_a_pin(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(CRANK)
    visit.show(CRANK + 'B = { type = "Revolute", connect = ["crank.end", "rod.start"] }\n')
    visit.draw("w", (0.4, 0.2))
    assert visit.page.inner_text("#summary") == "1 degree of freedom"
    joints = visit.document["joints"]
    assert {name: joint["type"] for name, joint in joints.items()} == {
        "A": "Revolute",
        "weld1": "Weld",
    }
    visit.draw("w", (0.0, 0.2))
    assert visit.page.inner_text("#summary") == "0 degrees of freedom"


@pytest.mark.thorough
def test_a_cam_is_shaped_where_its_body_is_selected(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(GUIDED)
    visit.draw("c", (0.0, 0.2), (0.8, 0.2))
    visit.page.keyboard.press("v")
    visit.js("Object.assign(studio.pictures.page.scene.view, { x: 0, y: 0.2, s: 180 })")
    visit.frames()
    visit.click(-0.4, 0.0)  # on the disc
    assert visit.js("[...studio.drawing.selection]") == ["crank"]
    revision = visit.revision
    visit.drag((-0.8, 0.2), (-0.6, 0.2))
    visit.until(f"studio.file.revision > {revision}", 20)
    points = visit.document["joints"]["cam1"]["curve"]["points"]
    assert points[6] == pytest.approx([-0.8, 0.0])


@pytest.mark.thorough
def test_copies_are_selected_and_have_neat_numbers(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(SLOTTED)
    visit.js("studio.drawing.select(['crank', 'lever'])")
    visit.press("Control+d")
    assert visit.js("[...studio.drawing.selection]") == ["crank1", "lever1", "C", "D"]
    visit.press("Delete")
    assert list(visit.document["bodies"]) == ["crank", "lever"]


@pytest.mark.thorough
def test_redundant_joints_are_named(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    pins = "".join(
        f'{name} = {{ type = "Revolute", connect = [{{ body = "ground", at = [{x}, 0.2] }}, '
        f'"{end}"] }}\n'
        for name, x, end in (("B", 0.4, "crank.end"), ("C", 0.4, "rod.start"))
    )
    visit.show(CRANK + pins)
    assert "redundant constraint" in visit.page.inner_text("#freedom")
    assert "follows from" in visit.js("studio.drawing.status")


@pytest.mark.thorough
def test_numbers_are_typed_while_drawing(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    cases = {
        "300 mm<30": {"length": 0.3, "angle": 0.5235987756},
        "0.25": {"length": 0.25, "angle": 0},
        "0.3,0.4": {"length": 0.3605551275, "angle": 0.5880026035},
    }
    for typed, fields in cases.items():
        visit.show(HEADER)
        visit.page.locator("#palette button").first.focus()
        visit.page.keyboard.press("b")
        visit.click(0, 0.2)
        visit.page.mouse.move(*visit.place(0.5, 0.2))
        visit.page.keyboard.type(typed)
        visit.press("Enter")
        bar = visit.js("studio.file.document.bodies.bar1")
        assert {key: bar[key] for key in fields} == pytest.approx(fields, abs=1e-6), typed


def test_places_snap_to_lengths_lines_and_outlines(
    desk: tuple[Desk, Studio],
    tmp_path: Path,
) -> None:
    visit, _ = desk
    text = HEADER + (
        '[bodies]\nrod = { type = "Bar", length = 0.337, mass = 1, position = [0.1685, 0.113] }\n'
    )
    visit.show(text)
    snap = """([x, y, from]) => {
        const { page } = studio.pictures;
        return snapping.snap(page, page.scene.view.screen([x, y]), { from });
    }"""
    visit.page.evaluate(
        "async () => { window.snapping = await import(new URL('assets/snapping.js', location)); }"
    )
    equal = visit.page.evaluate(snap, [0.7, 0.563, {"x": 0.473, "y": 0.313}])
    assert equal["how"] == "length of rod"
    assert (equal["x"] - 0.473) ** 2 + (equal["y"] - 0.313) ** 2 == pytest.approx(0.337**2)
    beside = visit.page.evaluate(snap, [0.534, 0.114, None])
    assert (beside["how"], beside["y"]) == ("y of rod.start", 0.113)
    assert len(beside["guides"]) == 1
    edge = visit.page.evaluate(snap, [0.1234, 0.117, None])
    assert edge["y"] == pytest.approx(0.113)
