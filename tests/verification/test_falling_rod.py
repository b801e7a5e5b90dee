"""Rod that falls on a rigid floor, up to its second blow, by the law of Lankarani and Nikravesh.

m = 1 kg, J = 0.01 kg m², 2 m long, from (0, 1) at 45° with 6 m/s downwards; K = 1e11 N/m^1.5,
e = 0.95. The Exudyn project stores for t = 0.1 s: y = 0.364062, φ = 1.712599 from π/4,
v_y = −6.733518, ω = 17.500277. By Newton's impact with the restitution that the law achieves, the
blow is (1 + e*) v / (1/m + l² cos²φ/J).
"""

from __future__ import annotations

import math

import pytest

import dalembert as da
from dalembert import planar

kit = planar.contact
FALL = (1 - math.sin(math.pi / 4), 6.0, 9.81)
APPROACH = math.sqrt(FALL[1] ** 2 + 2 * FALL[2] * FALL[0])


def fall() -> da.Motion:
    system = da.System("falling rod", gravity=(0.0, -FALL[2]))
    start = {"position": (0, 1), "angle": -math.pi / 4, "velocity": (0, -FALL[1])}
    rod = system.add(planar.Body("rod", mass=1.0, inertia=0.01, angular_velocity=0.0, **start))
    law = kit.LankaraniNikravesh(stiffness=1e11, restitution=0.95, impact_speed=APPROACH)
    for name, x in (("left", -1), ("right", 1)):
        floor = kit.HalfPlane(system.ground.point(0, 0))
        system.add(planar.Contact(name, floor, rod.point(x, 0), law=law))
    integrator = da.DormandPrince853(rtol=1e-11, atol=1e-13)
    return da.solve_dynamics(system.build(), 0.1, integrator=integrator)


def test_blow_and_flight():
    motion = fall()
    y, angle, speed, spin = (
        float(motion[f"rod.{name}"].values[-1]) for name in ("y", "angle", "vy", "angular_velocity")
    )
    achieved = kit.achieved_restitution(0.75 * (1 - 0.95**2))
    arm = math.cos(math.pi / 4)
    blow = (1 + achieved) * APPROACH / (1 / 1.0 + arm**2 / 0.01)
    assert spin == pytest.approx(blow * arm / 0.01, rel=2e-4)  # the rod turns while it touches
    assert spin == pytest.approx(17.5002777404618, rel=3e-3)
    assert speed == pytest.approx(-6.73351754301893, rel=3e-3)
    assert y == pytest.approx(0.364062123954456, rel=3e-3)
    assert angle + math.pi / 2 == pytest.approx(1.7125984719724, rel=3e-3)
