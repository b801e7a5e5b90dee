"""Scaled nonlinear programme for optimisers: ``min f(z), c_l ≤ c(z) ≤ c_u``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.methods.search_options import refuse_infinite_bounds
from dalembert.design.optimize.optimization_result import Iterate
from dalembert.design.optimize.problem import DesignProblem, Evaluation
from dalembert.errors import AnalysisError

FEASIBLE = 1e-6
"""Upper limit of the relative violation of a feasible design [-]."""
PENALTY = 10.0
"""Worth of a violation within this limit, in scaled objective per scaled violation [-]."""


@dataclass
class Point:
    """Scaled values and gradients at a design.

    Attributes
    ----------
    f, c : objective and (m,) constrained quantities
    g, J : (n,) and (m, n) their gradients
    """

    f: float
    c: np.ndarray
    g: np.ndarray
    J: np.ndarray


class Program:
    """Nonlinear programme: variables scaled by their ranges, quantities by their magnitudes.

    Parameters
    ----------
    problem : its first quantity is the objective, then one for every limit
    limits : in the order of these quantities
    sign : 1 to minimise, −1 to maximise
    start : (n,) initial design, which sets the scales
    sizes : (m,) scales of the limits, if taken from another program

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
        initial = problem.evaluate(self.origin)
        if initial is None:
            raise AnalysisError(f"the starting design fails: {problem.failures[-1]}")
        self.initial, self.reached = initial, (self.origin, initial)
        self.scale = self._scale(initial)
        natural_sizes = np.array([self._size(k, limit) for k, limit in enumerate(self.limits, 1)])
        self.sizes = natural_sizes if sizes is None else sizes
        self.c_lower = self._bounds("lower", -np.inf)
        self.c_upper = self._bounds("upper", np.inf)
        self.last = sign * initial.values[0] / self.scale
        self.history = [self.iterate(self.origin, initial)]
        self.best = self.reached

    # scales -----------------------------------------------------------------------------
    def _scale(self, evaluation: Evaluation) -> float:
        value, slope = abs(evaluation.values[0]), self.problem.slope(evaluation, 0) * self.width
        return float(max(value, 1e-3 * np.max(abs(slope), initial=0.0))) or 1.0

    def _size(self, row: int, limit: Limit) -> float:
        """Scale of a limit: its bound, the quantity at the start, or its slope over the ranges."""
        bounds = [abs(b) for b in (limit.lower, limit.upper) if b is not None]
        slope = (
            self.problem.slope(self.initial, row) * self.width if not any(bounds) else np.zeros(1)
        )
        reach = 1e-3 * float(np.max(abs(slope), initial=0.0))
        return float(max(*bounds, abs(self.initial.values[row]), reach, 1e-12))

    def _bounds(self, side: str, none: float) -> np.ndarray:
        bounds = [getattr(limit, side) for limit in self.limits]
        return np.array([none if b is None else b for b in bounds], dtype=float) / self.sizes

    def restart(self, z: np.ndarray) -> bool:
        """Restart from a design and rescale the objective there; False if the design fails."""
        x = self.unscale(z)
        evaluation = self.problem.evaluate(x)
        if evaluation is None:
            return False
        self.reached, self.scale = (x, evaluation), self._scale(evaluation)
        self.last = self.sign * evaluation.values[0] / self.scale
        return True

    def restore_scale(self) -> None:
        """Restore the scale of the objective at the initial design."""
        self.scale = self._scale(self.initial)

    # variables --------------------------------------------------------------------------
    @property
    def n(self) -> int:
        """Number of variables."""
        return self.lower.size

    @property
    def m(self) -> int:
        """Number of constrained quantities."""
        return len(self.limits)

    def unscale(self, z: np.ndarray) -> np.ndarray:
        """Design at ``z``, clipped to its bounds."""
        return np.clip(self.origin + self.width * z, self.lower, self.upper)

    def scaled(self, x: np.ndarray) -> np.ndarray:
        """Scaled variables of a design."""
        return (x - self.origin) / self.width

    @property
    def z_lower(self) -> np.ndarray:
        """(n,) lower bounds."""
        return self.scaled(self.lower)

    @property
    def z_upper(self) -> np.ndarray:
        """(n,) upper bounds."""
        return self.scaled(self.upper)

    def refuse_infinite_bounds(self, method: str) -> None:
        """Refuse variables without two finite bounds, for methods that sample between them.

        Raises
        ------
        AnalysisError
            Names the first such variable.
        """
        refuse_infinite_bounds(method, self.variables.names, self.lower, self.upper)

    # functions --------------------------------------------------------------------------
    def value(self, z: np.ndarray) -> tuple[float, np.ndarray] | None:
        """Scaled objective and constrained quantities; None if the run fails."""
        evaluation = self.problem.evaluate(self.unscale(z), gradient=False)
        return None if evaluation is None else self._scaled(evaluation)

    def _scaled(self, evaluation: Evaluation) -> tuple[float, np.ndarray]:
        return self.sign * evaluation.values[0] / self.scale, evaluation.values[1:] / self.sizes

    def objective(self, z: np.ndarray) -> float:
        """Objective; far above the last one if the run fails, so that line searches backtrack."""
        values = self.value(z)
        if values is None:
            return self.last + 10.0 * (1.0 + abs(self.last))
        self.last = values[0]
        return values[0]

    def constraint(self, z: np.ndarray) -> np.ndarray:
        """(m,) constrained quantities; the last successful ones if the run fails."""
        values = self.value(z)
        return self._scaled(self.reached[1])[1] if values is None else values[1]

    def point(self, z: np.ndarray, record: bool = True) -> Point | None:
        """Values and gradients; records the design as an iterate."""
        x = self.unscale(z)
        evaluation = self.problem.evaluate(x)
        if evaluation is None:
            return None
        if record:
            self.record(x, evaluation)
        rows = [self.problem.slope(evaluation, k) * self.width for k in range(1 + self.m)]
        J = np.array(rows[1:]).reshape(self.m, self.n) / self.sizes[:, None]
        return Point(*self._scaled(evaluation), self.sign * rows[0] / self.scale, J)

    def slope(self, z: np.ndarray) -> np.ndarray:
        """(n,) gradient of the objective; at the last successful design if the run fails."""
        return self._slopes(z).g

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """(m, n) gradients of the constrained quantities, likewise."""
        return self._slopes(z).J

    def _slopes(self, z: np.ndarray) -> Point:
        point = self.point(z) or self.point(self.scaled(self.reached[0]), record=False)
        assert point is not None
        return point

    # designs ----------------------------------------------------------------------------
    def violation(self, values: np.ndarray) -> float:
        """Largest relative violation of a limit."""
        c = values[1:] / self.sizes
        return float(np.max(np.maximum(self.c_lower - c, c - self.c_upper), initial=0.0))

    def is_better(self, values: np.ndarray, other: np.ndarray) -> bool:
        """Whether values belong to a better design: feasibility first, then the objective.

        Violations within the limit of feasibility count, so that a limit that is satisfied less
        accurately is no gain of the objective.
        """
        a, b = self.violation(values), self.violation(other)
        if max(a, b) > FEASIBLE:
            return a < b
        gain = self.sign * (other[0] - values[0]) / self.scale
        return bool(gain > PENALTY * (a - b))

    def iterate(self, x: np.ndarray, evaluation: Evaluation) -> Iterate:
        """Entry of a design in the history."""
        return Iterate(
            self.variables.parameters(x),
            float(evaluation.values[0]),
            self.violation(evaluation.values),
        )

    def record(self, x: np.ndarray, evaluation: Evaluation) -> None:
        """Add a design to the history and report it, unless it is the last one."""
        self.reached = x, evaluation
        if self.is_better(evaluation.values, self.best[1].values):
            self.best = x, evaluation
        iterate = self.iterate(x, evaluation)
        if iterate.parameters == self.history[-1].parameters:
            return
        self.history.append(iterate)
        if self.on_iterate is not None:
            self.on_iterate(len(self.history) - 1, iterate.objective)

    def record_values(self, z: np.ndarray) -> None:
        """Record a design without its gradient."""
        x = self.unscale(z)
        evaluation = self.problem.evaluate(x, gradient=False)
        if evaluation is not None:
            self.record(x, evaluation)

    def fix_sizes(self, x: np.ndarray) -> None:
        """Fix each discrete variable at its size nearest to ``x``."""
        at = self.variables.snapped(x)
        for k in self.variables.sizes:
            self.lower[k] = self.upper[k] = at[k]

    def is_free(self) -> np.ndarray:
        """(n,) whether the bounds of a variable differ."""
        return self.upper > self.lower
