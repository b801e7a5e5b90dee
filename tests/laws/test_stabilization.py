"""Stabilisation and integrators: violations stay small, and errors fall with the order claimed."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import CONSTRAINED, INTEGRATORS, STABILIZATIONS, model_of

import dalembert as da
from dalembert import planar

ORDERS = {
    "Euler": (0.8, 1.2),
    "Heun": (1.8, 2.2),
    "RK4": (3.8, 4.2),
    "RKGill": (3.8, 4.2),
    "DormandPrince": (4.8, 6.0),
    "DormandPrince853": (7.8, 9.1),
}
"""Dormand and Prince made the leading error so small that the next order shows."""
LENGTHS = {"DormandPrince853": (0.08, 0.04, 0.02)}
OUTPUTS = np.linspace(0.0, 0.64, 9)


@functools.cache
def chain():
    """Two bars on a pin, a driver of time and a spring: smooth, constrained, rheonomic."""
    system = da.System("chain", gravity=(0.0, -9.81))
    upper = system.add(planar.Bar("upper", length=0.6, mass=1.2, angle=-0.9, angular_velocity=0.4))
    lower = system.add(planar.Bar("lower", length=0.5, mass=0.7, angle=-1.3, angular_velocity=-0.6))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), upper.start))
    system.add(planar.Revolute("knee", upper.end, lower.start))
    system.add(
        planar.Spring(
            "spring",
            system.ground.point(1.4, 0.3),
            lower.end,
            stiffness=6.0,
            damping=0.4,
            free_length=0.9,
        )
    )
    return system.build()


@functools.cache
def exact():
    return da.solve_dynamics(
        chain(), 0.64, integrator=da.DormandPrince(1e-13, 1e-13), outputs=OUTPUTS
    )


@pytest.mark.parametrize("name", CONSTRAINED)
def test_projection_closes_all_equations_at_every_output(name):
    """|Φ|, |Ψ| ≤ 1e-12 at steps and between them."""
    motion = da.solve_dynamics(model_of(name), 0.2, step=0.02, outputs=np.linspace(0, 0.2, 7))
    assert motion.status.success
    assert float(motion.data.position_violation.max()) < 1e-12
    assert float(motion.data.velocity_violation.max()) < 1e-12


def test_projection_every_few_steps_still_ends_on_the_constraints():
    motion = da.solve_dynamics(chain(), 0.5, step=0.01, stabilization=da.Projection(every=7))
    assert float(motion.data.position_violation[-1]) < 1e-12
    assert float(motion.data.position_violation.max()) < 1e-5


def test_baumgarte_keeps_bounded_what_drifts_without_it():
    """Violation of the later half no larger than of the first; without stabilisation it grows."""

    def halves(stabilization):
        motion = da.solve_dynamics(chain(), 8.0, step=0.01, stabilization=stabilization)
        violation = motion.data.position_violation.values
        return violation[:400].max(), violation[400:].max()

    held, drifting = halves(da.Baumgarte(alpha=20.0)), halves(da.Stabilization())
    assert held[1] < 1.5 * held[0]
    assert drifting[1] > 1.5 * drifting[0]
    assert held[1] < drifting[1] / 10


def errors(integrator: str, stabilization, steps) -> np.ndarray:
    """Largest errors of positions, speeds and multipliers, one row per step length."""
    rows = []
    for h in steps:
        method = INTEGRATORS[integrator]
        if method.adaptive:  # everything accepted: steps of given length
            method = type(method)(1e9, 1e9, max_step=h)
        motion = da.solve_dynamics(
            chain(), 0.64, step=h, integrator=method, outputs=OUTPUTS, stabilization=stabilization
        )
        found, true = motion.trajectory, exact().trajectory
        rows.append(
            [np.abs(getattr(found, n) - getattr(true, n)).max() for n in ("y", "v", "multiplier")]
        )
    return np.array(rows)


@pytest.mark.parametrize("stabilization", STABILIZATIONS)
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_measured_order(integrator, stabilization):
    """Errors of positions, speeds and multipliers fall with the order claimed."""
    steps = np.array(LENGTHS.get(integrator, (0.01, 0.005, 0.0025)))
    table = errors(integrator, STABILIZATIONS[stabilization], steps)
    slopes = np.polyfit(np.log(steps), np.log(table), 1)[0]
    low, high = ORDERS[integrator]
    assert np.all((low < slopes) & (slopes < high)), slopes


def test_tolerance_of_the_adaptive_integrator_is_met():
    """Errors follow the tolerance over six decades."""
    for tolerance in 10.0 ** np.arange(-5, -12, -2):
        method = da.DormandPrince(tolerance, tolerance)
        motion = da.solve_dynamics(chain(), 0.64, integrator=method, outputs=OUTPUTS)
        assert np.abs(motion.trajectory.y - exact().trajectory.y).max() < 20 * tolerance


def test_outputs_do_not_change_the_motion():
    """Branches to outputs between steps leave the steps as they are."""
    fine = da.solve_dynamics(chain(), 0.3, step=0.01, outputs=np.linspace(0, 0.3, 58))
    plain = da.solve_dynamics(chain(), 0.3, step=0.01, integrator=da.RK4())
    np.testing.assert_array_equal(fine.trajectory.y[:, -1], plain.trajectory.y[:, -1])
