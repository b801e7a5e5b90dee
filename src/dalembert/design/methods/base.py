"""Base class of optimisers.

A new optimiser is a frozen dataclass of options with a method ``solve``. It receives a scaled
``Program`` and does not depend on mechanisms. It calls ``program.value`` (None if a run fails: take
a shorter step) and ``program.point`` (an iterate with gradients), and never raises for a failing
design.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from dalembert.design.methods.search_options import Stop
from dalembert.design.optimize.program import Program


@dataclass
class OptimizerResult:
    """Final design and status of an optimiser.

    Attributes
    ----------
    z : (n,) scaled design
    success, message : status of the optimiser, verified afterwards
    is_complete : whether the whole search space was covered
    optima : scaled designs of all distinct optima, the best first
    """

    z: np.ndarray
    success: bool
    message: str
    is_complete: bool = True
    optima: list[np.ndarray] = field(default_factory=list)


class Optimizer(ABC):
    """Optimisation method."""

    is_global: ClassVar[bool] = False
    """Whether it searches the whole box of bounds and handles discrete variables itself."""

    @abstractmethod
    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        """Search for an optimum from ``z``."""

    def finishing(self) -> Optimizer:
        """Method that refines the final design of this one."""
        return self

    def rescue(self) -> Optimizer | None:
        """Method that continues if this one stalls before an optimum; None for none."""
        return None
