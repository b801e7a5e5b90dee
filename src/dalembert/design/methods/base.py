"""What an optimiser is.

A new one is a frozen dataclass of options with ``solve``; it sees a ``Program`` in scaled numbers
and nothing of mechanisms. It asks for ``program.value`` (None where a run fails: step back) and
``program.point`` (an iterate, with gradients), and never raises for a design that fails.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from dalembert.design.methods.stop import Stop
from dalembert.design.optimize.program import Program


@dataclass
class Ended:
    """How an optimiser ended, in its own words.

    Attributes
    ----------
    z : design
    success, message : its word, which is checked afterwards
    is_whole : all was searched that there is to search
    optima : scaled designs of all distinct optima found, the best first
    """

    z: np.ndarray
    success: bool
    message: str
    is_whole: bool = True
    optima: list[np.ndarray] = field(default_factory=list)


class Optimizer(ABC):
    """A method of optimisation."""

    is_global: ClassVar[bool] = False
    """It looks everywhere between the bounds, and finds sizes of catalogues by itself."""

    @abstractmethod
    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        """The best design from ``z`` on."""

    def finishing(self) -> Optimizer:
        """Method that sharpens the design at which this one ends."""
        return self

    def rescue(self) -> Optimizer | None:
        """What goes on where this one is stuck short of an optimum."""
        return None
