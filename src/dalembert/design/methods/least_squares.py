"""Least squares within bounds by a reflective trust region (Branch, Coleman, Li 1999), SciPy's."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.optimize.program import Program
from dalembert.design.quantity import SumOfSquares
from dalembert.errors import UnsupportedError
from dalembert.options import options


@options
class LeastSquares(Optimizer):
    """For a sum of squares without limits: Gauss–Newton steps from the residuals' gradients.

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

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        from scipy.optimize import least_squares

        problem = program.problem
        goal = problem.quantities[0]
        if not isinstance(goal, SumOfSquares) or program.sign < 0:
            raise UnsupportedError("least-squares minimises da.SumOfSquares; use another method")
        if program.m:
            raise UnsupportedError("least-squares knows bounds but no limits; use method='slsqp'")
        places, scales = problem.places(goal), np.broadcast_to(goal.scales, len(goal.terms))
        size = np.sqrt(program.scale)

        def residuals(z: np.ndarray) -> np.ndarray:
            found = problem.evaluate(program.unscale(z), gradient=False)
            if found is None:  # far above what was reached, so that the region shrinks
                here = goal.residuals(program.reached[1].terms[places])
                return (abs(here) + np.max(abs(here)) + 1.0) * 10 / size
            return goal.residuals(found.terms[places]) / size

        def slopes(z: np.ndarray) -> np.ndarray:
            program.point(z)
            found = problem.evaluate(program.unscale(z)) or program.reached[1]
            assert found.gradient is not None
            return found.gradient[places] * program.width / scales[:, None] / size

        margin = 1e-9
        free = program.is_free()
        low = np.where(free, program.z_lower, z - margin)
        high = np.where(free, program.z_upper, z + margin)
        inside = np.clip(z, low + margin / 2, high - margin / 2)
        found = least_squares(
            residuals,
            inside,
            slopes,
            bounds=(low, high),
            xtol=stop.tolerance,
            ftol=stop.tolerance,
            gtol=1e-12,
            max_nfev=max(stop.max_iterations, 1),
        )
        return Ended(found.x, bool(found.success), str(found.message))
