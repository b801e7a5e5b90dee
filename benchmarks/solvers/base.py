"""What a solver is to the benchmarks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

Run = Callable[[int], tuple[float, np.ndarray]]
"""Steps → seconds of the integration alone, and the observed place at the end."""


@dataclass(frozen=True)
class Contestant:
    """A solver with a mechanism.

    Attributes
    ----------
    name : column of the table
    run : Run
    first : steps to begin with
    """

    name: str
    run: Run
    first: int


def installed(package: str) -> bool:
    return find_spec(package) is not None
