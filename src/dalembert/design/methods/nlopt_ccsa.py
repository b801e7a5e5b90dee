"""Conservative convex separable approximations (Svanberg 2002) by the optional package NLopt."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import Program
from dalembert.errors import UnsupportedError
from dalembert.options import options
from dalembert.packages import optional_package


@options
class CCSAQ(Optimizer):
    """CCSAQ of NLopt for many variables; ``pip install dalembert[nlopt]``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> row = da.Structure("springs in a row")
    >>> a, b = (row.parameter(name, 2.0, bounds=(0.1, 10)) for name in ("a", "b"))
    >>> wall, mid, end = row.node("wall", 0), row.node("mid", 1), row.node("end", 2)
    >>> i = row.add(structures.AxialSpring("i", wall, mid, stiffness=a))
    >>> j = row.add(structures.AxialSpring("j", mid, end, stiffness=b))
    >>> row.support(wall)
    >>> row.load(end, fx=1.0)
    >>> shared = da.Limit(da.final("a + b"), upper=6.0)
    >>> task = dict(minimize=da.final("end.ux"), subject_to=[shared], analysis=da.Statics())
    >>> best = da.optimize(row.build(), **task, method=da.CCSAQ())
    >>> round(best.x["a"], 3), round(best.x["b"], 3)  # minimal for equal ones
    (3.0, 3.0)
    """

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        nlopt = optional_package("nlopt", "CCSAQ", "use method='mma'")
        if np.any(program.c_lower == program.c_upper):
            raise UnsupportedError("CCSAQ takes no equations; use method='slsqp' or 'ipopt'")
        solver = nlopt.opt(nlopt.LD_CCSAQ, program.n)
        solver.set_lower_bounds(program.z_lower)
        solver.set_upper_bounds(program.z_upper)
        solver.set_min_objective(_objective(program))
        for sign, bound in ((-1.0, program.c_lower), (1.0, program.c_upper)):
            rows = np.flatnonzero(np.isfinite(bound))
            if rows.size:
                solver.add_inequality_mconstraint(
                    _limits(program, sign, rows, bound[rows]), np.full(rows.size, 1e-9)
                )
        solver.set_ftol_rel(stop.tolerance)
        solver.set_xtol_rel(np.sqrt(stop.tolerance) / 10)
        solver.set_maxeval(10 * stop.max_iterations)
        try:
            z_end = solver.optimize(np.clip(z, program.z_lower, program.z_upper))
        except nlopt.RoundoffLimited:
            return OptimizerResult(
                program.scaled(program.best[0]), True, "NLopt: limited by round-off"
            )
        code = solver.last_optimize_result()
        return OptimizerResult(np.asarray(z_end), 0 < code < 5, f"NLopt: ended with code {code}")


def _objective(program: Program) -> Callable[[np.ndarray, np.ndarray], float]:
    def value(z: np.ndarray, gradient: np.ndarray) -> float:
        if gradient.size:
            gradient[:] = program.slope(z)
        return program.objective(z)

    return value


def _limits(
    program: Program, sign: float, rows: np.ndarray, bound: np.ndarray
) -> Callable[[np.ndarray, np.ndarray, np.ndarray], None]:
    def value(result: np.ndarray, z: np.ndarray, gradient: np.ndarray) -> None:
        if gradient.size:
            gradient[:] = sign * program.jacobian(z)[rows]
        result[:] = sign * (program.constraint(z)[rows] - bound)

    return value
