"""The walk through time of direct and adjoint gradients, whatever the steps are made of.

States follow one another, ``x_0(p)`` and ``x_{k+1} = S_k(x_k, p)``, and responses see some of them,
``Θ = Σ θ_k(x_k, p)``. Forwards a change is pushed through the steps, backwards a weight pulled:

    dx_{k+1} = (∂S_k/∂x) dx_k + (∂S_k/∂p) dp,     dΘ = Σ (∂θ_k/∂x) dx_k + (∂θ_k/∂p) dp,
    x̄_k = (∂S_k/∂x)ᵀ x̄_{k+1} + (∂θ_k/∂x)ᵀ,       p̄ = Σ (∂S_k/∂p)ᵀ x̄_{k+1} + (∂θ_k/∂p)ᵀ.

Steps of a graph are taken by the hundred in one call, those of structures one by one.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

C = TypeVar("C")


class ForwardWalk(ABC, Generic[C]):
    """From the start to the end of a run, with the change of the state."""

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of steps; of their ends, the states, there is one more."""

    @abstractmethod
    def push_start(self) -> C:
        """Change of the first state."""

    def ahead(self, begin: int) -> int:
        """The state that is reached at once from another one."""
        return begin + 1

    @abstractmethod
    def push(self, begin: int, end: int, change: C) -> C:
        """Change of a state from that of an earlier one.

        Responses take what they see of this one and all on the way, but for the end.
        """

    @abstractmethod
    def arrive(self, change: C) -> None:
        """Responses take what they see of the last state."""

    def forwards(self) -> None:
        """All steps."""
        change, begin = self.push_start(), 0
        while begin < self.count:
            end = self.ahead(begin)
            change, begin = self.push(begin, end, change), end
        self.arrive(change)


class BackwardWalk(ABC, Generic[C]):
    """From the end to the start of a run, with the weight of the state."""

    @property
    @abstractmethod
    def count(self) -> int:
        """Number of steps; of their ends, the states, there is one more."""

    @abstractmethod
    def depart(self) -> C:
        """What responses weigh the last state."""

    def behind(self, end: int) -> int:
        """The state that is reached at once from a later one."""
        return end - 1

    @abstractmethod
    def pull(self, begin: int, end: int, weights: C) -> C:
        """Weight of a state from that of a later one.

        What responses weigh this one and all on the way is added, but for the end.
        """

    @abstractmethod
    def pull_start(self, weights: C) -> None:
        """Take the weight of the first state to the parameters."""

    def backwards(self) -> None:
        """All steps."""
        weights, end = self.depart(), self.count
        while end > 0:
            begin = self.behind(end)
            weights, end = self.pull(begin, end, weights), begin
        self.pull_start(weights)
