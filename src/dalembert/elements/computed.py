"""Numbers of a mechanism that are computed outside of its graph, from formulas of parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca
import numpy as np


class ComputedNumbers(ABC):
    """Numbers ``r(s(p))``: symbols in the graph, and formulas ``s`` that they follow.

    Attributes
    ----------
    symbols : (n,) SX, by which the graph knows the numbers
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
            There cannot be any at these values; they cannot be found.
        """

    @abstractmethod
    def push(self, arguments: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """(n, c) their changes along directions (k, c)."""

    @abstractmethod
    def pull(self, arguments: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(k, c) weights of the arguments from weights (n, c) of the numbers."""
