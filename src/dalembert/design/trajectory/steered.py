"""Steps of an integrator under a control: what multiple shooting leads from knot to knot with."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.design.trajectory.physics import Physics
from dalembert.errors import UnsupportedError
from dalembert.formulations.base import WORK
from dalembert.model.scheduled import SteeredModel


def half_of(physics: Physics, run: Dynamics, steps: int) -> ca.Function:
    """``(t, h, y, v, q, w) → (y, v)`` after half of an interval.

    ``h`` is the length of the interval, of which half are ``steps`` steps; ``w`` has its beginning
    and length, and for each control the values at its ends and in its middle.

    Raises
    ------
    UnsupportedError
        The integrator controls its steps, or remembers earlier ones.
    """
    steered = SteeredModel(physics.model, physics.controls)
    step = _step(steered, run.kernel(steered), physics.p)
    t, h = ca.MX.sym("t"), ca.MX.sym("h")
    count = physics.equations.coordinate_count, physics.equations.speed_count
    y, v = (ca.MX.sym(name, size) for name, size in zip("yv", count, strict=True))
    q, w = ca.MX.sym("q", len(physics.vary)), ca.MX.sym("w", steered.steering.numel())
    p = ca.MX(ca.DM(physics.p))
    for k, name in enumerate(physics.vary):
        p[list(physics.model.parameters).index(name)] = q[k]
    rest = ca.MX(step.size_in(2)[0] - sum(count), 1)
    x, short = ca.vertcat(y, v, rest), h / (2 * steps)
    for k in range(steps):
        x = step(t + k * short, short, x, ca.vertcat(p, w))
    ends = x[: count[0]], x[count[0] : sum(count)]
    made = ca.Function("half", [t, h, y, v, q, w], list(map(ca.densify, ends)))
    return made if run.integrator.implicit else made.expand("half", {"cse": True})


def _step(steered: SteeredModel, kernel: DynamicsKernel, p: np.ndarray) -> ca.Function:
    """``(t, h, x, p) → x⁺``, where the model starts."""
    integrator = kernel.integrator
    if integrator.adaptive:
        raise UnsupportedError(
            f"{integrator.name} chooses its steps; shooting takes fixed ones, such as RK4() or "
            "Radau(fixed=True)"
        )
    start = steered.start
    given = np.r_[p, np.zeros(steered.steering.numel())]
    given[p.size + 1] = 1.0  # a length of time
    x = kernel.start.function(0.0, start.y, start.v, given).full().ravel()
    if x.size > start.y.size + start.v.size + WORK.numel():
        raise UnsupportedError("shooting sees no switches of friction and stops; smooth them")
    step = kernel.variants[kernel.choose(0.0, x, given)].step
    if step.begin is not None:
        raise UnsupportedError(
            f"{integrator.name} remembers earlier steps; shooting takes methods that do not, such "
            "as RK4() or Radau(fixed=True)"
        )
    return step.function
