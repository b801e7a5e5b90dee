"""A gradient method from many designs, and the distinct optima that it finds."""

from __future__ import annotations

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.slsqp import Slsqp
from dalembert.design.methods.spread import spread
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class Multistart(Optimizer):
    """Local optima from designs spread evenly (Sobol's sequence), each told once.

    Parameters
    ----------
    starts : designs to begin from, that of ``optimize`` first
    local : gradient method
    rng : seed
    apart : distance, in ranges, from which optima are different

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
    local: Optimizer = Slsqp()
    rng: int = 0
    apart: float = 1e-3

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        program.refuse_open("multistart")
        found: list[tuple[np.ndarray, np.ndarray]] = []
        failed = 0
        for begin in (z, *self._spread(program)):
            if not program.begin(begin):
                failed += 1
                continue
            end = self.local.solve(program, begin, stop).z
            reached = program.problem.evaluate(program.unscale(end), gradient=False)
            if reached is not None:
                self._add(program, found, end, reached.values)
        if not found:
            return Ended(z, False, f"none of {self.starts} starts led to a design")
        message = f"multistart: {len(found)} optima from {self.starts} starts"
        if failed:
            message += f", {failed} of which failed at once"
        optima = [design for design, _ in found]
        program.begin(optima[0])
        return Ended(optima[0], True, message, optima=optima)

    def _spread(self, program: Program) -> np.ndarray:
        return spread(self.starts - 1, program.z_lower, program.z_upper, self.rng)

    def _add(
        self,
        program: Program,
        found: list[tuple[np.ndarray, np.ndarray]],
        z: np.ndarray,
        values: np.ndarray,
    ) -> None:
        """Sort an optimum in, unless it is there already."""
        for k, (other, known) in enumerate(found):
            if np.max(abs(other - z)) <= self.apart:
                if program.is_better(values, known):
                    found[k] = (z, values)
                break
        else:
            found.append((z, values))
        for k in range(len(found) - 1, 0, -1):
            if program.is_better(found[k][1], found[k - 1][1]):
                found[k - 1], found[k] = found[k], found[k - 1]
