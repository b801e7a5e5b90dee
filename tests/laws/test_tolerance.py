"""Tolerances: scatter and worst case against closed forms, and the cheapest allocation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

import dalembert as da
from dalembert import planar

HALF = {"r": 0.2e-3, "l": 0.5e-3, "off": 1e-3}
ANALYSIS = da.Kinematics(0.4, outputs=3)


@pytest.fixture(scope="module")
def crank():
    system = da.System("slider-crank")
    r, length = system.parameter("r", 0.1, "m"), system.parameter("l", 0.3, "m")
    off = system.parameter("off", 0.05, "m")
    crank = system.add(planar.Bar("crank", length=r, mass=1.0))
    rod = system.add(planar.Bar("rod", length=length, mass=1.0))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=1.0, position=(0.4, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("rail", system.ground.point(0, off), slider.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 2 * da.t))
    return system.build()


def place(z) -> float:
    """Slider at the end, ``r cos q + √(l² − (off − r sin q)²)``, tolerances used up by ``z``."""
    r, l, off = np.array([0.1, 0.3, 0.05]) + np.array(list(HALF.values())) * z
    return r * math.cos(0.8) + math.sqrt(l**2 - (off - r * math.sin(0.8)) ** 2)


def test_scatter_and_worst_case_of_a_slider(crank):
    result = da.tolerance(
        crank, da.final("slider.x", name="place"), HALF, analysis=ANALYSIS, samples=200
    )
    assert result.nominal == pytest.approx(place(np.zeros(3)), abs=1e-12)
    steps = 1e-3 * np.eye(3)
    slopes = [(place(s) - place(-s)) / 2e-3 for s in steps]
    np.testing.assert_allclose(list(result.effects.values()), slopes, rtol=1e-7)
    corners = [place(2 * np.array(corner) - 1) for corner in np.ndindex(2, 2, 2)]
    assert result.worst == pytest.approx((min(corners), max(corners)), abs=1e-12)
    assert result.std == pytest.approx(np.linalg.norm(slopes) / 3)
    assert result.first_order_worst == pytest.approx(np.sum(np.abs(slopes)))
    assert np.std(result.sampled) == pytest.approx(result.std, rel=0.2)
    assert sum(result.contributions.values()) == pytest.approx(1)
    assert "place" in repr(result) and "share" in result._repr_html_()


def test_second_order_is_exact_for_a_quadratic(crank):
    """``(r − 0.1)²`` has no first order; its mean is the variance."""
    square = da.final("(r - 0.1)**2*1e6 + (r - 0.1)*(l - 0.3)*1e6", name="square")
    result = da.tolerance(crank, square, {"r": 3e-3, "l": 6e-3}, analysis=ANALYSIS)
    mean, std = result.second_order
    assert result.std == pytest.approx(0, abs=1e-9)
    assert mean == pytest.approx(1.0, rel=1e-6)
    assert std == pytest.approx(math.sqrt(2 + 1 * 4), rel=1e-6)  # var r² = 2σ⁴, var rl = σ²τ²
    assert result.worst[1] == pytest.approx(9 + 18, rel=1e-6)


@pytest.mark.parametrize("worst_case", [False, True])
def test_cheapest_allocation(crank, worst_case):
    """As a general optimiser finds it, and cheaper than equal tolerances."""
    result = da.tolerance(crank, da.final("slider.x"), HALF, analysis=ANALYSIS)
    costs, limit = {"r": 1.0, "l": 2.0, "off": 0.5}, 0.4e-3
    g = np.abs([result.effects[n] / HALF[n] for n in HALF])
    c = np.array(list(costs.values()))

    def size(t):
        return float(np.sum(g * t)) if worst_case else float(np.linalg.norm(g * t))

    top = {"r": (0.0, 1.0), "l": (0.0, 0.25e-3), "off": (0.0, 1.0)}
    for bounds in ((0.0, np.inf), top):
        allocation = result.allocate(limit, costs, bounds=bounds, worst_case=worst_case)
        t = np.array(list(allocation.values()))
        assert size(t) == pytest.approx(limit, rel=1e-9)
        best = minimize(
            lambda s: np.sum(c / s) / 1e4,
            np.full(3, 0.1),
            bounds=[(1e-3, 0.25 if bounds is top and n == "l" else None) for n in HALF],
            constraints={"type": "ineq", "fun": lambda s: 0.4 - size(s)},
            options={"ftol": 1e-14, "maxiter": 500},
        )
        assert np.sum(c / t) == pytest.approx(1e3 * 1e4 * best.fun, rel=1e-5)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m, **k: da.tolerance(m, da.final("slider.x"), {}, **k), "no tolerances"),
        (lambda m, **k: da.tolerance(m, da.final("slider.x"), {"q": 1.0}, **k), "unknown param"),
        (lambda m, **k: da.tolerance(m, da.final("slider.x"), {"r": -1.0}, **k), "above zero"),
        (lambda m, **k: da.tolerance(m, da.final("slider.x"), {"off": 9.0}, **k), "a run fails"),
        (
            lambda m, **k: da.tolerance(m, da.final("slider.x"), HALF, **k).allocate(1, {"r": 1}),
            "cost above zero for l, off",
        ),
        (
            lambda m, **k: da.tolerance(m, da.final("slider.x"), HALF, **k).allocate(
                1e-6, dict.fromkeys(HALF, 1.0), bounds=(1e-3, 1.0)
            ),
            "already deviate",
        ),
    ],
)
def test_invalid_arguments_are_refused(crank, call, message):
    with pytest.raises(da.DalembertError, match=message):
        call(crank, analysis=ANALYSIS)
