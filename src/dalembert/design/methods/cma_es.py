"""CMA-ES, covariance matrix adaptation (Hansen & Ostermeier 2001), by the optional package cma."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.differential_evolution import refine
from dalembert.design.methods.slsqp import SLSQP
from dalembert.design.optimize.program import Program
from dalembert.errors import UnsupportedError
from dalembert.options import options
from dalembert.packages import optional_package


@options
class CMAES(Optimizer):
    """Global search by covariance matrix adaptation; ``pip install dalembert[design]``.

    Parameters
    ----------
    spread : initial standard deviation, relative to the ranges
    generations : upper limit
    penalty : weight of violations of limits
    rng : seed, above zero
    polish : gradient method that refines the result; None for none

    Raises
    ------
    UnsupportedError, AnalysisError
        On use: cma is missing, a single variable, infinite bounds.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("waves")
    >>> a, b = (model.parameter(name, 3.0, bounds=(-5, 5)) for name in "ab")
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> waves = da.final("(a**2 + b**2)/20 - cos(3*a) - cos(3*b)")  # many valleys
    >>> search = da.CMAES(generations=30)
    >>> best = da.optimize(model.build(), waves, analysis=da.Statics(), method=search)
    >>> best.success, round(best.fun, 6)
    (True, -2.0)
    """

    spread: float = 0.25
    generations: int = 200
    penalty: float = 1e3
    rng: int = 1
    polish: Optimizer | None = SLSQP()

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        cma = optional_package("cma", "CMAES", "use DifferentialEvolution()")
        program.refuse_infinite_bounds("CMA-ES")
        if z.size == 1:
            raise UnsupportedError(
                "CMA-ES learns how variables correlate and needs two or more; for one use "
                "DifferentialEvolution() or Multistart()"
            )
        settings = {
            "bounds": [program.z_lower, program.z_upper],
            "maxiter": self.generations,
            "seed": self.rng,
            "verbose": -9,
        }
        search = cma.CMAEvolutionStrategy(z, self.spread, settings)
        while not search.stop():
            designs = search.ask()
            search.tell(designs, [self._cost(program, d) for d in designs])
            program.record_values(np.asarray(search.result.xbest))
        z, message = np.asarray(search.result.xbest), f"CMA-ES: {search.countiter} generations"
        if self.polish is None:
            return OptimizerResult(z, True, message)
        return refine(program, z, self.polish, stop, message)

    def _cost(self, program: Program, z: np.ndarray) -> float:
        values = program.value(z)
        if values is None:
            return 1e12
        f, c = values
        return f + self.penalty * float(
            np.sum(np.maximum(program.c_lower - c, 0)) + np.sum(np.maximum(c - program.c_upper, 0))
        )
