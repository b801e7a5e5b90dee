"""Multistart: a local method from many designs, with the distinct optima."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.search_options import sobol_designs
from dalembert.design.methods.slsqp import SLSQP
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class Multistart(Optimizer):
    """Distinct local optima from the points of a Sobol sequence.

    Parameters
    ----------
    starts : number of initial designs, the start of ``optimize`` first
    local : gradient method
    rng : seed
    minimum_distance : threshold for the distance of distinct optima, relative to the ranges

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("two valleys")
    >>> a = model.parameter("a", 1.0, bounds=(-2, 2))
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> valleys, search = da.final("(a**2 - 1)**2"), da.Multistart(starts=6)
    >>> best = da.optimize(model.build(), valleys, analysis=da.Statics(), method=search)
    >>> sorted(round(one.parameters["a"], 3) for one in best.optima)
    [-1.0, 1.0]
    """

    starts: int = 20
    local: Optimizer = SLSQP()
    rng: int = 0
    minimum_distance: float = 1e-3

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        program.refuse_infinite_bounds("multistart")
        optima: list[tuple[np.ndarray, np.ndarray]] = []
        failure_count = 0
        for start in (z, *self._spread(program)):
            if not program.restart(start):
                failure_count += 1
                continue
            z_end = self.local.solve(program, start, stop).z
            evaluation = program.problem.evaluate(program.unscale(z_end), gradient=False)
            if evaluation is not None:
                self._add(program, optima, z_end, evaluation.values)
        if not optima:
            return OptimizerResult(z, False, f"none of {self.starts} starts led to a design")
        message = f"multistart: {len(optima)} optima from {self.starts} starts"
        if failure_count:
            message += f", {failure_count} of which failed"
        designs = [optimum for optimum, _ in optima]
        program.restart(designs[0])
        return OptimizerResult(designs[0], True, message, optima=designs)

    def _spread(self, program: Program) -> np.ndarray:
        return sobol_designs(self.starts - 1, program.z_lower, program.z_upper, self.rng)

    def _add(
        self,
        program: Program,
        optima: list[tuple[np.ndarray, np.ndarray]],
        z: np.ndarray,
        values: np.ndarray,
    ) -> None:
        """Insert an optimum in order, unless it is listed already."""
        for k, (other, other_values) in enumerate(optima):
            if np.max(abs(other - z)) <= self.minimum_distance:
                if program.is_better(values, other_values):
                    optima[k] = (z, values)
                break
        else:
            optima.append((z, values))
        for k in range(len(optima) - 1, 0, -1):
            if program.is_better(optima[k][1], optima[k - 1][1]):
                optima[k - 1], optima[k] = optima[k], optima[k - 1]
