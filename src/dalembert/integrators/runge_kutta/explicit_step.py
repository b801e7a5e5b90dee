"""Explicit Runge–Kutta step, ``x⁺ = P(x + h Σ b_i k_i)`` with ``P`` the correction."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.integrators.runge_kutta.explicit_second import second_derivative
from dalembert.integrators.runge_kutta.explicit_stages import advanced, needed_stages, stages
from dalembert.integrators.runge_kutta.prepared_stages import PreparedStages
from dalembert.integrators.runge_kutta.tableau import ButcherTableau
from dalembert.integrators.step import Step
from dalembert.symbolic.equations.implicit import ImplicitFunction


class ExplicitStep(Step):
    """Explicit Runge–Kutta step ``(t, h, x, p) → x⁺``.

    Parameters
    ----------
    tableau : ButcherTableau
    rhs : ImplicitFunction ``(t, x, p) → ẋ``
    correction : ImplicitFunction ``(t, x, p) → x``, or None
    upkeep : the same for a step without correction, or None
    """

    def __init__(
        self,
        tableau: ButcherTableau,
        rhs: ImplicitFunction,
        correction: ImplicitFunction | None,
        upkeep: ImplicitFunction | None = None,
    ):
        self.tableau, self.rhs, self.upkeep = tableau, rhs, upkeep
        self.finish = upkeep if correction is None else correction
        _, self.size, self.parameter_count = rhs.input_sizes
        self.state_size = self.size
        self.corrects = correction is not None

    def stages(self, t, h, x, p, count: int | None = None) -> tuple[list[Any], list[Any]]:
        """Stage states ``X_i`` and slopes ``k_i``; by default of all stages."""
        count = self.tableau.stages if count is None else count
        return stages(self.tableau, self.rhs.function, t, h, x, p, count)

    def advance(self, t, h, x, slopes, p) -> Any:
        """The new state after the correction."""
        new = advanced(self.tableau, h, x, slopes)
        return new if self.finish is None else self.finish.function(t + h, new, p)

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols(ca.SX)
        _, slopes = self.stages(t, h, x, p, needed_stages(self.tableau))
        new = self.advance(t, h, x, slopes, p)
        return ca.Function("step", [t, h, x, p], [new], self.prepared.cse)

    @cached_property
    def prepared(self) -> PreparedStages:
        return PreparedStages(self.tableau, self.rhs, self.finish)

    @cached_property
    def second(self) -> ca.Function:
        return second_derivative(self.tableau, self.rhs, self.finish)

    @cached_property
    def plain(self) -> ExplicitStep:
        return ExplicitStep(self.tableau, self.rhs, None, self.upkeep)

    @property
    def rate(self) -> ImplicitFunction:
        return self.rhs

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray]:
        return self.tableau.stability
