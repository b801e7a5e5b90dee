"""Forward and backward walks through time for direct and adjoint gradients.

States follow from ``x_0(p)`` by ``x_{k+1} = S_k(x_k, p)``, and responses depend on some of them,
``Θ = Σ θ_k(x_k, p)``. Forward walks push changes through the steps, backward walks pull weights:

    dx_{k+1} = (∂S_k/∂x) dx_k + (∂S_k/∂p) dp,     dΘ = Σ (∂θ_k/∂x) dx_k + (∂θ_k/∂p) dp,
    x̄_k = (∂S_k/∂x)ᵀ x̄_{k+1} + (∂θ_k/∂x)ᵀ,       p̄ = Σ (∂S_k/∂p)ᵀ x̄_{k+1} + (∂θ_k/∂p)ᵀ.

Steps of mechanisms are taken in chunks of hundreds, steps of structures one by one.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

C = TypeVar("C")


class ForwardWalk(ABC, Generic[C]):
    """Walk from the start to the end of a run with the change of the state."""

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of steps; the number of states is one more."""

    @abstractmethod
    def push_start(self) -> C:
        """Change of the first state."""

    def ahead(self, begin: int) -> int:
        """Number of the state that one push reaches from state ``begin``."""
        return begin + 1

    @abstractmethod
    def push(self, begin: int, end: int, change: C) -> C:
        """Change of state ``end`` from that of state ``begin``.

        Evaluates the responses at all states from ``begin`` up to but excluding ``end``.
        """

    @abstractmethod
    def arrive(self, change: C) -> None:
        """Evaluate the responses at the last state."""

    def forwards(self) -> None:
        """Push through all steps."""
        change, begin = self.push_start(), 0
        while begin < self.count:
            end = self.ahead(begin)
            change, begin = self.push(begin, end, change), end
        self.arrive(change)


class BackwardWalk(ABC, Generic[C]):
    """Walk from the end to the start of a run with the weight of the state."""

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of steps; the number of states is one more."""

    @abstractmethod
    def depart(self) -> C:
        """Weight of the last state in the responses."""

    def behind(self, end: int) -> int:
        """Number of the state that one pull reaches from state ``end``."""
        return end - 1

    @abstractmethod
    def pull(self, begin: int, end: int, weights: C) -> C:
        """Weight of state ``begin`` from that of state ``end``.

        Adds the weights in the responses of all states from ``begin`` up to but excluding ``end``.
        """

    @abstractmethod
    def pull_start(self, weights: C) -> None:
        """Add the weight of the first state to those of the parameters."""

    def backwards(self) -> None:
        """Pull through all steps."""
        weights, end = self.depart(), self.count
        while end > 0:
            begin = self.behind(end)
            weights, end = self.pull(begin, end, weights), begin
        self.pull_start(weights)
