"""Other assembly configurations, swept areas and dead centres in the studio."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_insight_page import four_bar_text

A, B, C, G = math.hypot(0.1, 0.3), math.hypot(0.7, 0.2), math.hypot(0.1, 0.5), 0.9
"""Lengths of the crank, the coupler, the rocker and the ground."""
SLIDER_CRANK = """\
format = 1
[bodies]
crank = { type = "Bar", length = 0.2, mass = 1, position = [0.1, 0] }
rod = { type = "Bar", length = 0.5, mass = 1, position = [0.45, 0] }
[joints]
O = { type = "Revolute", connect = ["ground", "crank.start"] }
A = { type = "Revolute", connect = ["crank.end", "rod.start"] }
B = { type = "PinInSlot", connect = [{ body = "ground", at = [0, 0] }, "rod.end"], axis = [1, 0] }
[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "crank"], law = "2*pi*t" }
"""
"""It starts at a dead centre."""
MODULES = """async () => {
    window.kinematics = await import("./assets/plane_kinematics.js");
    window.swept = await import("./assets/swept.js");
}"""


def rocker_range() -> float:
    """Angle between the limits of the rocker, where crank and coupler are in line."""
    angles = [math.acos((G**2 + C**2 - d**2) / (2 * G * C)) for d in (B - A, B + A)]
    return angles[1] - angles[0]


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.mark.thorough
def test_another_configuration_is_drawn_and_taken(desk: tuple[Desk, Studio]) -> None:
    """It has the joint B on the other side of the line from A to C."""
    visit, _ = desk
    text = four_bar_text()
    visit.show(text)
    visit.js("document.getElementById('canvas').focus()")
    visit.page.keyboard.press("9")
    visit.until("studio.insight.ghosts.poses.length > 0", 60)
    (poses,) = visit.js("studio.insight.ghosts.poses")
    pin, pivot, end = complex(0.1, 0.3), complex(0.9, 0), complex(0.8, 0.5)
    line = (pivot - pin) / abs(pivot - pin)
    mirrored = pin + line * ((end - pin) / line).conjugate()
    x, y, angle = poses["coupler"]
    assert complex(x, y) == pytest.approx((pin + mirrored) / 2, abs=1e-9)
    assert np.exp(1j * angle) == pytest.approx((mirrored - pin) / B, abs=1e-9)
    x, y, angle = poses["rocker"]
    assert complex(x, y) == pytest.approx((pivot + mirrored) / 2, abs=1e-9)

    revision = visit.revision
    on = pin + 0.3 * (mirrored - pin)
    visit.click(on.real, on.imag)
    visit.settle(revision + 1)
    assert visit.errors_shown() == []
    end_now = visit.js(
        """(() => {
            const { motion } = studio.pictures.page;
            const point = motion.points.find(({ name }) => name === "coupler.end");
            return motion.at(point.body, point.point, { i: 0, f: 0 });
        })()"""
    )
    assert complex(*end_now) == pytest.approx(mirrored, abs=1e-6)
    visit.until("studio.insight.ghosts.poses.length > 0", 60)
    (back,) = visit.js("studio.insight.ghosts.poses")
    assert complex(*back["coupler"][:2]) == pytest.approx((pin + end) / 2, abs=1e-9)
    visit.press("Control+z")
    assert visit.text == text
    visit.show(text.replace(f"angle = {math.atan2(3, 1)!r} }}", 'angle = "c" }'))
    visit.until("studio.file.document?.bodies.crank.angle === 'c'", 10)
    visit.until("studio.insight.ghosts.poses.length > 0", 60)
    changed = visit.text
    visit.page.click("#tab-analysis")
    visit.page.click("text=Take configuration 1")
    visit.until("document.getElementById('notice').textContent.includes('angle of crank (c)')", 10)
    assert visit.text == changed  # a formula is not overwritten
    visit.page.keyboard.press("9")
    visit.page.click("text=Other configurations")


def test_swept_areas_and_dead_centres_are_those_of_the_four_bar(
    desk: tuple[Desk, Studio],
) -> None:
    visit, _ = desk
    visit.show(four_bar_text())
    visit.page.evaluate(MODULES)
    seen: Any = visit.js(
        """(() => {
            const { motion } = studio.pictures.page, body = (name) => motion.byName.get(name);
            const end = motion.points.find(({ name }) => name === "crank.end");
            return {
                crank: swept.sweptOf(motion, body("crank")).area,
                rocker: swept.sweptOf(motion, body("rocker")).area,
                path: swept.pathSizes(motion, end.body, end.point),
                centres: kinematics.deadCentres(motion).map(({ body, cursor, stroke }) =>
                    [body.name, motion.pose(body, cursor).a, stroke,
                     kinematics.crankAngle(motion, cursor).angle]),
            };
        })()"""
    )
    assert seen["crank"] == pytest.approx(math.pi * A**2, rel=0.01)
    assert seen["rocker"] == pytest.approx(C**2 * rocker_range() / 2, rel=0.01)
    assert seen["path"]["length"] == pytest.approx(2 * math.pi * A, rel=2e-3)
    assert seen["path"]["area"] == pytest.approx(math.pi * A**2, rel=4e-3)
    (first, second) = seen["centres"]  # three turns repeat them
    assert (first[0], second[0]) == ("rocker", "rocker")
    assert abs(first[1] - second[1]) == pytest.approx(rocker_range(), abs=1e-3)
    turns = (second[3] - first[3]) / (2 * math.pi)
    assert first[2] == pytest.approx(turns, abs=1e-3)  # one turn in a second
    assert first[2] + second[2] == pytest.approx(1, abs=1e-3)


@pytest.mark.thorough
def test_a_cycle_that_starts_at_a_dead_centre_has_both(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(SLIDER_CRANK)
    visit.page.evaluate(MODULES)
    places = visit.js(
        """(() => {
            const { motion } = studio.pictures.page;
            const end = motion.points.find(({ name }) => name === "rod.end");
            return kinematics.deadCentres(motion).map(({ cursor }) =>
                motion.at(end.body, end.point, cursor)[0]);
        })()"""
    )
    assert sorted(places) == pytest.approx([0.3, 0.7], abs=1e-4)
