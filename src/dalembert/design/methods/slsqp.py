"""Sequential least squares programming (Kraft 1988) by SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.ipopt import Ipopt
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class SLSQP(Optimizer):
    """Sequential quadratic programming; fast up to about a hundred variables.

    Parameters
    ----------
    ipopt_fallback : continue with ``Ipopt`` if it stalls at a design that is infeasible or not
        optimal
        though nearby designs are better

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
    >>> best = da.optimize(spring.build(), cost, analysis=da.Statics(), method=da.SLSQP())
    >>> round(best.x["k"])  # of k + 4e4/k
    200
    """

    ipopt_fallback: bool = True

    def rescue(self) -> Optimizer | None:
        return Ipopt() if self.ipopt_fallback else None

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        from scipy.optimize import minimize

        result = minimize(
            program.objective,
            z,
            jac=program.slope,
            method="SLSQP",
            bounds=list(zip(program.z_lower, program.z_upper, strict=True)),
            constraints=_constraints(program),
            options={"maxiter": stop.max_iterations, "ftol": stop.tolerance},
        )
        return OptimizerResult(result.x, bool(result.success), str(result.message))


def _constraints(program: Program) -> list[dict[str, Any]]:
    """Limits in SciPy's form ``c(z) = 0`` and ``c(z) ≥ 0``, each as one vector."""
    equal = program.c_lower == program.c_upper
    low = ~equal & np.isfinite(program.c_lower)
    high = ~equal & np.isfinite(program.c_upper)
    rows = np.concatenate([np.flatnonzero(low), np.flatnonzero(high)])
    signs = np.concatenate([np.ones(low.sum()), -np.ones(high.sum())])
    bounds = np.concatenate([program.c_lower[low], program.c_upper[high]])
    constraints: list[dict[str, Any]] = []
    if equal.any():
        constraints.append(
            {
                "type": "eq",
                "fun": lambda z: (program.constraint(z) - program.c_lower)[equal],
                "jac": lambda z: program.jacobian(z)[equal],
            }
        )
    if rows.size:
        constraints.append(
            {
                "type": "ineq",
                "fun": lambda z: signs * (program.constraint(z)[rows] - bounds),
                "jac": lambda z: signs[:, None] * program.jacobian(z)[rows],
            }
        )
    return constraints
