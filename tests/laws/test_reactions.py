"""Reactions: they balance every body, do no work in joints, and the drivers' work in drivers."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from newton_euler import Snapshot
from registry import CASES, CONSTRAINED, model_of

import dalembert as da
from dalembert.elements.driver import Driver
from dalembert.elements.planar import UserConstraint


@functools.cache
def snapshots(name: str) -> list[Snapshot]:
    motion = da.solve_dynamics(model_of(name), 0.1, step=0.01, outputs=[0.0, 0.045, 0.1])
    assert motion.status.success
    return [Snapshot(motion, k, CASES[name]) for k in range(3)]


@pytest.mark.parametrize("name", CASES)
def test_reactions_and_loads_balance_every_body(name):
    """Newton–Euler: m r̈ = Σ F + m g, J φ̈ = Σ M + (r_P − r) × F."""
    for now in snapshots(name):
        gravity = np.array([now.seen.p.gx, now.seen.p.gy])
        assert now.imbalance(gravity) < 1e-10 * (
            1 + np.abs(now.data.multiplier.values).max(initial=0)
        )


@pytest.mark.parametrize("name", [n for n in CONSTRAINED if CASES[n].scleronomic])
def test_reactions_of_joints_do_no_work(name):
    """Σ F·v + M ω = 0 over all bodies of a joint."""
    for now in snapshots(name):
        for joint in now.model.constraints:
            assert abs(now.power(now.reaction(joint))) < 1e-10


@pytest.mark.parametrize("name", [n for n in CONSTRAINED if not CASES[n].scleronomic])
def test_drivers_give_the_power_they_report(name):
    """Σ F·v + M ω is the driver's power."""
    for now in snapshots(name):
        for driver in now.model.constraints:
            if isinstance(driver, UserConstraint):
                continue
            assert isinstance(driver, Driver)
            told = float(now.data.driver_power.sel(driver=driver.name))
            assert now.power(now.reaction(driver)) == pytest.approx(told, rel=1e-10, abs=1e-10)
