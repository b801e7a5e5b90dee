"""Numbers computed outside the expression graph from formulas of parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca
import numpy as np


class ComputedNumbers(ABC):
    """Numbers ``r(s(p))``: symbols in the graph that depend on formulas ``s``.

    Attributes
    ----------
    symbols : (n,) SX symbols of the numbers in the graph
    arguments : (k,) SX formulas of parameters
    """

    symbols: ca.SX
    arguments: ca.SX

    @abstractmethod
    def values(self, arguments: np.ndarray) -> np.ndarray:
        """(n,) numbers.

        Raises
        ------
        ModelError, AnalysisError
            The numbers do not exist or cannot be computed at these values.
        """

    @abstractmethod
    def push(self, arguments: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """(n, c) derivatives of the numbers along directions (k, c)."""

    @abstractmethod
    def pull(self, arguments: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(k, c) adjoints of the arguments from adjoints (n, c) of the numbers."""
