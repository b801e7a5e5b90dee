"""Sequential least squares programming (Kraft 1988), SciPy's."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.ipopt import Ipopt
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class Slsqp(Optimizer):
    """Quick for up to about a hundred variables, with limits and equations.

    Parameters
    ----------
    rescued : where it is stuck short of an optimum or of its limits, though designs nearby are
        better, ``Ipopt`` goes on from there

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=100.0)
    >>> cost = da.final("k + 4*100*end.ux")
    >>> best = da.optimize(spring.build(), cost, analysis=da.Statics(), method=da.Slsqp())
    >>> round(best.x["k"])  # of k + 4e4/k
    200
    """

    rescued: bool = True

    def rescue(self) -> Optimizer | None:
        return Ipopt() if self.rescued else None

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        from scipy.optimize import minimize

        found = minimize(
            program.objective,
            z,
            jac=program.slope,
            method="SLSQP",
            bounds=list(zip(program.z_lower, program.z_upper, strict=True)),
            constraints=_sides(program),
            options={"maxiter": stop.max_iterations, "ftol": stop.tolerance},
        )
        return Ended(found.x, bool(found.success), str(found.message))


def _sides(program: Program) -> list[dict[str, Any]]:
    """SciPy's form ``c(z) ≥ 0`` of the sides of limits, all inequalities in one."""
    equal = program.c_lower == program.c_upper
    low = ~equal & np.isfinite(program.c_lower)
    high = ~equal & np.isfinite(program.c_upper)
    rows = np.concatenate([np.flatnonzero(low), np.flatnonzero(high)])
    signs = np.concatenate([np.ones(low.sum()), -np.ones(high.sum())])
    bounds = np.concatenate([program.c_lower[low], program.c_upper[high]])
    made: list[dict[str, Any]] = []
    if equal.any():
        made.append(
            {
                "type": "eq",
                "fun": lambda z: (program.constraint(z) - program.c_lower)[equal],
                "jac": lambda z: program.jacobian(z)[equal],
            }
        )
    if rows.size:
        made.append(
            {
                "type": "ineq",
                "fun": lambda z: signs * (program.constraint(z)[rows] - bounds),
                "jac": lambda z: signs[:, None] * program.jacobian(z)[rows],
            }
        )
    return made
