"""What a case is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.sample import Row


@dataclass(frozen=True)
class Effort:
    """How much a comparison may take.

    Attributes
    ----------
    rounds : repetitions of every measurement, in turns
    limit : seconds of one run
    sizes : largest size of families, such as the number of four-bars
    quick : small sizes only, to see whether it works
    backends : of dalembert
    pictures : folder of the pictures, None for none
    """

    rounds: int = 5
    limit: float = 20.0
    sizes: int = 1000
    quick: bool = False
    backends: tuple[str, ...] = ("vm",)
    pictures: Path | None = None


@dataclass(frozen=True)
class Case:
    """A named comparison; ``measure`` gives rows as they are finished."""

    name: str
    about: str
    measure: Callable[[Effort], Iterator[Row]]
