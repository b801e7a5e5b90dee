"""The design problem in the scaled form that optimisers get: ``min f(z), c_l ≤ c(z) ≤ c_u``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.methods.spread import refuse_open
from dalembert.design.optimize.optimum import Iterate
from dalembert.design.optimize.problem import DesignProblem, Evaluation
from dalembert.errors import AnalysisError

FEASIBLE = 1e-6
"""Relative violation up to which limits count as kept."""


@dataclass
class Point:
    """A design in scaled numbers.

    Attributes
    ----------
    f, c : objective and (m,) limited quantities
    g, J : (n,) and (m, n) their gradients, where asked for
    """

    f: float
    c: np.ndarray
    g: np.ndarray
    J: np.ndarray


class Program:
    """Variables in units of their ranges, quantities in units of their sizes.

    Parameters
    ----------
    problem : first quantity the objective, then one for every limit
    limits : in the order of these quantities
    sign : 1 to minimise, −1 to maximise
    start : (n,) design at which it begins and is scaled
    sizes : (m,) what one is for each limit, where another program has told

    Raises
    ------
    AnalysisError
        The run or its gradient fails at the start.
    """

    def __init__(
        self,
        problem: DesignProblem,
        limits: Sequence[Limit],
        sign: float,
        start: np.ndarray,
        on_iterate: Callable[[int, float], None] | None = None,
        sizes: np.ndarray | None = None,
    ):
        self.problem, self.limits, self.sign = problem, list(limits), sign
        self.variables, self.on_iterate = problem.variables, on_iterate
        self.lower, self.upper = self.variables.lower.copy(), self.variables.upper.copy()
        self.width = self.variables.width
        self.origin = np.array(start, dtype=float)
        first = problem.evaluate(self.origin)
        if first is None:
            raise AnalysisError(f"the starting design fails: {problem.failures[-1]}")
        self.first, self.reached = first, (self.origin, first)
        self.scale = self._scale(first)
        own = np.array([self._size(k, limit) for k, limit in enumerate(self.limits, 1)])
        self.sizes = own if sizes is None else sizes
        self.c_lower = self._bounds("lower", -np.inf)
        self.c_upper = self._bounds("upper", np.inf)
        self.last = sign * first.values[0] / self.scale
        self.history = [self.iterate(self.origin, first)]
        self.best = self.reached

    # scales -----------------------------------------------------------------------------
    def _scale(self, found: Evaluation) -> float:
        value, slope = abs(found.values[0]), self.problem.slope(found, 0) * self.width
        return float(max(value, 1e-3 * np.max(abs(slope), initial=0.0))) or 1.0

    def _size(self, row: int, limit: Limit) -> float:
        """What one is for a limit: its bound, or the quantity at the start and what moves it."""
        bounds = [abs(b) for b in (limit.lower, limit.upper) if b is not None]
        slope = self.problem.slope(self.first, row) * self.width if not any(bounds) else np.zeros(1)
        moved = 1e-3 * float(np.max(abs(slope), initial=0.0))
        return float(max(*bounds, abs(self.first.values[row]), moved, 1e-12))

    def _bounds(self, side: str, none: float) -> np.ndarray:
        given = [getattr(limit, side) for limit in self.limits]
        return np.array([none if b is None else b for b in given], dtype=float) / self.sizes

    def begin(self, z: np.ndarray) -> bool:
        """Start over from a design, by which the objective is measured; false where it fails."""
        x = self.unscale(z)
        found = self.problem.evaluate(x)
        if found is None:
            return False
        self.reached, self.scale = (x, found), self._scale(found)
        self.last = self.sign * found.values[0] / self.scale
        return True

    def measure_by_start(self) -> None:
        """Measure the objective as it was at the very start."""
        self.scale = self._scale(self.first)

    # variables --------------------------------------------------------------------------
    @property
    def n(self) -> int:
        """Number of variables."""
        return self.lower.size

    @property
    def m(self) -> int:
        """Number of limited quantities."""
        return len(self.limits)

    def unscale(self, z: np.ndarray) -> np.ndarray:
        """The design, within its bounds."""
        return np.clip(self.origin + self.width * z, self.lower, self.upper)

    def scaled(self, x: np.ndarray) -> np.ndarray:
        """``z`` of a design."""
        return (x - self.origin) / self.width

    @property
    def z_lower(self) -> np.ndarray:
        """(n,) lower bounds."""
        return self.scaled(self.lower)

    @property
    def z_upper(self) -> np.ndarray:
        """(n,) upper bounds."""
        return self.scaled(self.upper)

    def refuse_open(self, method: str) -> None:
        """Refuse variables without two bounds, for methods that draw designs between them.

        Raises
        ------
        AnalysisError
            Names the first of them.
        """
        refuse_open(method, self.variables.names, self.lower, self.upper)

    # functions --------------------------------------------------------------------------
    def value(self, z: np.ndarray) -> tuple[float, np.ndarray] | None:
        """Objective and limited quantities; None where the run fails."""
        found = self.problem.evaluate(self.unscale(z), gradient=False)
        return None if found is None else self._scaled(found)

    def _scaled(self, found: Evaluation) -> tuple[float, np.ndarray]:
        return self.sign * found.values[0] / self.scale, found.values[1:] / self.sizes

    def objective(self, z: np.ndarray) -> float:
        """The objective; far above the last one where the run fails, so that searches come back."""
        found = self.value(z)
        if found is None:
            return self.last + 10.0 * (1.0 + abs(self.last))
        self.last = found[0]
        return found[0]

    def constraint(self, z: np.ndarray) -> np.ndarray:
        """(m,) limited quantities; those last reached where the run fails."""
        found = self.value(z)
        return self._scaled(self.reached[1])[1] if found is None else found[1]

    def point(self, z: np.ndarray, record: bool = True) -> Point | None:
        """Values and gradients; a design at which they are asked for is an iterate."""
        x = self.unscale(z)
        found = self.problem.evaluate(x)
        if found is None:
            return None
        if record:
            self.record(x, found)
        rows = [self.problem.slope(found, k) * self.width for k in range(1 + self.m)]
        J = np.array(rows[1:]).reshape(self.m, self.n) / self.sizes[:, None]
        return Point(*self._scaled(found), self.sign * rows[0] / self.scale, J)

    def slope(self, z: np.ndarray) -> np.ndarray:
        """(n,) gradient of the objective; that of the design last reached where the run fails."""
        return self._slopes(z).g

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """(m, n) gradients of the limited quantities, likewise."""
        return self._slopes(z).J

    def _slopes(self, z: np.ndarray) -> Point:
        found = self.point(z) or self.point(self.scaled(self.reached[0]), record=False)
        assert found is not None
        return found

    # designs ----------------------------------------------------------------------------
    def violation(self, values: np.ndarray) -> float:
        """Largest relative violation of a limit."""
        c = values[1:] / self.sizes
        return float(np.max(np.maximum(self.c_lower - c, c - self.c_upper), initial=0.0))

    def is_better(self, one: np.ndarray, other: np.ndarray) -> bool:
        """Whether quantities are those of a better design: limits first, then the objective."""
        a, b = self.violation(one), self.violation(other)
        if max(a, b) > FEASIBLE:
            return a < b
        return bool(self.sign * one[0] < self.sign * other[0])

    def iterate(self, x: np.ndarray, found: Evaluation) -> Iterate:
        """A design as it is kept and told."""
        return Iterate(
            self.variables.parameters(x), float(found.values[0]), self.violation(found.values)
        )

    def record(self, x: np.ndarray, found: Evaluation) -> None:
        """Keep and tell a design, unless it is the last one."""
        self.reached = x, found
        if self.is_better(found.values, self.best[1].values):
            self.best = x, found
        reached = self.iterate(x, found)
        if reached.parameters == self.history[-1].parameters:
            return
        self.history.append(reached)
        if self.on_iterate is not None:
            self.on_iterate(len(self.history) - 1, reached.objective)

    def keep(self, z: np.ndarray) -> None:
        """Record a design by its values alone."""
        x = self.unscale(z)
        found = self.problem.evaluate(x, gradient=False)
        if found is not None:
            self.record(x, found)

    def fix_sizes(self, x: np.ndarray) -> None:
        """Hold each discrete variable at its size nearest to ``x``."""
        at = self.variables.snapped(x)
        for k in self.variables.sizes:
            self.lower[k] = self.upper[k] = at[k]

    def is_free(self) -> np.ndarray:
        """(n,) whether a variable has room between its bounds."""
        return self.upper > self.lower
