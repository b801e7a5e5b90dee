"""Trust-region interior point (Byrd, Hribar, Nocedal 1999): SciPy's ``trust-constr``."""

from __future__ import annotations

import warnings

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class TrustConstr(Optimizer):
    """Trust-region method; slower than SLSQP, more robust for strongly curved limits.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> area = rod.parameter("area", 1e-3, "m^2", bounds=(1e-5, 1e-2))
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    >>> rod.support(top)
    >>> rod.load(end, fx=5e4)
    >>> stiff = da.Limit(da.final("end.ux"), upper=1e-3)
    >>> task = dict(minimize=da.final("mass"), subject_to=[stiff], analysis=da.Statics())
    >>> best = da.optimize(rod.build(), **task, method=da.TrustConstr())
    >>> round(best.x["area"] * 1e4, 2)  # F L/(E u) [cm²]
    5.0
    """

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        from scipy.optimize import BFGS, Bounds, NonlinearConstraint, minimize

        limits = NonlinearConstraint(
            program.constraint, program.c_lower, program.c_upper, program.jacobian, BFGS()
        )
        with warnings.catch_warnings():  # about skipped quasi-Newton updates
            warnings.simplefilter("ignore", UserWarning)
            result = minimize(
                program.objective,
                z,
                jac=program.slope,
                hess=BFGS(),
                method="trust-constr",
                bounds=Bounds(program.z_lower, program.z_upper),
                constraints=[limits] if program.m else [],
                options={
                    "maxiter": max(10 * stop.max_iterations, 1),
                    "gtol": max(stop.tolerance, 1e-9),
                    "xtol": min(stop.tolerance, 1e-10),
                    "barrier_tol": max(stop.tolerance, 1e-9),
                },
            )
        clipped = np.clip(result.x, program.z_lower, program.z_upper)
        return OptimizerResult(clipped, result.status in (1, 2), str(result.message))
