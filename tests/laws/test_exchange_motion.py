"""Model exchange of functional mock-up units: the motion of every element of the registry."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from registry import CASES, model_of

from dalembert.analysis.model_residuals import constraint_rows, motion_rows
from dalembert.fmu.motion_functions import MotionFunctions
from dalembert.fmu.unit_functions import closed_in

SMOOTH = [name for name in CASES if "rigid" not in name and "touch" not in name]
DIFFERENTIATED = SMOOTH[::8]


def motion_of(name: str) -> tuple[MotionFunctions, tuple]:
    """Functions of a case, and a closed random state near its start."""
    model = model_of(name)
    if model.equations.contacts:
        pytest.skip("rigid contacts are not exported")
    e, p, start = model.all_equations, model.nominal, model.start
    motion = MotionFunctions(model, closed_in(model), [e.y, e.v, e.a, e.multiplier])
    x, held = (o.full().ravel() for o in motion.start.function(0.0, start.y, start.v, p))
    x = x + 1e-2 * np.random.default_rng(0).standard_normal(x.size) * motion_sizes(motion)
    count = motion.near_y.numel()
    for _ in range(20 if motion.closed else 0):
        closer, gap = motion.closing(0.0, held, x, p)
        held[:count] = closer.full().ravel()
        if np.abs(gap.full()).max(initial=0.0) < 1e-13:
            break
    return motion, (0.0, held, x, p)


def motion_sizes(motion: MotionFunctions) -> np.ndarray:
    s, scales = motion.states, motion.e.scales
    parts = scales.coordinates[list(s.positions)], scales.speeds[list(s.speeds)]
    return np.concatenate([*parts, scales.coordinates[list(s.first_order)]])


@pytest.mark.few(8)
@pytest.mark.parametrize("name", SMOOTH)
def test_motion_satisfies_the_equations_of_the_model(name):
    """Levels of all constraints and the equations of motion, in the coordinates of the bodies."""
    motion, at = motion_of(name)
    model, p = motion.model, at[-1]
    e = model.all_equations
    values = motion.measured.function(*at).full().ravel()
    ends = np.cumsum([e.y.numel(), e.v.numel(), e.a.numel()])
    y, v, a, multiplier = np.split(values, ends)
    checks = (
        constraint_rows(model)(0.0, y, v, a, p),
        motion_rows(model)(0.0, y, v, a, multiplier, p),
    )
    for rows, terms in checks:
        rows, terms = rows.full().ravel(), terms.full().ravel()
        assert np.all(np.isfinite(rows))
        assert np.abs(rows).max(initial=0.0) <= 1e-9 * max(1.0, terms.max(initial=0.0))


@pytest.mark.few(6)
@pytest.mark.parametrize("name", DIFFERENTIATED)
def test_adjoint_is_the_transpose_of_the_tangent(name):
    motion, at = motion_of(name)
    f, rng = motion.everything, np.random.default_rng(1)
    dt, dx, dp = 1.0, rng.standard_normal(at[2].size), rng.standard_normal(at[3].size)
    change = f.tangent(*at, dt, ca.DM.zeros(at[1].size), dx, dp).full().ravel()
    weights = rng.standard_normal(change.size)
    t_bar, _, x_bar, p_bar = (o.full().ravel() for o in f.adjoint(*at, weights))
    back = t_bar[0] * dt + x_bar @ dx + p_bar @ dp
    size = (
        np.abs(x_bar) @ np.abs(dx) + np.abs(p_bar) @ np.abs(dp) + np.abs(weights) @ np.abs(change)
    )
    assert abs(weights @ change - back) <= 1e-11 * size
