"""Differential evolution (Storn & Price 1997), SciPy's, then a gradient method from its best."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.slsqp import Slsqp
from dalembert.design.optimize.program import Program
from dalembert.options import options


@options
class DifferentialEvolution(Optimizer):
    """A global search, whole numbers and catalogues included, polished by gradients.

    Parameters
    ----------
    population : designs per variable
    generations : at most
    rng : seed
    polish : gradient method that ends it; None for none

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
    polish: Optimizer | None = Slsqp()

    is_global = True

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        from scipy.optimize import NonlinearConstraint, differential_evolution

        program.refuse_open("differential evolution")
        coded = _Coded(program)
        limits = NonlinearConstraint(coded.limits, program.c_lower, program.c_upper)
        found = differential_evolution(
            coded.objective,
            coded.bounds,
            x0=coded.code(z),
            integrality=coded.whole,
            constraints=[limits] if program.m else (),
            maxiter=self.generations,
            popsize=self.population,
            tol=1e-8,
            rng=self.rng,
            polish=False,
            init="sobol",
            callback=coded.told,
        )
        z = coded.design(found.x)
        program.keep(z)
        message = f"differential evolution: {found.nit} generations"
        if self.polish is None:
            return Ended(z, True, message)
        return polished(program, z, self.polish, stop, message)


def polished(program: Program, z: np.ndarray, local: Optimizer, stop: Stop, message: str) -> Ended:
    """A gradient method from a design on, its sizes held, where that makes it better."""
    if not program.begin(z):
        return Ended(z, False, f"{message}; the best design fails")
    program.fix_sizes(program.unscale(z))
    ended = local.solve(program, z, stop)
    return Ended(ended.z, ended.success, f"{message}, then {ended.message}")


class _Coded:
    """Designs as SciPy's search varies them: discrete variables by the number of their size."""

    def __init__(self, program: Program):
        self.program = program
        self.whole = np.zeros(program.n, dtype=bool)
        low, high = program.z_lower.copy(), program.z_upper.copy()
        for k, sizes in program.variables.sizes.items():
            self.whole[k], low[k], high[k] = True, 0, len(sizes) - 1
        self.bounds = list(zip(low, high, strict=True))

    def design(self, y: np.ndarray) -> np.ndarray:
        """``z`` of a coded design."""
        z = np.array(y, dtype=float)
        for k, sizes in self.program.variables.sizes.items():
            z[k] = (sizes[round(y[k])] - self.program.origin[k]) / self.program.width[k]
        return z

    def code(self, z: np.ndarray) -> np.ndarray:
        """The coded design nearest to ``z``."""
        y, x = np.array(z, dtype=float), self.program.unscale(z)
        for k, sizes in self.program.variables.sizes.items():
            y[k] = np.argmin(abs(sizes - x[k]))
        return y

    def objective(self, y: np.ndarray) -> float:
        found = self.program.value(self.design(y))
        return np.inf if found is None else found[0]

    def limits(self, y: np.ndarray) -> np.ndarray:
        """Limited quantities; far outside of all limits where a run fails."""
        found = self.program.value(self.design(y))
        if found is not None:
            return found[1]
        low, high = self.program.c_lower, self.program.c_upper
        return np.where(np.isfinite(low), low - 1e6, high + 1e6)

    @property
    def told(self) -> Callable[..., bool]:
        """Records the best of each generation."""

        def callback(intermediate_result: object) -> bool:
            self.program.keep(self.design(intermediate_result.x))  # type: ignore[attr-defined]
            return False

        return callback
