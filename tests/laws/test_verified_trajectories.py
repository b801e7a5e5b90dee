"""Plans that their verifying run decides: no plan is better than the motion that is possible."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


def gyroscopic(push: float) -> da.Model:
    """A particle of 1 kg at 1 m/s under a force across its velocity: its speed cannot change."""
    system = da.System("gyroscopic")
    p = system.parameter("push", 0.0, "N s/m", bounds=(-push, push))
    mass = system.add(planar.Particle("mass", mass=1.0, position=(0, 0), velocity=(1, 0)))
    system.add(planar.Force("force", mass.center, (-p * mass.vy, p * mass.vx)))
    return system.build()


def shortest(push: float, x: float, y: float) -> float:
    """Time to a point: an arc of the radius 1/push, then a straight line (Dubins 1957)."""
    radius, y = 1 / push, abs(y)
    away = math.hypot(x, y - radius)
    angle = math.atan2(y - radius, x) - math.acos(radius / away)
    return radius * ((angle + math.pi / 2) % (2 * math.pi)) + math.sqrt(away**2 - radius**2)


@pytest.mark.few(1)
@pytest.mark.parametrize("method", [da.DirectCollocation(30), da.MultipleShooting(20)])
@pytest.mark.parametrize(("push", "x", "y"), [(10.0, -0.3, 0.2), (5.0, 0.4, -0.3)])
def test_a_singular_arc_is_not_exploited(push, x, y, method):
    """On the straight line nothing decides the control but the polynomials, which it exploited."""
    end = {"mass.x": x, "mass.y": y}
    best = da.optimize_trajectory(
        gyroscopic(push), da.final("time"), ["push"], (0.1, 3), end=end, method=method
    )
    exact = shortest(push, x, y)
    assert best.success and -1e-5 < best.duration - exact < 3e-4
    assert max(best.deviation, best.step_error) < 1e-4
    np.testing.assert_allclose([best.motion.values(n)[-1] for n in end], (x, y), atol=1e-4)
    if isinstance(method, da.DirectCollocation):
        assert "chattered" in best.warnings[0] and best.warnings == best.summary()["warnings"]


def test_a_run_that_misses_is_no_success():
    """An accuracy that no refinement reaches is a status with the distance."""
    best = da.optimize_trajectory(
        *(gyroscopic(10.0), da.final("time"), ["push"], (0.1, 3)),
        end={"mass.x": -0.3, "mass.y": 0.2},
        method=da.DirectCollocation(8),
        accuracy=1e-12,
    )
    assert not best.success and best.status.outcome is da.Outcome.NOT_CONVERGED
    assert "natural sizes away from the plan" in best.message and best.intervals > 8


def cart(push: float, start: float = 0.0) -> da.Model:
    system = da.System("cart")
    force = system.parameter("push", 0.0, "N", bounds=(-push, push))
    body = system.add(planar.Particle("cart", mass=1.0, position=(start, 0)))
    system.add(planar.PinInSlot("rail", system.ground.point(0, 0), body.center))
    system.add(planar.Force("force", body.center, (force, 0)))
    return system.build()


def test_bang_bang_with_a_limit_on_the_way():
    """``v ≤ 1.2``: 0.3 s up, 0.5333 s at the limit, 0.3 s down."""
    limit = da.Limit(da.maximum("cart.vx"), upper=1.2)
    end = {"cart.x": 1, "cart.vx": 0}
    best = da.optimize_trajectory(
        cart(4.0), da.final("time"), ["push"], (0.2, 3), end=end, subject_to=[limit]
    )
    assert best.success and best.duration == pytest.approx(1.13333, abs=1e-3)


def test_fullers_problem():
    """Infinitely many switches in a finite time: ``min ∫x²``; V(1, 0) = 0.76402 by its symmetry."""
    best = da.optimize_trajectory(
        cart(1.0, 1.0), da.integral("cart.x**2"), ["push"], 4.0, end={"cart.x": 0, "cart.vx": 0}
    )
    assert best.success and fuller() < best.fun < fuller() + 2e-4


def fuller() -> float:
    """Cost from (1, 0): ``u = −sign(x + C v|v|)``, ``C = √((√33 − 1)/24)`` (Fuller 1963).

    Each arc from ``(x, 0)`` to the next is the one before, smaller by a factor; the costs are a
    geometric series with its fifth power of the square root.
    """
    c = math.sqrt((math.sqrt(33) - 1) / 24)
    t1 = math.sqrt(1 / (0.5 + c))  # 1 − t²/2 = C t²
    x1, v1 = 1 - t1**2 / 2, -t1
    t2 = -v1  # up to v = 0
    x2 = x1 + v1 * t2 + t2**2 / 2
    s = np.polynomial.Polynomial
    first, second = (s([1, 0, -0.5]) ** 2).integ()(t1), (s([x1, v1, 0.5]) ** 2).integ()(t2)
    return float((first + second) / (1 - abs(x2) ** 2.5))


def test_long_steps_of_a_shooting_method_are_refined():
    """Two trapezia in an interval made the force of a block 11 % too cheap: 12 x²/T³ is exact."""
    method = da.MultipleShooting(intervals=8, steps=2, integrator=da.Trapezoidal())
    end = {"cart.x": 1, "cart.vx": 0}
    best = da.optimize_trajectory(
        cart(20.0), da.integral("push**2"), ["push"], 1.0, end=end, method=method
    )
    assert not best.success or best.fun == pytest.approx(12.0, rel=2e-3)
