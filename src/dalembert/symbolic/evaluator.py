"""What methods ask of equations, whether a graph evaluates them or sums over many elements.

Equations ``r(z, x) = 0`` determine an unknown ``z`` from what is given, ``x``: parameters, and what
was found before. Near a solution they are asked for

    value             r, with the scale of its terms (``newton.Residual``)
    tangents          K = ∂r/∂z, by what solves with it:  K⁻¹ b  and  K⁻ᵀ w
    push              dr = (∂r/∂x) dx     of a change of what is given
    pull              x̄ = (∂r/∂x)ᵀ w      of weights of the equations

and whatever is made of them follows: Newton's step, and by the theorem of implicit functions

    ż = −K⁻¹ (∂r/∂x) ẋ,        x̄ = −(∂r/∂x)ᵀ K⁻ᵀ z̄.

A ``Stage`` of an ``ImplicitFunction`` answers with expressions of a graph, an ``Unknown`` of a
structure (``analysis/structural/instant.py``) with columns of numbers and sparse factors.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any


class Evaluator(ABC):
    """Equations for an unknown, near a solution."""

    @abstractmethod
    def solve(self, rhs: Any) -> Any:
        """``K⁻¹ b``."""

    @abstractmethod
    def solve_transposed(self, weights: Any) -> Any:
        """``K⁻ᵀ w``."""

    @abstractmethod
    def push(self, change: Any) -> Any:
        """Change of the equations with what is given, the unknown held."""

    @abstractmethod
    def pull(self, weights: Any) -> Any:
        """Weights of what is given from those of the equations."""

    def correction(self, value: Any) -> Any:
        """What the unknown must change by where the equations are off by this value."""
        return -self.solve(value)

    def moved(self, change: Any) -> Any:
        """Change of the unknown with what is given."""
        return self.correction(self.push(change))

    def weighed(self, weights: Any) -> Any:
        """Weights of what is given from those of the unknown."""
        return self.pull(-self.solve_transposed(weights))
