"""Last positions at which gaps were evaluated."""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

COUNT = 3
"""Number of positions: a step evaluates its start, its end and the corrected end in turns."""
AHEAD = 1.25
"""Reach of a search relative to the request; it then suffices for the end of a step, the start of
the next one, and faster bodies in later steps."""


class Position(Protocol):
    """Gaps at a position."""

    @property
    def configuration(self) -> Configuration: ...


P = TypeVar("P", bound=Position)


class RecentPositions(Generic[P]):
    """Gaps at the last few positions.

    Attributes
    ----------
    last : those that were used last; None without any
    """

    def __init__(self) -> None:
        self._positions: dict[tuple, P] = {}
        self.last: P | None = None

    def find(self, configuration: Configuration) -> P | None:
        """The gaps at a configuration; None if they are not stored."""
        return self._positions.get(configuration.key)

    def use(self, position: P) -> P:
        """The same gaps, which become the last ones; they replace others at their position."""
        if position is self.last:
            return position
        key = position.configuration.key
        self._positions.pop(key, None)
        if len(self._positions) == COUNT:
            self._positions.pop(next(iter(self._positions)))
        self._positions[key] = self.last = position
        return position
