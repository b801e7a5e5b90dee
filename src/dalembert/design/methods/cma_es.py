"""Covariance matrix adaptation (Hansen & Ostermeier 2001) of the package cma, an extra."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.differential_evolution import polished
from dalembert.design.methods.slsqp import Slsqp
from dalembert.design.optimize.program import Program
from dalembert.errors import UnsupportedError
from dalembert.options import options


@options
class CmaEs(Optimizer):
    """A global search that learns the shape of the valley; ``pip install dalembert[design]``.

    Parameters
    ----------
    spread : of the first designs, in ranges
    generations : at most
    penalty : on violations of limits
    rng : seed, above zero
    polish : gradient method that ends it; None for none

    Raises
    ------
    UnsupportedError, AnalysisError
        On use: cma is not there, one variable alone, open bounds.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("waves")
    >>> a, b = (model.parameter(name, 3.0, bounds=(-5, 5)) for name in "ab")
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> waves = da.final("(a**2 + b**2)/20 - cos(3*a) - cos(3*b)")  # many valleys
    >>> search = da.CmaEs(generations=30)
    >>> best = da.optimize(model.build(), waves, analysis=da.Statics(), method=search)
    >>> best.success, round(best.fun, 6)
    (True, -2.0)
    """

    spread: float = 0.25
    generations: int = 200
    penalty: float = 1e3
    rng: int = 1
    polish: Optimizer | None = Slsqp()

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        try:
            import cma
        except ImportError:
            raise UnsupportedError(
                "CmaEs needs cma: pip install dalembert[design], or use DifferentialEvolution()"
            ) from None
        program.refuse_open("CMA-ES")
        if z.size == 1:
            raise UnsupportedError(
                "CMA-ES learns how variables go together and takes two or more; for one use "
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
            program.keep(np.asarray(search.result.xbest))
        z, message = np.asarray(search.result.xbest), f"CMA-ES: {search.countiter} generations"
        if self.polish is None:
            return Ended(z, True, message)
        return polished(program, z, self.polish, stop, message)

    def _cost(self, program: Program, z: np.ndarray) -> float:
        found = program.value(z)
        if found is None:
            return 1e12
        f, c = found
        return f + self.penalty * float(
            np.sum(np.maximum(program.c_lower - c, 0)) + np.sum(np.maximum(c - program.c_upper, 0))
        )
