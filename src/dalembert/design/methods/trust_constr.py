"""Trust-region interior point (Byrd, Hribar, Nocedal 1999), SciPy's ``trust-constr``."""

from __future__ import annotations

import warnings

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.program import Program
from dalembert.options import options


@options
class TrustConstr(Optimizer):
    """Slower than SLSQP, and steadier on badly curved limits."""

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        from scipy.optimize import BFGS, Bounds, NonlinearConstraint, minimize

        limits = NonlinearConstraint(
            program.constraint, program.c_lower, program.c_upper, program.jacobian, BFGS()
        )
        with warnings.catch_warnings():  # of quasi-Newton updates that are skipped
            warnings.simplefilter("ignore", UserWarning)
            found = minimize(
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
        inside = np.clip(found.x, program.z_lower, program.z_upper)
        return Ended(inside, found.status in (1, 2), str(found.message))
