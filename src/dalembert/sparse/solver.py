"""Interfaces of sparse solvers and factors."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np


class SparseSolver(ABC):
    """Solutions of ``A x = b`` for one matrix and many right-hand sides.

    Attributes
    ----------
    name : name of the solver for reports
    """

    name: str

    @abstractmethod
    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """``A⁻¹ b`` for right-hand sides (n,) or (n, k); ``A⁻ᵀ b`` if ``trans`` is ``"T"``."""


class Factors(SparseSolver):
    """Triangular factors of a matrix."""

    @property
    @abstractmethod
    def negative(self) -> int:
        """Number of negative pivots; without pivoting the number of negative eigenvalues."""
