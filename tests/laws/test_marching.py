"""Marching in chunks: what is done once the end is reached, and where a step cannot be repeated."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.adaptive import ATTEMPTS, AdaptiveMarch
from dalembert.integrators.marching.steps import Watch


@pytest.mark.parametrize("steps", [3, ATTEMPTS, ATTEMPTS + 5])
def test_no_step_is_attempted_at_the_end(steps):
    """x counts the attempts: as many as there are steps, however long the chunk."""
    state, fixed = ca.MX.sym("s", 3), ca.MX.sym("f", 2)
    t, h, x = state[0], state[1], state[2]
    following = ca.vertcat(ca.fmin(t + h, fixed[0]), h, x + 1)
    out = [following, ca.vertcat(t, h, 0, 1)]
    attempt = Attempt(ca.Function("counted", [state, fixed], out), ())
    march = AdaptiveMarch(lambda mode: attempt)
    h = 2.0**-5  # exact in binary, so that the last step arrives
    trajectory = march.run(0.0, steps * h, np.zeros(1), np.zeros(0), h, 1.0, 0, Watch())
    assert trajectory.count == steps
    np.testing.assert_array_equal(trajectory.x, [np.arange(steps + 1.0)])


def falling() -> da.Model:
    """``ẍ = −c/x³`` from x = 1 m: reaches the singularity at ``t = 1/√c``."""
    system = da.System("fall")
    strength = system.parameter("c", 1.0)
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.Force("pull", body.center, (-strength / body.x**3, 0.0)))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.CVODES(), da.IDA()])
def test_steps_that_cannot_be_repeated_are_an_error_with_their_time(integrator, capfd):
    """With ``c = 100`` the end of a run to 0.6 s lies behind the singularity."""
    analysis = da.Dynamics(0.6, step=0.15, integrator=integrator, outputs=[0.05, 0.6])
    motion = analysis.run(falling())
    assert motion.status.success
    with pytest.raises(da.AnalysisError, match=r"cannot be repeated .* after t = 0"):
        analysis.replay(motion, np.array([100.0]))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("method", ["adjoint", "direct"])
@pytest.mark.parametrize("integrator", [da.CVODES, da.IDA])
def test_failure_inside_a_gradient_is_an_error_of_this_package(integrator, method, capfd):
    """States put beside the pole let the solver give up in the march, not in the run."""
    motion = da.Dynamics(0.6, step=0.15, integrator=integrator(), outputs=[0.6]).run(falling())
    motion.record.steps.x[0] = 1e-9
    motion.parameters[:] = 1e5
    with pytest.raises(da.AnalysisError, match="a solver inside a step failed"):
        da.sensitivity(motion, da.final("body.x"), method=method)
    assert capfd.readouterr() == ("", "")
