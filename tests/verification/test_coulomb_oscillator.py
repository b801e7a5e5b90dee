"""A mass on a spring with dry friction: it sticks for ever at ``x = 15 − √205``.

``m = k = 1``, ``|F| ≤ 1``, from ``x = 12`` at the speed 6: arcs of circles about ``x = ±1``. It
stops where the spring pulls with less than the friction, after ``atan(6/13) + 7π`` (the oscillator
of the examples of Siconos; here in closed form).
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "options", [{"integrator": da.DormandPrince853(rtol=1e-11)}, {"step": 0.01}]
)
def test_sticks(options):
    system = da.System("oscillator", gravity=(0, -10.0))
    k = system.parameter("k", 1.0)
    start = system.parameter("x0", 12.0)
    mass = system.add(planar.Particle("mass", mass=1.0, position=(start, 0), velocity=(6, 0)))
    system.add(planar.Force("spring", mass.center, (-k * mass.x, 0)))
    floor = planar.UnilateralConstraint("floor", mass.y, mass.vx, restitution=0, friction=0.1)
    system.add(floor)
    model = system.build()
    motion = da.solve_dynamics(model, 25.0, **options)
    assert motion.status.success and not motion.warnings
    steps, kernel = motion.record.steps, motion.record.kernel
    stuck = steps.t[kernel.crossings(steps)[-1][0]]
    assert stuck == pytest.approx(np.arctan2(6, 13) + 7 * np.pi, abs=3e-8)
    x = motion.values("mass.x")
    assert x[-1] == pytest.approx(15 - np.sqrt(205), abs=1e-8)
    assert x[-1] == pytest.approx(0.6821789367, abs=1e-8)
    at_rest = motion.time > stuck
    assert np.ptp(x[at_rest]) == 0.0  # it sticks, and does not creep
    assert motion.values("floor.friction_force")[-1] == pytest.approx(x[-1], rel=1e-12)
    # the arcs lie about ±1 in turn, so it stops at 15 − √((x0 + 1)² + 6²)
    computed = [
        da.sensitivity(motion, da.final(model["mass.x"]), method=m).sel(parameter="x0").item()
        for m in ("direct", "adjoint")
    ]
    assert computed[0] == pytest.approx(computed[1], rel=1e-11)
    assert computed[0] == pytest.approx(-13 / np.sqrt(205), rel=1e-6)
