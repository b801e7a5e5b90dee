"""A block pushed sideways on an incline, with dry friction (the curve is in books of mechanics).

With the downhill pull ``a = g sin α``, ``κ = μ/tan α`` and the angle ``φ`` between velocity and
downhill, ``v̇ = a cos φ − κ a`` and ``v φ̇ = −a sin φ``, so ``v sin φ = C tan^κ(φ/2)``. From
``φ = 90°`` a block with ``κ > 1`` comes to rest after

    t = κ v₀/(a (κ² − 1)),   x = v₀²/(4 a (κ² − 1)),   y = 2 κ v₀²/(a (4 κ² − 1)).

Before the stop it turns downhill ever faster, as a power of what is left of the slip.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

G, ANGLE, SPEED, MASS = 9.81, 0.3, 2.0, 1.3
PULL = G * np.sin(ANGLE)


def pushed(kappa: float) -> da.Model:
    system = da.System("incline", gravity=(PULL, 0, -G * np.cos(ANGLE)))
    rough = system.parameter("mu", kappa * np.tan(ANGLE))
    speed = system.parameter("v", SPEED)
    block = system.add(
        spatial.Particle("block", mass=MASS, position=(0, 0, 0), velocity=(0, speed, 0))
    )
    slips = block.vx, block.vy
    system.add(spatial.UnilateralConstraint("plane", block.z, slips, restitution=0, friction=rough))
    return system.build()


def rest(kappa: float, speed: float = SPEED) -> tuple[float, np.ndarray]:
    time = kappa * speed / (PULL * (kappa**2 - 1))
    downhill = speed**2 / (4 * PULL * (kappa**2 - 1))
    return time, np.array([downhill, 2 * kappa * speed**2 / (PULL * (4 * kappa**2 - 1))])


@pytest.mark.parametrize(
    "kappa", [1.5, *(pytest.param(k, marks=pytest.mark.thorough) for k in (1.2, 2.5))]
)
def test_where_it_stops(kappa):
    model, (time, place) = pushed(kappa), rest(kappa)
    motion = da.solve_dynamics(model, 1.3 * time, integrator=da.DormandPrince(1e-9, 1e-11))
    assert motion.status.success and not motion.warnings
    computed = [motion.values(f"block.{axis}")[-1] for axis in "xy"]
    np.testing.assert_allclose(computed, place, atol=1e-9)
    force = motion.values("plane.friction_force")[-1]
    np.testing.assert_allclose(force, [-MASS * PULL, 0.0], atol=1e-9)
    assert np.abs(motion.data["balance_error"]).max() < 1e-10

    responses = [da.final(model["block.x"]), da.final(model["block.y"])]
    direct = da.sensitivity(motion, responses, method="direct").values
    adjoint = da.sensitivity(motion, responses, method="adjoint").values
    np.testing.assert_allclose(direct, adjoint, rtol=1e-12)
    h = 1e-6
    by_friction = (rest(kappa + h)[1] - rest(kappa - h)[1]) / (2 * h) / np.tan(ANGLE)
    np.testing.assert_allclose(direct, np.transpose([by_friction, 2 * place / SPEED]), rtol=1e-7)


def test_steps_of_given_length_come_to_the_same():
    model, (time, place) = pushed(1.5), rest(1.5)
    motion = da.solve_dynamics(model, 1.3 * time, step=time / 50)
    computed = [motion.values(f"block.{axis}")[-1] for axis in "xy"]
    np.testing.assert_allclose(computed, place, atol=1e-6)


def test_it_never_stops_where_friction_is_less_than_the_pull():
    """``v sin φ = v₀ tan^κ(φ/2)`` all along the way."""
    kappa = 0.8
    motion = da.solve_dynamics(pushed(kappa), 2.0, integrator=da.DormandPrince(1e-9, 1e-11))
    vx, vy = (motion.values(f"block.v{axis}") for axis in "xy")
    wanted = SPEED * np.tan(np.arctan2(vy, vx) / 2) ** kappa
    np.testing.assert_allclose(vy, wanted, rtol=1e-7)
    force = motion.values("plane.friction_force")
    rough = kappa * np.tan(ANGLE) * MASS * G * np.cos(ANGLE)
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), rough, rtol=1e-9)
