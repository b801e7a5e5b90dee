"""Reactions: they balance every body, do no work in joints, and the drivers' work in drivers."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from newton_euler import Snapshot
from registry import CASES, CONSTRAINED, model_of

import dalembert as da
from dalembert import spatial
from dalembert.elements.driver import Driver
from dalembert.elements.planar import UserConstraint


@functools.cache
def snapshots(name: str) -> list[Snapshot]:
    motion = da.solve_dynamics(model_of(name), 0.1, step=0.01, outputs=[0.0, 0.045, 0.1])
    assert motion.status.success
    return [Snapshot(motion, k, CASES[name]) for k in range(3)]


@pytest.mark.few(20)
@pytest.mark.parametrize("name", CASES)
def test_reactions_and_loads_balance_every_body(name):
    """Newton–Euler: m r̈ = Σ F + m g, J φ̈ = Σ M + (r_P − r) × F."""
    for now in snapshots(name):
        gravity = [getattr(now.seen.p, g) for g in ("gx", "gy", "gz") if hasattr(now.seen.p, g)]
        assert now.imbalance(gravity) < 1e-10 * (
            1 + np.abs(now.data.multiplier.values).max(initial=0)
        )


@pytest.mark.few(10)
@pytest.mark.parametrize("name", [n for n in CONSTRAINED if CASES[n].scleronomic])
def test_reactions_of_joints_do_no_work(name):
    """Σ F·v + M ω = 0 over all bodies of a joint."""
    for now in snapshots(name):
        for joint in now.model.constraints:
            assert abs(now.power(now.reaction(joint))) < 1e-10


@pytest.mark.few(10)
@pytest.mark.parametrize("name", [n for n in CONSTRAINED if not CASES[n].scleronomic])
def test_drivers_give_the_power_they_report(name):
    """Σ F·v + M ω is the driver's power, and none of the joint that it drives."""
    for now in snapshots(name):
        for joint in now.model.constraints:
            if isinstance(joint, UserConstraint):
                continue
            drives = isinstance(joint, Driver)
            power = float(now.data.power.sel(driver=joint.name)) if drives else 0.0
            assert now.power(now.reaction(joint)) == pytest.approx(power, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("turned", [False, True])
def test_reaction_on_the_ground_is_whole(turned):
    """The second body may be the ground, which stands in the plane as in space."""
    system = da.System("door", gravity=(0.3, 0.2, -9.81))
    rotation = da.rotation.identity()
    door = spatial.Body("door", mass=2.0, inertia=(0.1, 0.2, 0.15), rotation=rotation)
    system.add(door)
    hinge = [system.ground.frame(axis=(0, 1, 0.2)), door.frame((-0.5, 0, 0), axis=(0, 1, 0.2))]
    system.add(spatial.Revolute("A", *(reversed(hinge) if turned else hinge)))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.01)
    on_door = np.array([2.0 * motion["door.acceleration"].values[-1] - [0.6, 0.4, -19.62]])
    sign = -1 if turned else 1
    np.testing.assert_allclose(motion["A.force"].values[-1:], sign * on_door, atol=1e-9)
    turn = motion["door.rotation"].values[-1].reshape(3, 3)
    spin = motion["door.angular_velocity_local"].values[-1]
    inertia = np.diag([0.1, 0.2, 0.15])
    speeding = turn.T @ motion["door.angular_acceleration"].values[-1]
    moment = turn @ (inertia @ speeding + np.cross(spin, inertia @ spin))
    arm = turn @ [-0.5, 0, 0]
    np.testing.assert_allclose(
        sign * motion["A.moment"].values[-1], moment - np.cross(arm, on_door[0]), atol=1e-9
    )
