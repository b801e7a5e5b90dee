"""Examples of decisions under doubt: each has a number found elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers, script


def test_arm_is_identified(pictures: Path) -> None:
    """The true values are known, for the data were made with them."""
    printed, example = numbers("identified_arm", pictures), script("identified_arm")
    for name, value in example.TRUE.items():
        assert printed[name] == pytest.approx(value, rel=0.05)
    assert printed["noise"] == pytest.approx(example.NOISE, rel=0.15)


@pytest.mark.thorough
def test_truss_is_as_reliable_as_the_closed_form(pictures: Path) -> None:
    """Sums of normal logarithms: ``u = P L³/(2 E a² h²)`` and ``P L/(2 h) = π² E a⁴/(12 L²)``."""
    printed, example = numbers("reliable_truss", pictures), script("reliable_truss")
    length = math.hypot(example.WIDTH, example.HEIGHT)
    means, spreads = zip(*(d.logarithm for d in example.RANDOM.values()), strict=True)
    limits = {
        "deflection": (example.MOST * 2 * example.HEIGHT**2 / length**3, (-1, 1, 2)),
        "buckling": (math.pi**2 / (12 * length**2) * 2 * example.HEIGHT / length, (-1, 1, 4)),
    }
    for name, (constant, powers) in limits.items():
        beta = (math.log(constant) + np.dot(powers, means)) / np.linalg.norm(
            np.multiply(powers, spreads)
        )
        assert printed[f"beta of {name}"] == pytest.approx(beta, abs=1e-6)
        assert printed[f"residual of {name}"] < 1e-8
    logs = np.random.default_rng(4).normal(means, spreads, (400_000, 3))
    broken = [math.log(c) + logs @ np.array(powers) < 0 for c, powers in limits.values()]
    share = np.mean(broken[0] | broken[1])
    assert printed["low"] < share < printed["high"]


@pytest.mark.thorough
def test_lightest_trusses_are_as_reliable_as_asked_for(pictures: Path) -> None:
    """Indices in closed form are those asked for, and so is the mass without scatter."""
    printed, example = (
        numbers("lightest_reliable_truss", pictures),
        script("lightest_reliable_truss"),
    )
    for beta in example.INDICES:
        assert printed[f"beta at {beta:g}"] == pytest.approx(beta, abs=1e-4)
    masses = [printed["mass"], *(printed[f"mass at {beta:g}"] for beta in example.INDICES)]
    assert np.all(np.diff(masses) > 0)
    length = math.hypot(example.WIDTH, 1.0)  # without scatter bars buckle, and a² L is least there
    area = math.sqrt(6 * length**3 * example.LOAD / (math.pi**2 * example.MODULUS))
    assert printed["mass"] == pytest.approx(2 * example.DENSITY * area * length, rel=1e-6)


@pytest.mark.thorough
def test_stroke_scatters_as_the_closed_form(pictures: Path) -> None:
    """``S = 2 L r/d``, taken as an integral over 360 intervals."""
    printed, example = numbers("shaper_tolerances", pictures), script("shaper_tolerances")
    r, d, lever = 0.1, 0.3, 0.55
    half = np.array([example.HALF[n] for n in ("r", "d", "lever_length")])

    def stroke(z):
        return 2 * (lever + half[2] * z[2]) * (r + half[0] * z[0]) / (d + half[1] * z[1])

    slopes = 2 * np.array([lever / d, -lever * r / d**2, r / d])
    assert printed["stroke"] == pytest.approx(stroke((0, 0, 0)), rel=2e-4)
    assert printed["std"] == pytest.approx(np.linalg.norm(slopes * half) / 3, rel=1e-3)
    assert printed["std of the samples"] == pytest.approx(printed["std"], rel=0.2)
    largest = stroke((1, -1, 1)) - stroke((0, 0, 0))
    assert printed["largest"] - printed["stroke"] == pytest.approx(largest, rel=5e-3)
    assert printed["allocated"] == pytest.approx(example.LIMIT, rel=1e-3)
    assert printed["±link_length"] == 0.5e-3


@pytest.mark.thorough
def test_torques_of_a_leg(pictures: Path) -> None:
    """Against Lagrange's equations in closed form; differences of the noise give half of it."""
    printed = numbers("gait_torques", pictures)
    for joint in ("hip", "knee"):
        assert printed[f"smooth {joint}"] < 0.15 < 0.5 < printed[f"raw {joint}"]
    assert printed["misfit"] == pytest.approx(1, abs=0.2)


@pytest.mark.thorough
def test_a_wing_twists_as_the_closed_form(pictures: Path) -> None:
    """``α (1/cos λl − 1)``, to which a second-order mesh comes near; the wall it takes at most."""
    pytest.importorskip("openmdao.api")
    printed, example = numbers("twisting_wing", pictures), script("twisting_wing")
    for speed in example.SPEEDS:
        tip = example.exact(example.SPAN, example.pressure(speed))
        assert printed[f"tip at {speed:g}"] == pytest.approx(tip, rel=5e-3)
    needed = (
        example.pressure(example.SPEED)
        * example.CHORD
        * example.AHEAD
        * example.SLOPE
        * example.SPAN**2
    )
    needed /= math.acos(1 / (1 + example.MOST)) ** 2 * example.G * 2 * math.pi * example.RADIUS**3
    assert printed["uniform wall"] == pytest.approx(needed, rel=1e-3)
    assert printed["mass"] < 0.9 * printed["uniform mass"]
    assert printed["tip"] == pytest.approx(example.MOST * example.ATTACK, rel=1e-6)


def test_the_shape_of_a_truss_by_the_method_of_joints(pictures: Path) -> None:
    """It is statically determinate: forces by balance alone; lighter than the 4,530 lb printed."""
    printed, example = numbers("truss_shape", pictures), script("truss_shape")
    assert printed["success"] and printed["mass [lb]"] < 4530
    places = {k: np.array(at) for k, at in example.places(printed).items()}
    free = [k for k in places if k not in (10, 11)]
    area = {k: printed[name] for name, members in example.GROUPS.items() for k in members}
    balance, loads = np.zeros((2 * len(free), len(example.BARS))), np.zeros(2 * len(free))
    lengths = np.array([np.linalg.norm(places[j] - places[i]) for i, j in example.BARS])
    for k, ends in enumerate(example.BARS):
        for here, there in (ends, ends[::-1]):
            if here in free:
                row = 2 * free.index(here)
                balance[row : row + 2, k] = (places[there] - places[here]) / lengths[k]
    for node in example.LOADED:
        loads[2 * free.index(node) + 1] = example.FORCE
    areas = np.array([area[k] for k in range(len(example.BARS))])
    stress = np.linalg.solve(balance, loads) / areas
    assert np.all(abs(stress) < (1 + 1e-6) * example.STRONGEST)
    assert np.all(-stress < (1 + 1e-6) * 4 * example.MODULUS * areas / lengths**2)
    assert example.DENSITY * areas @ lengths == pytest.approx(printed["mass [lb]"] * example.POUND)
