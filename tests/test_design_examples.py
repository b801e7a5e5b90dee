"""Examples of decisions under doubt: each has a number found elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from test_examples import numbers, pictures, script  # noqa: F401


def test_arm_is_identified(pictures: Path) -> None:  # noqa: F811
    """The true values are known, for the data were made with them."""
    found, made = numbers("identified_arm", pictures), script("identified_arm")
    for name, value in made.TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.05)
    assert found["noise"] == pytest.approx(made.NOISE, rel=0.15)


def test_truss_is_as_reliable_as_the_closed_form(pictures: Path) -> None:  # noqa: F811
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
