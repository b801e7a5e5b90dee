"""Bounded least squares by SciPy's trust-region reflective method (Branch, Coleman, Li 1999)."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import Program
from dalembert.design.quantity import SumOfSquares
from dalembert.errors import UnsupportedError
from dalembert.options import options


@options
class LeastSquares(Optimizer):
    """Gauss–Newton steps for a sum of squares without limits.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> row = da.Structure("springs in a row")
    >>> a, b = (row.parameter(name, 1.0, bounds=(0.1, 50)) for name in ("a", "b"))
    >>> wall, mid, end = row.node("wall", 0), row.node("mid", 1), row.node("end", 2)
    >>> i = row.add(structures.AxialSpring("i", wall, mid, stiffness=a))
    >>> j = row.add(structures.AxialSpring("j", mid, end, stiffness=b))
    >>> row.support(wall)
    >>> row.load(end, fx=1.0)
    >>> aim = da.SumOfSquares([da.final("mid.ux"), da.final("end.ux")], targets=[0.25, 0.75])
    >>> best = da.optimize(row.build(), aim, analysis=da.Statics(), method=da.LeastSquares())
    >>> {name: round(value, 4) for name, value in best.x.items()}  # 1/0.25, 1/0.5
    {'a': 4.0, 'b': 2.0}
    """

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        from scipy.optimize import least_squares

        problem = program.problem
        goal = problem.quantities[0]
        if not isinstance(goal, SumOfSquares) or program.sign < 0:
            raise UnsupportedError("least-squares minimises da.SumOfSquares; use another method")
        if program.m:
            raise UnsupportedError("least-squares takes bounds but no limits; use method='slsqp'")
        indices, scales = problem.term_indices(goal), np.broadcast_to(goal.scales, len(goal.terms))
        size = np.sqrt(program.scale)

        def residuals(z: np.ndarray) -> np.ndarray:
            evaluation = problem.evaluate(program.unscale(z), gradient=False)
            if evaluation is None:  # far above the last value, so that the trust region shrinks
                last = goal.residuals(program.reached[1].terms[indices])
                return (abs(last) + np.max(abs(last)) + 1.0) * 10 / size
            return goal.residuals(evaluation.terms[indices]) / size

        def slopes(z: np.ndarray) -> np.ndarray:
            program.point(z)
            evaluation = problem.evaluate(program.unscale(z)) or program.reached[1]
            assert evaluation.gradient is not None
            return evaluation.gradient[indices] * program.width / scales[:, None] / size

        margin = 1e-9
        free = program.is_free()
        low = np.where(free, program.z_lower, z - margin)
        high = np.where(free, program.z_upper, z + margin)
        interior = np.clip(z, low + margin / 2, high - margin / 2)
        result = least_squares(
            residuals,
            interior,
            slopes,
            bounds=(low, high),
            xtol=stop.tolerance,
            ftol=stop.tolerance,
            gtol=1e-12,
            max_nfev=max(stop.max_iterations, 1),
        )
        return OptimizerResult(result.x, bool(result.success), str(result.message))
