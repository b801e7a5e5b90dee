"""Targets that are dragged in the studio, six-bars that are inserted, and marks of defects."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from laws.test_chains import SIX_BARS
from studio_desk import UNTITLED, Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file
from dalembert.io.decisions.synthesis import make_synthesis
from dalembert.studio.candidates import cards
from dalembert.studio.drawing_edits import apply
from dalembert.studio.inserted_linkages import mechanism_operations

PATH = """
[synthesis]  # of a path
type = "path"
points = [[0.2, 0.2], [0.5, 0.4], [0.8, 0.2]]
"""
POSES = """
[synthesis]
type = "motion"
points = [[0.2, 0.2], [0.6, 0.4]]
coupler_angles = [0.0, 0.5]
"""
FUNCTION = """
[synthesis]
type = "function"
crank_angles = [1.0, 2.0, 3.0]
outputs = [0.0, 0.5, 0.25]
"""

DRIVEN = """
[bodies]
crank = { type = "Bar", length = 0.3, mass = 1 }
[joints]
O = { type = "Revolute", connect = ["ground", "crank.start"] }
[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "crank"], law = "2*pi*t" }  # a turn
"""


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", SIX_BARS)
def test_an_inserted_six_bar_moves_as_the_candidate(kind: str, tmp_path: Path) -> None:
    joints, link = SIX_BARS[kind]
    at = joints[da.INVERSIONS[kind].chain[link][1]]
    model = da.six_bar(kind, joints, {link: {"P": at}}, speed=2 * math.pi).build()
    motion = da.solve_kinematics(model, 1.0, outputs=25)
    operations = mechanism_operations(motion)
    text = apply(UNTITLED, operations)
    (tmp_path / "inserted.toml").write_text(text)
    inserted = load_model_file(tmp_path / "inserted.toml").model()
    assert inserted.diagnosis.summary == "1 degree of freedom, 1 driven, 0 free"
    again = da.solve_kinematics(inserted, 1.0, outputs=25)
    names = {name: f"{name}1" for name in tomllib.loads(text)["bodies"]}
    for axis in "xy":
        wanted = motion[f"{link}.P.{axis}"].values
        body = next(name for name in names if name.rstrip("1") == link)
        assert again[f"{body}.P.{axis}"].values == pytest.approx(wanted, abs=1e-7)


def test_entries_on_two_circuits_are_marked() -> None:
    """A Grashof double rocker: its shortest link is the coupler, so that the crank does not cross
    the line of the ground."""
    linkage = da.FourBar(crank=0.6, coupler=0.2, follower=0.7, ground=0.8, u=0.1, v=0.1)
    turn = np.linspace(-math.pi, math.pi, 721)
    closed = turn[np.isfinite(linkage.path(turn)).all(axis=1)]
    assert closed.min() < 0 < closed.max() and not np.any(np.abs(closed) < 0.01)
    one, other = closed[closed > 0], closed[closed < 0]

    def marks(angles: Any) -> list[str]:
        target = da.Target.path(linkage.path(angles))
        solution = da.Solution(linkage, np.asarray(angles), 0.0, np.zeros(len(angles)))
        result = da.SynthesisResult(target, [solution], 1)
        return next(cards(result))["marks"]

    assert "circuit defect" not in marks(one[[5, 10, 15]])
    assert "circuit defect" in marks([one[5], one[10], other[-5]])


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


INSIDE = """(() => {
    const { motion, scene: { view, canvas } } = studio.pictures.page;
    return motion.points.every(({ body, point }) => {
        const [u, v] = view.screen(motion.at(body, point));
        return u > 0 && v > 0 && u < canvas.clientWidth && v < canvas.clientHeight;
    });
})()"""


def test_targets_are_dragged(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(UNTITLED + PATH)
    visit.drag((0.5, 0.4), (0.6, 0.5))
    visit.until("studio.file.undo === 'move target'", 10)
    points = visit.document["synthesis"]["points"]
    assert points == [[0.2, 0.2], [0.6, 0.5], [0.8, 0.2]]
    assert "[synthesis]  # of a path" in visit.text
    visit.press("Control+z")
    assert visit.text == UNTITLED + PATH

    visit.show(UNTITLED + POSES)
    arm = 26 / visit.js("studio.pictures.page.scene.view.s")
    tip = (0.2 + arm, 0.2)
    visit.page.keyboard.down("Alt")
    visit.drag(tip, (0.2, 0.2 + 2 * arm))
    visit.until("studio.file.undo === 'turn target'", 10)
    angles = visit.document["synthesis"]["coupler_angles"]
    assert angles == [pytest.approx(math.pi / 2, abs=0.02), 0.5]
    visit.drag((0.6, 0.4), (0.7, 0.3))
    visit.until("studio.file.undo === 'move target'", 10)
    visit.page.keyboard.up("Alt")
    assert visit.document["synthesis"]["points"][1] == pytest.approx([0.7, 0.3], abs=3e-3)
    assert visit.document["synthesis"]["coupler_angles"] == angles

    visit.page.mouse.move(*visit.place(0.7, 0.3))  # given up by Escape
    text = visit.text
    visit.page.mouse.down()
    visit.page.mouse.move(*visit.place(0.3, 0.3), steps=3)
    visit.page.locator("#canvas iframe:not(.loading)").focus()
    visit.page.keyboard.press("Escape")
    visit.page.mouse.up()
    visit.frames()
    assert visit.text == text


@pytest.mark.thorough
def test_points_of_a_function_are_dragged(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(UNTITLED + FUNCTION)
    visit.page.click("#tab-synthesis")
    chart = visit.page.locator("canvas.function").bounding_box()
    assert chart is not None

    def at(x: float, y: float) -> tuple[float, float]:
        """Of the chart of 640 × 320 units, whose axes are from 44 and to 290."""
        u = 44 + x / (2 * math.pi) * (640 - 54)
        v = 290 - (y + 1.2) / 2.4 * 280
        return chart["x"] + u / 640 * chart["width"], chart["y"] + v / 320 * chart["height"]

    visit.page.mouse.move(*at(2.0, 0.5))
    visit.page.mouse.down()
    visit.page.mouse.move(*at(2.5, 0.8), steps=3)
    visit.page.mouse.up()
    visit.until("studio.file.undo === 'move function point'", 10)
    table = visit.document["synthesis"]
    assert table["crank_angles"] == [1.0, pytest.approx(2.5, abs=0.02), 3.0]
    assert table["outputs"] == [0.0, pytest.approx(0.8, abs=0.02), 0.25]


@pytest.mark.thorough
def test_six_bars_are_chosen_with_joints_at_the_target(
    desk: tuple[Desk, Studio], tmp_path: Path
) -> None:
    visit, _ = desk
    visit.show(UNTITLED + PATH)
    visit.page.click("#tab-synthesis")
    for kind in da.INVERSIONS:
        visit.page.select_option(".synthesis [name=linkage]", kind)
        visit.until(f"studio.file.document.synthesis.linkage === {kind!r}", 10)
        (tmp_path / "task.toml").write_text(visit.text)
        file = load_model_file(tmp_path / "task.toml")
        assert callable(make_synthesis(file))
        table = file.document.synthesis
        link = table.point.partition(".")[0]
        assert table.marks[link]["P"] == pytest.approx([0.5, 0.3])
    visit.page.select_option(".synthesis [name=type]", "function")
    visit.until("studio.file.document.synthesis.output", 10)
    assert "point" not in visit.document["synthesis"]
    visit.page.select_option(".synthesis [name=linkage]", "FourBar")
    visit.until("!studio.file.document.synthesis.joints", 10)
    assert set(visit.document["synthesis"]) == {"type", "points", "linkage"}


@pytest.mark.thorough
def test_an_emptied_coordinate_of_a_target_is_no_zero(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(UNTITLED + PATH)
    visit.page.click("#tab-synthesis")
    entry = visit.page.locator("[name='points-0-0']")
    for typed in ("", " "):
        entry.fill(typed)
        entry.press("Tab")
        assert entry.input_value() == "0.2" and "× removes the entry" in visit.page.inner_text(
            "#notice"
        )
        assert visit.text == UNTITLED + PATH
    entry.fill("1,5")
    entry.press("Tab")
    assert entry.get_attribute("aria-invalid") == "true"
    for message in (entry.evaluate("i => i.validationMessage"), visit.page.inner_text("#notice")):
        assert message == "Write a decimal point: 1.5"
    assert visit.text == UNTITLED + PATH
    for typed in ("300 mm", "2*"):
        entry.fill(typed)
        entry.press("Tab")
        visit.until(f"studio.file.document.synthesis.points[0][0] === {typed!r}", 10)
        assert visit.text == (UNTITLED + PATH).replace("[[0.2, 0.2]", f'[["{typed}", 0.2]')
    visit.settle()
    (error,) = visit.errors_shown()
    assert "synthesis.points[0][0]: in formula '2*'" in error and "ends with '*'" in error


@pytest.mark.thorough
def test_an_emptied_law_of_a_driver_is_restored(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    text = UNTITLED + DRIVEN
    visit.show(text)
    visit.page.click("#tab-analysis")
    law = visit.page.locator("[name=law-motor]")
    law.fill("")
    law.press("Tab")
    assert law.input_value() == "2*pi*t" and visit.text == text
    assert "its former one is kept" in visit.page.inner_text("#notice")
    law.fill("3*t")
    law.press("Enter")
    visit.until("studio.file.document.drivers.motor.law === '3*t'", 10)


@pytest.mark.thorough
def test_points_with_units_are_drawn_and_dragged(desk: tuple[Desk, Studio]) -> None:
    """A formula is not replaced by a drag; a message states it."""
    visit, _ = desk
    text = UNTITLED + PATH.replace("[[0.2, 0.2]", '[["20 cm", 0.2]').replace("0.4]", '"2*0.2"]')
    visit.show(text)
    visit.drag((0.2, 0.2), (0.3, 0.2))
    visit.until("studio.file.undo === 'move target'", 10)
    assert visit.text == text.replace("20 cm", "30.0 cm")
    visit.drag((0.5, 0.4), (0.5, 0.5))
    visit.until("document.getElementById('notice').textContent.includes('is the formula')", 10)
    assert visit.text == text.replace("20 cm", "30.0 cm")


@pytest.mark.thorough
def test_clicked_poses_are_those_of_the_file(desk: tuple[Desk, Studio]) -> None:
    """Position and direction of each; an inserted linkage is in the picture as a whole."""
    visit, studio = desk
    poses = [((0.1, 0.1), (0.3, 0.1)), ((0.3, 0.35), (0.4, 0.45)), ((0.7, 0.4), (0.7, 0.6))]
    for pose in poses:
        visit.draw("Shift+P", *pose)
    table = visit.document["synthesis"]
    assert table["points"] == [list(place) for place, _ in poses]
    assert table["coupler_angles"] == pytest.approx([0, math.pi / 4, math.pi / 2], abs=1e-5)
    visit.page.click("#tab-synthesis")
    visit.page.fill("[name=starts]", "12")
    visit.page.keyboard.press("Enter")
    visit.until("studio.file.document.synthesis.starts === 12 && studio.isAnswered", 20)
    visit.page.click("#start-synthesis")
    visit.until("document.querySelectorAll('.candidate').length", 60)
    revision = visit.revision
    visit.page.locator(".candidate button", has_text="Insert").first.click()
    visit.settle(revision + 1)
    assert visit.document["synthesis"]["points"] == table["points"]
    assert visit.js(INSIDE)
    path = studio.folder / "poses.toml"
    path.write_text(visit.text, encoding="utf-8")
    motion = da.solve_kinematics(load_model_file(path).model(), duration=1.0, step=1 / 4000)
    place = np.array([motion[f"coupler1.P.{axis}"] for axis in "xy"])
    turns = []
    for (at, _), angle in zip(poses, table["coupler_angles"], strict=True):
        distance = np.hypot(*(place - np.reshape(at, (2, 1))))
        nearest = int(distance.argmin())
        assert distance[nearest] < 2e-3  # of instants 0.25 ms apart
        turns.append(float(motion["coupler1.angle"][nearest]) - angle)
    assert np.allclose(np.exp(1j * np.array(turns)), np.exp(1j * turns[0]), atol=5e-3)
