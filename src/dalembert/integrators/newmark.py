"""Newmark's method, and what it has in common with its relatives."""

from __future__ import annotations

from abc import ABC, abstractmethod

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Problem
from dalembert.integrators.implicit import ImplicitIntegrator
from dalembert.integrators.newmark_rule import NewmarkCoefficients
from dalembert.integrators.newmark_step import NewmarkStep, check
from dalembert.options import options


@options(kw_only=True)
class NewmarkFamily(ImplicitIntegrator, ABC):
    """Method given by its four coefficients, in the form of Arnold and Brüls (2007)."""

    @property
    @abstractmethod
    def coefficients(self) -> NewmarkCoefficients:
        """Coefficients of the method."""

    def check(self, problem: Problem) -> None:
        check(self.coefficients, problem, self.name)

    def step(self, problem: Problem) -> NewmarkStep:
        return NewmarkStep(self.coefficients, problem, self)


@options
class Newmark(NewmarkFamily):
    """Newmark (1959): ``v⁺ = v + h((1 − γ) v̇ + γ v̇⁺)``, positions with ``β`` likewise.

    ``γ = 1/2`` has order 2 and no damping, larger ``γ`` order 1.

    Parameters
    ----------
    gamma, beta : ``γ`` and ``β``; unconditionally stable for ``2β ≥ γ ≥ 1/2``

    Raises
    ------
    UnsupportedError
        ``γ`` below 1/2 (unstable) or ``β`` that is not positive; on running: ``γ = 1/2`` with
        ``Dae(index=3)`` and no projection, where disturbances of accelerations grow.
    """

    gamma: float = 0.5
    beta: float = 0.25

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gamma < 0.5 or not self.beta > 0:
            raise UnsupportedError(
                f"Newmark(gamma={self.gamma}, beta={self.beta}): needs gamma ≥ 1/2 (it is unstable "
                "below) and beta > 0"
            )

    @property
    def coefficients(self) -> NewmarkCoefficients:
        return NewmarkCoefficients(self.beta, self.gamma)
