"""Design points of arbitrary limit states: the nearest one, or a warning with a number."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr

import dalembert as da

N = da.Normal(0.0, 1.0)
TURN = np.linspace(0, 2 * np.pi, 1441)
RADII = np.linspace(0.005, 9.0, 1800)


def random_limit(rng: np.random.Generator) -> str:
    """Bent, wavy, saddle-shaped surfaces in two variables, at 1 to 4 deviations or so."""
    a, b, c, d, e, w = rng.normal(size=6) * [1, 1, 0.4, 0.4, 0.4, 0.6]
    level = rng.uniform(1, 5) * max(abs(a), abs(b))
    wave = f"{w:.6f}*sin({rng.uniform(1, 4):.4f}*a + {rng.uniform(0, 6):.4f})"
    bent = f"{c:.6f}*a**2 + {d:.6f}*b**2 + {e:.6f}*a*b"
    return f"{level:.6f} + {a:.6f}*a + {b:.6f}*b + {bent} + {wave}"


def polar(formula: str) -> tuple[float, float]:
    """Distance of the nearest point of failure, and probability, on a polar grid."""
    x, y = (np.outer(RADII, f(TURN)) for f in (np.cos, np.sin))
    g = eval(formula, {"a": x, "b": y, "sin": np.sin, "cos": np.cos})
    failed = g < 0
    rings = np.flatnonzero(failed.any(axis=1))
    nearest = float(RADII[rings[0]]) if rings.size else np.inf
    share = failed[:, :-1].mean(axis=1)
    return nearest, float(np.trapezoid(share * RADII * np.exp(-(RADII**2) / 2), RADII))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("count", "least"), [(30, 7), pytest.param(60, 15, marks=pytest.mark.thorough)]
)
def test_random_limit_states(count, least):
    """The nearest point is reported; first order is right within 50 % or a warning says so."""
    rng = np.random.default_rng(5)
    missed = []
    for _ in range(count):
        formula = random_limit(rng)
        nearest, exact = polar(formula)
        if nearest > 6 or nearest < 0.1:
            continue
        result = da.reliability(None, formula, {"a": N, "b": N})
        assert not result.success or abs(result.point.beta - nearest) < 0.02, formula
        if result.success and not result.warnings:
            missed.append(abs(result.probability / exact - 1) > 0.5)
    assert len(missed) > least and not any(missed)


def test_a_point_that_curves_strongly_converges():
    """At β = 1.185 the surface bends away with βκ = 15; the next point is at 2.37."""
    formula = "sin(5*a/2) + 2 - (a**2 + 4)*(b - 1)/20"
    random = {"a": da.Normal(1.5, 1), "b": da.Normal(2.5, 1)}
    shifted = formula.replace("(b - 1)", "(b + 1.5)").replace("a", "(a + 1.5)")
    nearest, exact = polar(shifted)
    for starts in (1, 20):
        result = da.reliability(None, formula, random, starts=starts)
        assert result.success and result.point.beta == pytest.approx(nearest, abs=0.01)
        assert result.sorm.breitung == pytest.approx(exact, rel=0.1)
        assert any("to second order" in text for text in result.warnings)
        assert result.warnings == result.summary()["warnings"]
    low, high = result.importance_sampling(20_000).interval
    assert low < exact < high


def test_a_search_that_does_not_converge_keeps_its_rank():
    """A method that oscillates at the nearest point is no success by the next one."""
    random = {"a": da.Normal(1.5, 1), "b": da.Normal(2.5, 1)}
    formula = "sin(5*a/2) + 2 - (a**2 + 4)*(b - 1)/20"
    slow = {"method": "improved-hlrf", "max_iterations": 12}
    result = da.reliability(None, formula, random, starts=6, **slow)
    assert not result.success and not result.points[0].converged


@pytest.mark.parametrize(
    ("formula", "exact"),
    [
        ("a**2 - 4", 1 - 2 * ndtr(-2)),  # the median fails, the failed region is a strip
        ("64 - a**2", 2 * ndtr(-8.0)),  # a sum of two tails that 1 − p would lose
        ("(a - 2)*(a - 3)", ndtr(-2) - ndtr(-3)),
    ],
)
def test_both_sides_of_a_strip(formula, exact):
    assert da.reliability(None, formula, {"a": N, "b": N}).probability == pytest.approx(
        exact, rel=0.1
    )


def test_a_thin_layer_of_failure_is_reported():
    result = da.reliability(None, "(a - 2)*(a - 2.05)", {"a": N, "b": N})
    assert any("safe again" in text for text in result.warnings)


def test_a_series_of_many_planes():
    """Sixteen planes about the origin at one distance, far out: the relative error is small."""
    turn = 2 * np.pi * np.arange(16) / 16
    limits = [f"7 - {math.cos(k)!r}*a - {math.sin(k)!r}*b" for k in map(float, turn)]
    result = da.reliability(None, limits, {"a": N, "b": N}, starts=1)
    radius = 7 / np.cos((TURN + np.pi / 16) % (np.pi / 8) - np.pi / 16)
    exact = np.mean(np.exp(-(radius[:-1] ** 2) / 2))
    assert result.probability == pytest.approx(exact, rel=2e-3)
