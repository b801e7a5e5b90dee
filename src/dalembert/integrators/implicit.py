"""Base class of implicit integrators."""

from __future__ import annotations

from abc import ABC, abstractmethod

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Integrator, Problem
from dalembert.integrators.step import Step
from dalembert.options import options
from dalembert.symbolic.equations.newton import NewtonSettings


@options(kw_only=True)
class ImplicitIntegrator(Integrator, ABC):
    """Integrator that solves equations in every step by Newton's method.

    Equations count as solved when each residual is below ``tolerance`` times the terms of its
    equation (for constraints: times their change within the step), or below rounding.

    Parameters
    ----------
    tolerance : relative residual at which the iteration ends [-]
    max_iterations : upper limit of Newton iterations; a step that needs more fails

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or ``max_iterations`` below 1.
    """

    tolerance: float = 1e-12
    max_iterations: int = 20

    def __post_init__(self) -> None:
        if not self.tolerance > 0 or self.max_iterations < 1:
            raise UnsupportedError(
                f"{self.name}(tolerance={self.tolerance}, max_iterations={self.max_iterations}): "
                "the tolerance must be positive and at least one iteration allowed"
            )

    @property
    def implicit(self) -> bool:
        return True

    @property
    def newton(self) -> NewtonSettings:
        return NewtonSettings(tolerance=self.tolerance, max_iterations=self.max_iterations)

    @abstractmethod
    def step(self, problem: Problem) -> Step:
        """Step of prescribed length."""
