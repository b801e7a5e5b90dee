"""Flexible beams in the studio: their ends are dragged, and they move with their bodies."""

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

BEAM = (
    "length = {length}, axial_rigidity = 840000, shear_rigidity = 269230, bending_rigidity = 0.28, "
    "damping = 0.01, elements = 1, order = 1, mass_per_length = 0.0314, {more} }}"
)
TEXT = (
    'format = 1\nname = "test"\ngravity = [0.0, 0.0]\n'
    "[bodies]\n"
    'crank = { type = "Bar", length = 0.4, mass = 1, position = [0.2, 0.2], angle = 0 }\n'
    "[beams]\n"
    'held = { frame_i = { body = "ground", at = [0.1, 0.6] }, frame_j = "crank.end", '
    + BEAM.format(length=0.5, more="angle_i = -0.927295218002, angle_j = -0.927295218002")
    + "  # clamped twice\n"
    'free = { frame_i = { body = "ground", at = [0.0, -0.1] }, '
    + BEAM.format(length=0.3, more="angle_i = 0")
    + "\n[joints]\n"
    'A = { type = "Revolute", connect = [{ body = "ground", at = [0.0, 0.2] }, "crank.start"] }\n'
)


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.fixture
def page(desk: tuple[Desk, Studio]) -> Desk:
    visit, _ = desk
    visit.show(TEXT)
    return visit


def changed(page: Desk, act: Any) -> dict[str, Any]:
    """Entries after a change, which is undone byte for byte."""
    revision = page.revision
    act()
    page.settle(revision + 1)
    text = page.text
    page.press("Control+z")
    assert page.text == TEXT
    return tomllib.loads(text) | {"text": text}


@pytest.mark.thorough
def test_an_end_at_coordinates_and_a_free_tip_are_dragged(page: Desk) -> None:
    page.js("studio.drawing.select(['held'])")
    held = changed(page, lambda: page.drag((0.1, 0.6), (0.4, 0.7)))["beams"]["held"]
    assert held["frame_i"] == {"body": "ground", "at": [0.4, 0.7]}
    assert held["length"] == pytest.approx(0.5)
    assert [held["angle_i"], held["angle_j"]] == pytest.approx([-math.pi / 2] * 2)
    page.js("studio.drawing.select(['free'])")
    free = changed(page, lambda: page.drag((0.3, -0.1), (0.3, 0.0)))["beams"]["free"]
    assert free["frame_i"] == {"body": "ground", "at": [0.0, -0.1]}
    assert free["length"] == pytest.approx(math.hypot(0.3, 0.1))
    assert free["angle_i"] == pytest.approx(math.atan2(0.1, 0.3))
    page.js("studio.drawing.select(['free'])")
    free = changed(page, lambda: page.drag((0.0, -0.1), (0.0, -0.05)))["beams"]["free"]
    assert free["frame_i"]["at"] == [0.0, -0.05]  # where it is clamped
    assert (free["length"], free["angle_i"]) == (0.3, 0)


@pytest.mark.thorough
@pytest.mark.parametrize("key", ["drag", "r", "h", "H", "ArrowUp", "Control+d"])
def test_a_beam_is_straight_where_its_body_is_moved(key: str, page: Desk, tmp_path: Path) -> None:
    """Its ends, from their frames, are its length apart, along the directions of both clamps."""
    if key == "drag":
        text = changed(page, lambda: page.drag((0.4, 0.2), (0.4, 0.3)))["text"]
    else:
        page.js("studio.drawing.select(['crank'])")
        text = changed(page, lambda: page.page.keyboard.press(key))["text"]
    data = tomllib.loads(text)
    for name, beam in data["beams"].items():
        if "frame_j" not in beam:
            assert beam == tomllib.loads(TEXT)["beams"]["free"]
            continue
        bar = data["bodies"][beam["frame_j"].partition(".")[0]]
        angle = bar["angle"]
        end = np.array(bar["position"]) + bar["length"] / 2 * np.array(
            [math.cos(angle), math.sin(angle)]
        )
        chord = end - beam["frame_i"]["at"]
        assert np.hypot(*chord) == pytest.approx(beam["length"], rel=1e-9), name
        way = math.atan2(chord[1], chord[0])
        for clamp in (beam["angle_i"], angle + beam["angle_j"]):
            assert math.cos(clamp - way) == pytest.approx(1.0, abs=1e-12), name
        assert beam["angle_i"] == pytest.approx(angle + beam["angle_j"], abs=1e-9)  # not wound up
    if key == "Control+d":
        assert len(data["beams"]) == 3
    path = tmp_path / "moved.toml"
    path.write_text(text)
    pose = da.solve_assembly(load_model_file(path).model()).pose("crank")
    crank = data["bodies"]["crank"]  # which the beam does not hold elsewhere
    assert [pose["x"], pose["y"], pose["angle"]] == pytest.approx(
        [*crank["position"], crank["angle"]], abs=1e-6
    )
