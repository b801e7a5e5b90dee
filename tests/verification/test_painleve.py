"""A rod that slides on its tip: rigid friction has no motion above a limit (Painlevé 1895).

For a uniform rod at the angle θ the limit is ``μ = (1 + 3 cos²θ)/(3 sin θ cos θ)``; the least,
4/3, is at ``tan θ = 2``.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.results.status import Outcome

THETA = np.arctan(2.0)


def sliding(friction: float, speed: float, theta: float = THETA) -> da.Model:
    system = da.System("rod", gravity=(0, -9.81))
    place = (np.cos(theta) / 2, np.sin(theta) / 2)
    rod = system.add(
        planar.Body(
            "rod", mass=1.0, inertia=1 / 12, position=place, angle=theta, velocity=(speed, 0)
        )
    )
    tip = rod.point(-0.5, 0)
    mu = system.parameter("mu", friction)
    system.add(
        planar.UnilateralConstraint("tip", tip.y, tip.velocity[0], restitution=0, friction=mu)
    )
    return system.build()


def slides(friction: float, speed: float, theta: float = THETA) -> da.Motion:
    model = sliding(friction, speed, theta)
    return da.solve_dynamics(model, 1e-3, integrator=da.DormandPrince())


@pytest.mark.few(1)
@pytest.mark.parametrize("theta", [THETA, 0.9])
def test_limit(theta):
    limit = (1 + 3 * np.cos(theta) ** 2) / (3 * np.sin(theta) * np.cos(theta))
    assert slides(0.999 * limit, -1.0, theta).status.success
    jammed = slides(1.001 * limit, -1.0, theta).status
    assert jammed.outcome is Outcome.UNDECIDED and "tip" in jammed.message
    assert slides(1.001 * limit, 1.0, theta).status.success  # the other way it never jams
    assert limit >= 4 / 3 - 1e-12


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean(projection=False)])
def test_steps_with_impulses_jam(scheme):
    """An impact without a collision: the tip stops, ``ω = v l/2 sin θ/(l²/3)`` about it."""
    motion = da.solve_nonsmooth(sliding(3.0, -3.0), 1e-3, step=1e-3, integrator=scheme)
    assert motion.status.success
    turning = 3.0 * np.sin(THETA) / 2 * 3
    assert motion.values("rod.angular_velocity")[-1] == pytest.approx(turning, rel=5e-3)
    assert abs(motion.values("tip.slip")[-1]) < 5e-3
