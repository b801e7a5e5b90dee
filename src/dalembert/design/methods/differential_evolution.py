"""Differential evolution (Storn & Price 1997) by SciPy, refined by a gradient method."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.slsqp import SLSQP
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class DifferentialEvolution(Optimizer):
    """Global search, also over integers and catalogues, refined by gradients.

    Parameters
    ----------
    population : designs per variable
    generations : upper limit
    rng : seed
    polish : gradient method that refines the result; None for none

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("waves")
    >>> a = model.parameter("a", 3.0, bounds=(-5, 5))
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> waves = da.final("a**2/20 - cos(3*a)")  # a valley every third of a turn
    >>> search = da.DifferentialEvolution(population=8, generations=8)
    >>> best = da.optimize(model.build(), waves, analysis=da.Statics(), method=search)
    >>> round(best.x["a"], 3) + 0.0, round(best.fun, 6)
    (0.0, -1.0)
    """

    population: int = 10
    generations: int = 100
    rng: int = 0
    polish: Optimizer | None = SLSQP()

    is_global = True

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        from scipy.optimize import NonlinearConstraint, differential_evolution

        program.refuse_infinite_bounds("differential evolution")
        encoded = _EncodedProgram(program)
        limits = NonlinearConstraint(encoded.limits, program.c_lower, program.c_upper)
        result = differential_evolution(
            encoded.objective,
            encoded.bounds,
            x0=encoded.encode(z),
            integrality=encoded.integrality,
            constraints=[limits] if program.m else (),
            maxiter=self.generations,
            popsize=self.population,
            tol=1e-8,
            rng=self.rng,
            polish=False,
            init="sobol",
            callback=encoded.callback,
        )
        z = encoded.decode(result.x)
        program.record_values(z)
        message = f"differential evolution: {result.nit} generations"
        if self.polish is None:
            return OptimizerResult(z, True, message)
        return refine(program, z, self.polish, stop, message)


def refine(
    program: Program, z: np.ndarray, local: Optimizer, stop: Stop, message: str
) -> OptimizerResult:
    """Refine a design by a gradient method with its discrete variables fixed."""
    if not program.restart(z):
        return OptimizerResult(z, False, f"{message}; the run fails at the best design")
    program.fix_sizes(program.unscale(z))
    refined = local.solve(program, z, stop)
    return OptimizerResult(refined.z, refined.success, f"{message}, then {refined.message}")


class _EncodedProgram:
    """Program over the variables of SciPy's search: discrete variables as indices of sizes."""

    def __init__(self, program: Program):
        self.program = program
        self.integrality = np.zeros(program.n, dtype=bool)
        low, high = program.z_lower.copy(), program.z_upper.copy()
        for k, sizes in program.variables.sizes.items():
            self.integrality[k], low[k], high[k] = True, 0, len(sizes) - 1
        self.bounds = list(zip(low, high, strict=True))

    def decode(self, y: np.ndarray) -> np.ndarray:
        """``z`` of an encoded design."""
        z = np.array(y, dtype=float)
        for k, sizes in self.program.variables.sizes.items():
            z[k] = (sizes[round(y[k])] - self.program.origin[k]) / self.program.width[k]
        return z

    def encode(self, z: np.ndarray) -> np.ndarray:
        """Encoded design nearest to ``z``."""
        y, x = np.array(z, dtype=float), self.program.unscale(z)
        for k, sizes in self.program.variables.sizes.items():
            y[k] = np.argmin(abs(sizes - x[k]))
        return y

    def objective(self, y: np.ndarray) -> float:
        values = self.program.value(self.decode(y))
        return np.inf if values is None else values[0]

    def limits(self, y: np.ndarray) -> np.ndarray:
        """Constrained quantities; far outside of all limits if a run fails."""
        values = self.program.value(self.decode(y))
        if values is not None:
            return values[1]
        low, high = self.program.c_lower, self.program.c_upper
        return np.where(np.isfinite(low), low - 1e6, high + 1e6)

    @property
    def callback(self) -> Callable[..., bool]:
        """Function that records the best design of each generation."""

        def record_best(intermediate_result: object) -> bool:
            self.program.record_values(self.decode(intermediate_result.x))  # type: ignore[attr-defined]
            return False

        return record_best
