"""Car axis problem: stiff springs, a moving bump and two constraints, index 3.

Source: Bari test set for initial value problem solvers, problem "Car axis" (F. Mazzia and
C. Magherini); reference solution at t = 3 as stored in the R package deTestSet.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

EPSILON, M, L, L0, R, W = 1e-2, 10.0, 1.0, 0.5, 0.1, 10.0
MASS = M * EPSILON**2 / 2
POSITION = [
    (0.0493455784275402809, 0.496989460230171153861),
    (1.04174252488542151681, 0.373911027265361256927),
]
VELOCITY = [
    (-0.0770583684040972358, 0.00744686658723778553),
    (0.0175568157537232222, 0.770341043779251976443),
]
MULTIPLIERS = (-0.00473688659084893325, -0.00110468033125734369)


def axle() -> da.System:
    system = da.System("car-axis", gravity=(0.0, -1.0))
    left = system.add(planar.Particle("left", mass=MASS, position=(0, 0.5), velocity=(-0.5, 0)))
    right = system.add(planar.Particle("right", mass=MASS, position=(1, 0.5), velocity=(-0.5, 0)))
    yb = R * da.sin(W * da.t)
    xb = (L**2 - yb**2) ** 0.5
    bump = system.ground.point(xb, yb)
    system.add(
        planar.Spring(
            "wheel_left", system.ground.point(0, 0), left.center, stiffness=1.0, free_length=L0
        )
    )
    system.add(planar.Spring("wheel_right", bump, right.center, stiffness=1.0, free_length=L0))
    system.add(planar.UserConstraint("upright", xb * left.x + yb * left.y))
    system.add(planar.RigidLink("axle", left.center, right.center, length=L))
    return system


def test_state_and_multipliers_at_the_end():
    motion = da.solve_dynamics(
        axle().build(), 3.0, integrator=da.DormandPrince(1e-12, 1e-13), outputs=[3.0]
    )
    np.testing.assert_allclose(motion.data.position[0], POSITION, atol=1e-9)
    np.testing.assert_allclose(motion.data.velocity[0], VELOCITY, atol=1e-9)
    # the reference writes forces as +Cᵀλ, and the axle as |d|² − L²
    upright, link = motion.data.multiplier.values[0]
    assert -upright == pytest.approx(MULTIPLIERS[0], abs=1e-9)
    assert -link / (2 * L) == pytest.approx(MULTIPLIERS[1], abs=1e-9)


@pytest.mark.few(3)
@pytest.mark.parametrize(
    "formulation", [da.DAE(2), da.DAE(2, stabilized=True), da.DAE(3)], ids=["2", "stabilised", "3"]
)
@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection()], ids=repr)
def test_backward_differentiation_of_every_index(formulation, stabilization):
    """Positions and speeds at the end; the loads move at up to 100 rad/s, over 3 s."""
    motion = da.solve_dynamics(
        axle().build(),
        3.0,
        integrator=da.BDF(1e-9, 1e-10),
        formulation=formulation,
        stabilization=stabilization,
        outputs=[3.0],
    )
    np.testing.assert_allclose(motion.data.position[0], POSITION, atol=1e-6)
    np.testing.assert_allclose(motion.data.velocity[0], VELOCITY, atol=1e-5)
