"""The woodpecker toy (Pfeiffer and Glocker 1996; data and states of the Siconos example).

A bird on a spring, on a sleeve with play on a pole: impacts with and without bounce, sticking,
sliding and free flight in every cycle. The published states are of a time-stepping scheme as its
step vanishes; the start lets the sleeve stand 0.9 µm inside the pole, where it counts as touching.
"""

from __future__ import annotations

import numpy as np

import dalembert as da
from dalembert import planar

M_SLEEVE, M_BIRD, J_SLEEVE, J_BIRD, C, G = 0.0003, 0.0045, 5e-9, 7e-7, 0.0056, 9.81
L_M, L_G, L_S, H_S, H_M, R_M, R_O = 0.01, 0.015, 0.0201, 0.02, 0.0058, 0.0031, 0.0025
PHI_M, PHI_S, SPEED, RATE = -0.1036, -0.2788, -0.3411, -7.4583
STATES = {  # time: height of the sleeve, angle of the bird
    0.02: (-0.004373548, -0.452309979),
    0.06: (-0.004407447, -0.226943905),
    0.10: (-0.0070669, 0.0076585),
}


def woodpecker() -> da.Model:
    system = da.System("woodpecker", gravity=(0, -G))
    sleeve = system.add(
        planar.Body(
            "sleeve",
            mass=M_SLEEVE,
            inertia=J_SLEEVE,
            position=(0, 0),
            angle=PHI_M,
            velocity=(0, SPEED),
        )
    )
    bird = system.add(
        planar.Body(
            "bird",
            mass=M_BIRD,
            inertia=J_BIRD,
            position=(0, L_M * PHI_M + L_G * PHI_S),
            angle=PHI_S,
            velocity=(0, SPEED + L_G * RATE),
            angular_velocity=RATE,
        )
    )
    system.add(planar.UserConstraint("pole", sleeve.x))
    system.add(planar.UserConstraint("upright", bird.x))
    arm = sleeve.y + L_M * sleeve.angle + L_G * bird.angle
    system.add(planar.UserConstraint("arm", bird.y - arm))
    system.add(planar.TorsionSpring("spring", sleeve, bird, stiffness=C))
    play = R_M - R_O
    beak_slip = sleeve.vy + L_M * sleeve.angular_velocity + (L_G - L_S) * bird.angular_velocity
    slip = sleeve.vy + R_M * sleeve.angular_velocity
    for name, gap, along, e in (
        ("beak", L_M + L_G - L_S - R_O - H_S * bird.angle, beak_slip, 0.5),
        ("lower", -H_M * PHI_M + H_M * sleeve.angle, slip, 0.0),
        ("upper", play - H_M * sleeve.angle, slip, 0.0),
    ):
        system.add(planar.UnilateralConstraint(name, gap, along, restitution=e, friction=0.3))
    return system.build()


def test_published_states():
    motion = da.solve_dynamics(
        woodpecker(), 0.11, outputs=[0.0, *STATES], integrator=da.DormandPrince()
    )
    assert motion.status.success and not motion.warnings
    assert [impact.name for impact in motion.impacts] == ["upper", "beak", "upper"]
    computed = np.column_stack([motion.values("sleeve.y"), motion.values("bird.angle")])[1:]
    np.testing.assert_allclose(computed, list(STATES.values()), atol=1e-6)
