"""Car axis problem by Radau IIA: positions, speeds and multipliers with every index.

Source: Bari test set for initial value problem solvers, problem "Car axis" (F. Mazzia and
C. Magherini), whose reference is the index-3 form itself; numbers as in ``test_car_axis``.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from test_car_axis import MULTIPLIERS, POSITION, VELOCITY, L, axle

import dalembert as da

FORMS = {
    "index 3": da.DAE(),
    "index 2": da.DAE(index=2),
    "stabilised": da.DAE(index=2, stabilized=True),
    "index 1": da.DAE(index=1),
}
TOLERANCE = 1e-9
model = functools.cache(lambda: axle().build())


@pytest.mark.few(1)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("projected", [False, True])
def test_radau(form, projected):
    """Errors at the end of the size of the tolerance."""
    stabilization = da.Projection() if projected else da.Stabilization()
    motion = da.solve_dynamics(
        model(),
        3.0,
        integrator=da.Radau(TOLERANCE, TOLERANCE),
        formulation=FORMS[form],
        stabilization=stabilization,
        outputs=[3.0],
    )
    assert motion.status.success
    # with index 3 and nothing else, speeds and multipliers have order 3
    loose = form == "index 3" and not projected
    np.testing.assert_allclose(motion.data.position[0], POSITION, atol=1e-9)
    np.testing.assert_allclose(motion.data.velocity[0], VELOCITY, atol=3e-8 if loose else 1e-9)
    upright, link = motion.data.multiplier.values[0]
    results = [-upright, -link / (2 * L)]  # the reference writes +Cᵀλ, and the axle as |d|² − L²
    np.testing.assert_allclose(results, MULTIPLIERS, atol=1e-8 if loose else 1e-9)


@pytest.mark.few(4)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("integrator", [da.Trapezoidal(), da.GeneralizedAlpha(0.9)])
def test_second_order(integrator, form):
    """Halving the step divides the error at the end by four."""
    errors = []
    for step in (1e-3, 5e-4):
        motion = da.solve_dynamics(
            model(),
            3.0,
            step=step,
            integrator=integrator,
            formulation=FORMS[form],
            stabilization=da.Stabilization(),
            outputs=[3.0],
        )
        errors.append(np.abs(motion.data.position[0].values - POSITION).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
