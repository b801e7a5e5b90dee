"""Last positions at which gaps were evaluated."""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

COUNT = 3
"""Number of positions: a step evaluates its start, its end and the corrected end in turns."""


class Position(Protocol):
    """Gaps at a position."""

    @property
    def configuration(self) -> Configuration: ...


P = TypeVar("P", bound=Position)


class RecentPositions(Generic[P]):
    """Gaps at the last few positions."""

    def __init__(self) -> None:
        self._positions: list[P] = []

    @property
    def last(self) -> P | None:
        """The gaps that were used last; None without any."""
        return self._positions[0] if self._positions else None

    def find(self, configuration: Configuration) -> P | None:
        """The gaps at a configuration; None if they are not stored."""
        for position in self._positions:
            if configuration.equals(position.configuration):
                return position
        return None

    def use(self, position: P) -> P:
        """The same gaps, which become the last ones; they replace others at their position."""
        place, others = position.configuration, self._positions
        others = [p for p in others if p is not position and p.configuration is not place]
        self._positions = [position, *others][:COUNT]
        return position
