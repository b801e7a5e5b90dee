"""Impacts of compliant laws against quadratures and closed forms.

Of ``m δ̈ = −K δⁿ (1 + d δ̇/v₀)`` the speed after the impact follows from ``(1 + e) d = ln[(1 + d) /
(1 − d e)]``, the depth from ``δ^{n+1} = (n+1) m v₀²/K [1/d − ln(1+d)/d²]`` (Hunt and Crossley 1975,
integrated in closed form); the undamped impact lasts 2.943275 δ/v₀ (Hertz).
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

kit = planar.contact
STIFFNESS, SPEED, GAP = 1e8, 1.0, 1e-3

ACHIEVED = {
    (kit.HuntCrossley, 0.9): 0.90901574,
    (kit.HuntCrossley, 0.5): 0.66296220,
    (kit.LankaraniNikravesh, 0.9): 0.91317668,
    (kit.LankaraniNikravesh, 0.5): 0.72524111,
    (kit.Flores, 0.9): 0.89392069,
    (kit.Flores, 0.5): 0.47044478,
}
"""What each law achieves where a restitution is asked for."""
DAMPED = 6.655259e-4, 2.050538e-3
"""Depth and duration of Lankarani's and Nikravesh's law with e = 0.9."""
DEPTH = (1.25 * SPEED**2 / STIFFNESS) ** 0.4
UNDAMPED = DEPTH, 2 * math.sqrt(math.pi) * math.gamma(1.4) / math.gamma(0.9) * DEPTH / SPEED
"""Of Hertz's, 6.898647e-4 m and 2.943275 δ/v₀."""


def impact(law, duration: float = 0.02, **options) -> da.Motion:
    """A ball of 1 kg that meets the floor with 1 m/s after a millimetre."""
    system = da.System("ball")
    ball = planar.Particle("ball", mass=1.0, position=(0, GAP), velocity=(0, -SPEED))
    ball = system.add(ball)
    floor = kit.HalfPlane(system.ground.point(0, 0))
    system.add(planar.Contact("floor", floor, ball.center, law=law))
    integrator = da.DormandPrince853(rtol=1e-12, atol=1e-14)
    return da.solve_dynamics(system.build(), duration, integrator=integrator, **options)


@pytest.mark.few(3)
@pytest.mark.parametrize(("kind", "restitution"), ACHIEVED)
def test_the_restitution_that_laws_achieve(kind, restitution):
    law = kind(stiffness=STIFFNESS, restitution=restitution, impact_speed=SPEED)
    motion = impact(law)
    assert motion.status.success
    assert motion["ball.vy"].values[-1] == pytest.approx(ACHIEVED[kind, restitution], abs=1e-6)
    factor = float(law.factor())
    assert kit.achieved_restitution(factor) == pytest.approx(ACHIEVED[kind, restitution], abs=1e-8)
    assert np.abs(motion.data.balance_error).max() < 1e-9


@pytest.mark.few(6)
@pytest.mark.parametrize("restitution", [0.1, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_a_restitution_that_is_asked_for_can_be_had(restitution, exponent):
    """By the factor that belongs to it, whatever the exponent."""
    damping = kit.damping_factor(restitution) / SPEED
    law = kit.HuntCrossley(stiffness=STIFFNESS, damping=damping, exponent=exponent)
    computed = impact(law, duration=0.05)["ball.vy"].values[-1]
    assert computed == pytest.approx(restitution, abs=1e-7)


@pytest.mark.parametrize(
    ("law", "depth", "lasts"),
    [
        (kit.LankaraniNikravesh(stiffness=1e8, restitution=0.9, impact_speed=1.0), *DAMPED),
        (kit.Hertz(stiffness=1e8), *UNDAMPED),
    ],
)
def test_depth_and_duration(law, depth, lasts):
    motion = impact(law, duration=0.01, events={"deepest": "ball.vy", "touch": "ball.y"})
    times = motion.data.event_time.values
    begin, deepest, end = np.sort(times[times > 0])
    computed = da.at(float(deepest), "floor.penetration")
    assert da.evaluate(motion, computed) == pytest.approx(depth, rel=2e-7)
    assert end - begin == pytest.approx(lasts, rel=2e-7)
