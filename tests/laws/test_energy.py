"""Energy: kinetic + potential + dissipated − input is constant, to the integrator's order."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from registry import CASES, model_of

import dalembert as da


def balance_error(name: str, step: float, **options) -> float:
    motion = da.solve_dynamics(
        model_of(name), 0.16, step=step, stabilization=da.Stabilization(), **options
    )
    assert motion.status.success
    return float(np.abs(motion.data.balance_error).max())


@pytest.mark.parametrize("name", CASES)
def test_energy_balance_closes_with_the_order(name):
    """Halving the step divides the balance error by 16, down to round-off."""
    coarse, fine = balance_error(name, 0.01), balance_error(name, 0.005)
    assert fine < max(coarse / 13, 1e-13)


@pytest.mark.parametrize("name", [n for n, c in CASES.items() if c.conservative and c.scleronomic])
def test_nothing_is_put_in_where_nothing_drives(name):
    """Springs store, dampers and friction take: the input power is zero in any state."""
    e, start = model_of(name).all_equations, model_of(name).start
    power = ca.Function("input", [e.t, e.y, e.v, e.multiplier, e.p], [e.powers[1]])
    rng = np.random.default_rng(1)
    for _ in range(3):
        v, multiplier = (3 * rng.standard_normal(x.numel()) for x in (e.v, e.multiplier))
        found = float(power(0.2, start.y, v, multiplier, model_of(name).nominal))
        assert found == pytest.approx(0.0, abs=1e-9)
