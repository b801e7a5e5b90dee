"""Examples of flexible mechanisms and their numbers, found elsewhere.

What holds of every example, these among them, stands in ``test_examples.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers
from scipy.optimize import brentq

import dalembert as da
from dalembert import structures


def catenary(span: float) -> tuple[float, float]:
    c = brentq(lambda c: 2 * c * np.sinh(span / (2 * c)) - 12.0, 1.0, 100.0)
    return c * (np.cosh(span / (2 * c)) - 1), 0.8 * 9.81 * c


def test_cable_hangs_as_a_catenary(pictures: Path) -> None:
    printed = numbers("catenary_cable", pictures)
    sag, pull = catenary(10.0)
    assert printed["sag"] == pytest.approx(sag, rel=5e-4)
    assert abs(printed["pull"]) == pytest.approx(pull, rel=5e-4)
    slope = (catenary(10.001)[0] - catenary(9.999)[0]) / 0.002
    assert printed["slope"] == pytest.approx(slope, rel=2e-3)


def test_gripper_beside_its_pseudo_rigid_bodies(pictures: Path) -> None:
    """Small strokes are ``F l³/(24 E I)``; of Howell's model ``3 γ/K_Θ`` of that."""
    printed = numbers("compliant_gripper", pictures)
    textbook = 20.0 * 0.06**3 / (24 * 200e9 * 0.01 * 0.0005**3 / 12)
    assert printed["stroke"] == pytest.approx(textbook, rel=0.06)  # leaves pulled straight by then
    assert printed["pseudo_rigid"] / printed["stroke"] == pytest.approx(3 * 0.8517 / 2.65, abs=0.01)
    assert abs(printed["tilt"]) < 2e-3


@pytest.mark.thorough
def test_leaf_spring_is_the_lightest(pictures: Path) -> None:
    """The least ``Σ h`` at a given ``Σ c/h³``, with ``c = ∫ x² dx`` over each of five steps.

    Lagrange's condition is ``h ~ c^¼``, so that ``Σ h/(5 h_even) = (Σ c^¼)^{4/3}/(5 (Σ c)^⅓)``.
    """
    printed = numbers("leaf_spring", pictures)
    assert printed["worst"] < 1e-3  # against thicknesses in closed form
    c = np.diff(np.arange(6.0) ** 3)
    lightest = np.sum(c**0.25) ** (4 / 3) / (5 * np.sum(c) ** (1 / 3))
    assert printed["saved"] == pytest.approx(1 - lightest, abs=1e-3)


@pytest.mark.thorough
def test_robot_arm_rings_at_its_first_frequency(pictures: Path) -> None:
    """That of the arm where it stops, as a bent cantilever of frame elements with the tool."""
    printed = numbers("flexible_robot_arm", pictures)
    arm, angles = structures.Structure("arm"), (1.2, 0.4)
    metal, pipe = structures.Material(70e9, 0.33, 2700.0), structures.tube(0.025, 0.0015)
    section = pipe.of(structures.Frame) | metal.of(structures.Frame)
    place, last = np.zeros(2), None
    for link, (length, angle) in enumerate(zip((0.9, 0.8), angles, strict=True)):
        along = np.array([np.cos(angle), np.sin(angle)])
        for k in range(0 if link == 0 else 1, 5):
            node = arm.node(f"n{link}{k}", *(place + length * k / 4 * along))
            if last is None:
                arm.support(node)
            else:
                arm.add(structures.Frame(f"e{link}{k}", last, node, **section))
            last = node
        place = place + length * along
    arm.add(structures.PointMass("tool", last, mass=0.5))
    first = float(da.solve_modes(arm.build(), count=1).data["frequency"].values[0])
    assert printed["ring"] == pytest.approx(first, rel=0.02)
    assert printed["swing"] > 1e-3


@pytest.mark.thorough
def test_tapered_arm_is_that_of_the_load(pictures: Path) -> None:
    """Sag ``∝ Σ ∫ s² ds / h³`` under a load alone; the arm itself, whose
    mass counts as a twentieth of it at the tip, makes up for the rest."""
    printed = numbers("tapered_arm", pictures)
    ends = 1.0 - np.arange(5) / 4
    moments = (ends[:-1] ** 3 - ends[1:] ** 3) / 3
    best = moments**0.25 / (moments**0.25).mean()
    assert printed["off"] < 0.03
    ratio = (np.sum(moments / best**3) / np.sum(moments)) ** 2
    assert printed["after"] / printed["before"] == pytest.approx(ratio, rel=0.1)
    assert printed["slope_error"] < 1e-6
