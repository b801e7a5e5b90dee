"""Where the time of a task goes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

ENDING = " time [s]"
"""What statistics call a time."""


class Timing:
    """Wall time of the parts of a task.

    Attributes
    ----------
    parts : name → seconds, in the order in which they came first
    """

    def __init__(self) -> None:
        self.parts: dict[str, float] = {}
        self._since = perf_counter()

    def lap(self, name: str) -> None:
        """What was done since the last lap was this part."""
        now = perf_counter()
        self.parts[name] = self.parts.get(name, 0.0) + now - self._since
        self._since = now

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """What is done inside is this part."""
        self._since = perf_counter()
        try:
            yield
        finally:
            self.lap(name)

    @property
    def total(self) -> float:
        """Seconds of all parts."""
        return sum(self.parts.values())

    @property
    def statistics(self) -> dict[str, float]:
        """The same as results tell it."""
        return {f"{name}{ENDING}": round(seconds, 6) for name, seconds in self.parts.items()}
