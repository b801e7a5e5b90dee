"""Wall time of the parts of a task."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

ENDING = " time [s]"
"""Suffix of times in statistics."""


class Timing:
    """Wall time of the parts of a task.

    Attributes
    ----------
    parts : name → seconds, in the order of first use
    """

    def __init__(self) -> None:
        self.parts: dict[str, float] = {}
        self._since = perf_counter()

    def lap(self, name: str) -> None:
        """Add the time since the last lap to a part."""
        now = perf_counter()
        self.parts[name] = self.parts.get(name, 0.0) + now - self._since
        self._since = now

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """Add the time of the block to a part."""
        self._since = perf_counter()
        try:
            yield
        finally:
            self.lap(name)

    @property
    def total(self) -> float:
        """Time of all parts [s]."""
        return sum(self.parts.values())

    @property
    def statistics(self) -> dict[str, float]:
        """Name → time [s], as in the statistics of results."""
        return {f"{name}{ENDING}": round(seconds, 6) for name, seconds in self.parts.items()}
