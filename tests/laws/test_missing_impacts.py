"""Corners that swing through a surface within a step, between two positions without contact."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

ARM, DEPTH, INERTIA, STEP, TURN = 0.1, 5e-5, 1e-3, 1e-3, 0.2
MISSING = "is missing, with"


def swinging(depth: float, behind: float) -> tuple[da.Model, float]:
    """A hand on an axle and a wall across its path, which the third step passes with a share of
    its turn left; the angle at which they touch."""
    system, wall = da.System("hand"), TURN * (3 - behind)
    hand = planar.Body("hand", mass=1.0, inertia=INERTIA, angular_velocity=TURN / STEP)
    system.add(hand)
    system.add(planar.Revolute("axle", system.ground.center, hand.center))
    normal = np.array([math.cos(wall), math.sin(wall)])
    foot = system.ground.point(*(ARM - depth) * normal)
    contact = planar.contact
    shapes = [contact.Vertex(hand.point(ARM, 0)), contact.HalfPlane(foot, tuple(-normal))]
    system.add(planar.Collisions("hit", shapes))
    return system.build(), wall - math.acos(min(1 - depth / ARM, 1.0))


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_an_impact_between_the_ends_of_a_step_is_warned_about(scheme):
    """The wall would stop the hand; a step that the warning proposes does so."""
    model, touch = swinging(DEPTH, 0.2)
    motion = da.solve_nonsmooth(model, 8 * STEP, step=STEP, integrator=scheme)
    assert motion["hand.angle"][-1] > touch + 4 * TURN
    (warning,) = [text for text in motion.warnings if MISSING in text]
    depth, speed, energy, moved, shorter = (
        float(re.search(pattern, warning).group(1))
        for pattern in (
            r"by (\S+) m for",
            r"at (\S+) m/s",
            r"with (\S+) J",
            r"where (\S+) J",
            r"step=(\S+)",
        )
    )
    assert depth == pytest.approx(DEPTH, rel=0.01)
    closing = ARM * TURN / STEP * math.sin(math.acos(1 - DEPTH / ARM))
    assert speed == pytest.approx(closing, rel=0.01)
    assert energy == pytest.approx(INERTIA * (TURN / STEP) ** 2 / 2, rel=0.01)
    assert moved == pytest.approx(energy, rel=0.01)
    fine = da.solve_nonsmooth(model, 4 * STEP, step=shorter, integrator=scheme)
    assert fine["hand.angle"][-1] == pytest.approx(touch, abs=shorter * TURN / STEP)
    assert not [text for text in fine.warnings if MISSING in text]


def test_an_impact_of_a_free_body_within_a_step_in_machine_code_is_warned_about():
    """The energy is that of a corner of the lever ``ARM`` on a free body."""
    system, turn, depth = da.System("spun"), 0.3, 1e-4
    body = planar.Body("body", mass=1.0, inertia=INERTIA, angular_velocity=turn / STEP)
    corners = [(-0.02, -0.01), (ARM, 0), (-0.02, 0.01)]
    blade = planar.contact.Polygon(system.add(body), corners)
    wall = turn * (3 - 0.2)
    normal = np.array([math.cos(wall), math.sin(wall)])
    foot = system.ground.point(*(ARM - depth) * normal)
    floor = planar.contact.HalfPlane(foot, tuple(-normal))
    system.add(planar.Collisions("hit", [blade, floor]))
    motion = da.solve_nonsmooth(system.build(), 8 * STEP, step=STEP)
    assert not motion.record.step.size
    (warning,) = [text for text in motion.warnings if MISSING in text]
    lever = ARM * math.sin(math.acos(1 - depth / ARM))
    closing = lever * turn / STEP
    energy = closing**2 / 2 / (1 / 1.0 + lever**2 / INERTIA)
    assert float(re.search(r"by (\S+) m for", warning).group(1)) == pytest.approx(depth, rel=0.01)
    assert float(re.search(r"at (\S+) m/s", warning).group(1)) == pytest.approx(closing, rel=0.01)
    assert float(re.search(r"with (\S+) J", warning).group(1)) == pytest.approx(energy, rel=0.01)


def test_a_correction_of_a_position_is_not_farther_than_the_step():
    """In the middle of the overlap the gap does not depend on the angle but for rounding."""
    model, touch = swinging(DEPTH, 0.5)
    motion = da.solve_nonsmooth(model, 8 * STEP, step=STEP, integrator=da.MoreauJean())
    assert motion.status.success
    assert motion["hand.angle"][-1] == pytest.approx(touch, abs=0.2 * TURN)


@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_corner_that_passes_a_wall_is_not_warned_about(scheme):
    model, _ = swinging(-2e-5, 0.2)
    motion = da.solve_nonsmooth(model, 8 * STEP, step=STEP, integrator=scheme)
    assert not motion.record.step.size
    assert not [text for text in motion.warnings if MISSING in text]


@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_graze_without_much_energy_is_not_warned_about(scheme):
    """Two discs overlap by 40 µm within a step: the speed along the normal is 2 % of the other."""
    system, radius = da.System("graze"), 0.1
    still = system.add(planar.Body("still", mass=1.0, inertia=1.0, position=(0, 0)))
    start = {"position": (-0.025, 2 * radius - 4e-5), "velocity": (5.0, 0)}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=1.0, **start))
    system.add(planar.Revolute("axle", system.ground.center, still.center))
    shapes = [planar.contact.Circle(body, radius) for body in (still, disc)]
    system.add(planar.Collisions("hit", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.03, step=0.01, integrator=scheme)
    assert not [text for text in motion.warnings if MISSING in text]


def test_room_for_an_impact_that_does_not_occur_is_warned_about():
    """The hand passes the wall by a fifth of a hundredth of a millimetre more than it needs."""
    model, _ = swinging(-2e-5, 0.5)
    motion = da.solve_nonsmooth(model, 8 * STEP, step=STEP, integrator=da.AnticipatedImpacts())
    lost = 1 - (motion.record.ends.v[-1, -1] * STEP / TURN) ** 2
    assert motion.status.success and lost > 0.1
    (warning,) = [text for text in motion.warnings if "open again without an impact" in text]
    stated = float(re.search(r"dissipate (\S+) J", warning).group(1))
    assert stated == pytest.approx(lost * INERTIA * (TURN / STEP) ** 2 / 2, rel=0.01)
    shorter = float(re.search(r"use step=(\S+) or shorter", warning).group(1))
    fine = da.solve_nonsmooth(model, 8 * STEP, step=shorter, integrator=da.AnticipatedImpacts())
    assert fine["hand.angle"][-1] == pytest.approx(8 * TURN) and not fine.warnings


def test_a_rebound_without_restitution_is_warned_about():
    """A grazing impact for which the step before left no room."""
    turn, wall = 0.05, 1.2325
    system = da.System("hand")
    hand = planar.Body("hand", mass=1.0, inertia=INERTIA, angular_velocity=turn / STEP)
    system.add(hand)
    system.add(planar.Revolute("axle", system.ground.center, hand.center))
    normal = np.array([math.cos(wall), math.sin(wall)])
    foot, contact = system.ground.point(*(ARM - DEPTH) * normal), planar.contact
    shapes = [contact.Vertex(hand.point(ARM, 0)), contact.HalfPlane(foot, tuple(-normal))]
    system.add(planar.Collisions("hit", shapes))
    motion = da.solve_nonsmooth(system.build(), 31 * STEP, step=STEP)
    share = (motion.record.ends.v[-1, -1] * STEP / turn) ** 2
    assert motion.record.ends.v[-1, -1] < 0 and share > 0.1
    (warning,) = [text for text in motion.warnings if "the energy after an impact" in text]
    error = float(re.search(r"differs by (\S+) J", warning).group(1))
    assert error == pytest.approx(share * INERTIA * (turn / STEP) ** 2 / 2, rel=0.05)


def test_errors_of_rebounds_are_below_the_energy_of_the_motion():
    """Contacts of a rattling stack that hardly close at the start of a step have no share of their
    speed by Poisson's law."""
    system = da.System("stack", gravity=(0, -9.81))
    shapes = [planar.contact.HalfPlane(system.ground)]
    for k in range(3):
        place = {"position": (0.01 * k, 0.12 + 0.25 * k), "angle": 0.1 * k}
        box = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.01, **place))
        shapes.append(planar.contact.Rectangle(box, (0.4 - 0.05 * k, 0.2)))
    laws = {"friction": 0.4, "restitution": 0.5, "impact_law": "poisson"}
    system.add(planar.Collisions("stack", shapes, **laws))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=2e-3, integrator=da.MoreauJean())
    errors = re.findall(r"differs by (\S+) J", " ".join(motion.warnings))
    assert all(float(error) < np.ptp(motion["kinetic_energy"].values) for error in errors)
