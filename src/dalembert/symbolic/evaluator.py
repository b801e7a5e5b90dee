"""Interface of equations to Newton's method and to implicit differentiation.

Equations ``r(z, x) = 0`` determine an unknown ``z`` from inputs ``x``: parameters and the results
of earlier equations. Near a solution an evaluator provides

    value             r, with the scale of its terms (``newton.Residual``)
    solve             K⁻¹ b  and  K⁻ᵀ w  with the Jacobian K = ∂r/∂z
    push              dr = (∂r/∂x) dx     for a change of the inputs
    pull              x̄ = (∂r/∂x)ᵀ w      for weights of the equations

Newton's step follows, and by the implicit function theorem

    ż = −K⁻¹ (∂r/∂x) ẋ,        x̄ = −(∂r/∂x)ᵀ K⁻ᵀ z̄.

A ``Stage`` of an ``ImplicitFunction`` evaluates expressions of a graph, an ``Unknown`` of a
structure (``analysis/transient/instant.py``) columns of numbers with sparse factors.
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
        """Change of the equations with their inputs at a fixed unknown."""

    @abstractmethod
    def pull(self, weights: Any) -> Any:
        """Weights of the inputs from weights of the equations."""

    def correction(self, value: Any) -> Any:
        """Newton correction of the unknown for a residual."""
        return -self.solve(value)

    def tangent(self, change: Any) -> Any:
        """Change of the unknown with the inputs."""
        return self.correction(self.push(change))

    def adjoint(self, weights: Any) -> Any:
        """Weights of the inputs from weights of the unknown."""
        return self.pull(-self.solve_transposed(weights))
