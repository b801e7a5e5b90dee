"""Examples of decisions under doubt: each has a number found elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers, script


def test_arm_is_identified(pictures: Path) -> None:
    """The true values are known, for the data were made with them."""
    found, made = numbers("identified_arm", pictures), script("identified_arm")
    for name, value in made.TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.05)
    assert found["noise"] == pytest.approx(made.NOISE, rel=0.15)


def test_truss_is_as_reliable_as_the_closed_form(pictures: Path) -> None:
    """Sums of normal logarithms: ``u = P L³/(2 E a² h²)`` and ``P L/(2 h) = π² E a⁴/(12 L²)``."""
    found, made = numbers("reliable_truss", pictures), script("reliable_truss")
    length = math.hypot(made.WIDTH, made.HEIGHT)
    means, spreads = zip(*(d.logarithm for d in made.RANDOM.values()), strict=True)
    limits = {
        "deflection": (made.MOST * 2 * made.HEIGHT**2 / length**3, (-1, 1, 2)),
        "buckling": (math.pi**2 / (12 * length**2) * 2 * made.HEIGHT / length, (-1, 1, 4)),
    }
    for name, (constant, powers) in limits.items():
        beta = (math.log(constant) + np.dot(powers, means)) / np.linalg.norm(
            np.multiply(powers, spreads)
        )
        assert found[f"beta of {name}"] == pytest.approx(beta, abs=1e-6)
        assert found[f"residual of {name}"] < 1e-8
    logs = np.random.default_rng(4).normal(means, spreads, (400_000, 3))
    broken = [math.log(c) + logs @ np.array(powers) < 0 for c, powers in limits.values()]
    share = np.mean(broken[0] | broken[1])
    assert found["low"] < share < found["high"]


def test_lightest_trusses_are_as_reliable_as_asked_for(pictures: Path) -> None:
    """Indices in closed form are those asked for, and so is the mass without scatter."""
    found, made = numbers("lightest_reliable_truss", pictures), script("lightest_reliable_truss")
    for beta in made.INDICES:
        assert found[f"beta at {beta:g}"] == pytest.approx(beta, abs=1e-4)
    masses = [found["mass"], *(found[f"mass at {beta:g}"] for beta in made.INDICES)]
    assert np.all(np.diff(masses) > 0)
    length = math.hypot(made.WIDTH, 1.0)  # without scatter bars buckle, and a² L is least there
    area = math.sqrt(6 * length**3 * made.LOAD / (math.pi**2 * made.MODULUS))
    assert found["mass"] == pytest.approx(2 * made.DENSITY * area * length, rel=1e-6)


def test_stroke_scatters_as_the_closed_form(pictures: Path) -> None:
    """``S = 2 L r/d``, taken as an integral over 360 intervals."""
    found, made = numbers("shaper_tolerances", pictures), script("shaper_tolerances")
    r, d, lever = 0.1, 0.3, 0.55
    half = np.array([made.HALF[n] for n in ("r", "d", "lever_length")])

    def stroke(z):
        return 2 * (lever + half[2] * z[2]) * (r + half[0] * z[0]) / (d + half[1] * z[1])

    slopes = 2 * np.array([lever / d, -lever * r / d**2, r / d])
    assert found["stroke"] == pytest.approx(stroke((0, 0, 0)), rel=2e-4)
    assert found["std"] == pytest.approx(np.linalg.norm(slopes * half) / 3, rel=1e-3)
    assert found["std of the samples"] == pytest.approx(found["std"], rel=0.2)
    largest = stroke((1, -1, 1)) - stroke((0, 0, 0))
    assert found["largest"] - found["stroke"] == pytest.approx(largest, rel=5e-3)
    assert found["allocated"] == pytest.approx(made.LIMIT, rel=1e-3)
    assert found["±link_length"] == 0.5e-3


def test_torques_of_a_leg(pictures: Path) -> None:
    """Against Lagrange's equations in closed form; differences of the noise give half of it."""
    found = numbers("gait_torques", pictures)
    for joint in ("hip", "knee"):
        assert found[f"smooth {joint}"] < 0.15 < 0.5 < found[f"raw {joint}"]
    assert found["misfit"] == pytest.approx(1, abs=0.2)


def test_a_wing_twists_as_the_closed_form(pictures: Path) -> None:
    """``α (1/cos λl − 1)``, to which a second-order mesh comes near; the wall it takes at most."""
    pytest.importorskip("openmdao.api")
    found, made = numbers("twisting_wing", pictures), script("twisting_wing")
    for speed in made.SPEEDS:
        tip = made.exact(made.SPAN, made.pressure(speed))
        assert found[f"tip at {speed:g}"] == pytest.approx(tip, rel=5e-3)
    needed = made.pressure(made.SPEED) * made.CHORD * made.AHEAD * made.SLOPE * made.SPAN**2
    needed /= math.acos(1 / (1 + made.MOST)) ** 2 * made.G * 2 * math.pi * made.RADIUS**3
    assert found["uniform wall"] == pytest.approx(needed, rel=1e-3)
    assert found["mass"] < 0.9 * found["uniform mass"]
    assert found["tip"] == pytest.approx(made.MOST * made.ATTACK, rel=1e-6)


def test_the_shape_of_a_truss_by_the_method_of_joints(pictures: Path) -> None:
    """It is statically determinate: forces by balance alone; lighter than the 4,530 lb printed."""
    found, made = numbers("truss_shape", pictures), script("truss_shape")
    assert found["success"] and found["mass [lb]"] < 4530
    places = {k: np.array(at) for k, at in made.places(found).items()}
    free = [k for k in places if k not in (10, 11)]
    area = {k: found[name] for name, members in made.GROUPS.items() for k in members}
    balance, loads = np.zeros((2 * len(free), len(made.BARS))), np.zeros(2 * len(free))
    lengths = np.array([np.linalg.norm(places[j] - places[i]) for i, j in made.BARS])
    for k, ends in enumerate(made.BARS):
        for here, there in (ends, ends[::-1]):
            if here in free:
                row = 2 * free.index(here)
                balance[row : row + 2, k] = (places[there] - places[here]) / lengths[k]
    for node in made.LOADED:
        loads[2 * free.index(node) + 1] = made.FORCE
    areas = np.array([area[k] for k in range(len(made.BARS))])
    stress = np.linalg.solve(balance, loads) / areas
    assert np.all(abs(stress) < (1 + 1e-6) * made.STRONGEST)
    assert np.all(-stress < (1 + 1e-6) * 4 * made.MODULUS * areas / lengths**2)
    assert made.DENSITY * areas @ lengths == pytest.approx(found["mass [lb]"] * made.POUND)
