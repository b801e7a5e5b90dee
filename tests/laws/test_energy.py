"""Energy: kinetic + potential + dissipated − input is constant, to the integrator's order."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from registry import CASES, model_of
from spatial_registry import SPATIAL_CASES, any_model_of

import dalembert as da
from dalembert import planar


def balance_error(name: str, step: float, **options) -> float:
    motion = da.solve_dynamics(
        any_model_of(name), 0.16, step=step, stabilization=da.Stabilization(), **options
    )
    assert motion.status.success
    return float(np.abs(motion.data.balance_error).max())


@pytest.mark.few(4)
@pytest.mark.parametrize("name", [*CASES, *SPATIAL_CASES])
def test_energy_balance_closes_with_the_order(name):
    """Halving the step divides the balance error by 16, down to round-off."""
    coarse, fine = balance_error(name, 0.01), balance_error(name, 0.005)
    assert fine < max(coarse / 13, 1e-13)


@pytest.mark.few(12)
@pytest.mark.parametrize("name", [n for n, c in CASES.items() if c.conservative and c.scleronomic])
def test_nothing_is_put_in_where_nothing_drives(name):
    """Springs store, dampers and friction take: the input power is zero in any state."""
    e, start = model_of(name).all_equations, model_of(name).start
    power = ca.Function("input", [e.t, e.y, e.v, e.multiplier, e.p], [e.powers[1]])
    rng = np.random.default_rng(1)
    for _ in range(3):
        v, multiplier = (3 * rng.standard_normal(x.numel()) for x in (e.v, e.multiplier))
        computed = float(power(0.2, start.y, v, multiplier, model_of(name).nominal))
        assert computed == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("tie", ["spring", "damper", "both", "pin"])
def test_ends_that_a_formula_of_time_moves_put_energy_in(tie):
    """What moves the end of a spring or a joint does work; outputs may begin after the start."""
    system = da.System("shaken", gravity=(0.0, -9.81))
    bar = planar.Bar("bar", length=0.8, mass=2.0, angle=-0.9, angular_velocity=1.0)
    bar = system.add(bar)
    moved = system.ground.point(0.2 * da.sin(5 * da.t), 0.1 * da.cos(3 * da.t))
    if tie == "pin":
        system.add(planar.Revolute("O", moved, bar.start))
    else:
        system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
        stiffness, damping = {"spring": (90.0, 0.0), "damper": (0.0, 4.0), "both": (90.0, 4.0)}[tie]
        ends = system.ground.point(1.0 + 0.2 * da.sin(5 * da.t), 0.1 * da.cos(3 * da.t)), bar.end
        spring = planar.Spring("s", *ends, stiffness=stiffness, damping=damping, free_length=0.3)
        system.add(spring)
    motion = da.solve_dynamics(
        system.build(), 1.0, integrator=da.DormandPrince(1e-11, 1e-12), outputs=[0.5, 0.75, 1.0]
    )
    assert motion.status.success
    moved_energy = np.ptp(motion.data.input_energy.values)
    assert moved_energy > 0.1
    assert np.abs(motion.data.balance_error).max() < 1e-8 * moved_energy
