"""Energy: kinetic + potential + dissipated − input is constant, to the integrator's order."""

from __future__ import annotations

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
