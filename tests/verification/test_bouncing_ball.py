"""A ball that bounces to rest: heights ``e²ⁿ h``, at rest after ``√(2h/g) (1+e)/(1−e)``.

The bounces are infinitely many in finite time (Zeno); see e.g. Brogliato 2016, Nonsmooth Mechanics.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, HEIGHT, E = 9.81, 1.0, 0.5


def bounces(**options):
    system = da.System("ball", gravity=(0, -G))
    e = system.parameter("restitution", E)
    ball = system.add(planar.Particle("ball", mass=2.0, position=(0, HEIGHT)))
    system.add(planar.UnilateralConstraint("floor", ball.y, restitution=e))
    return da.solve_dynamics(system.build(), 2.0, **options)


@pytest.mark.parametrize("options", [{"integrator": da.DormandPrince()}, {"step": 0.01}])
def test_ball_comes_to_rest(options):
    motion = bounces(**options)
    assert motion.status.success and not motion.warnings
    fall = np.sqrt(2 * HEIGHT / G)
    times = np.array([impact.time for impact in motion.impacts])
    count = times.size
    flights = fall * (1 + 2 * np.cumsum(E ** np.arange(1, count)))
    np.testing.assert_allclose(times, [fall, *flights], rtol=1e-12)
    speeds = np.array([impact.normal for impact in motion.impacts[:-1]]) / 2.0 / (1 + E)
    np.testing.assert_allclose(speeds, G * fall * E ** np.arange(count - 1), atol=1e-13)
    assert times[-1] == pytest.approx(fall * (1 + E) / (1 - E), abs=1e-8)
    assert motion.values("ball.y")[-1] == 0.0
    assert motion.values("floor.normal_force")[-1] == pytest.approx(2.0 * G, rel=1e-14)
    assert "floor at t = 1.35" in motion.statistics["accumulation of impacts"]
    assert np.abs(motion.data["balance_error"]).max() < 1e-12


def test_gradient_says_that_bounces_accumulate():
    motion = bounces(integrator=da.DormandPrince())
    gradient = da.sensitivity(motion, da.final(motion.model["ball.y"]))
    assert ["bounces of floor accumulate" in note for note in gradient.attrs["notes"]].count(
        True
    ) == 1
    assert not any("grazed" in note for note in gradient.attrs["notes"])
