"""What solves with a sparse matrix, again and again."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np


class SparseSolver(ABC):
    """Solutions of ``A x = b`` for one matrix and many right-hand sides.

    Attributes
    ----------
    name : of what solves, for people
    """

    name: str

    @abstractmethod
    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """``A⁻¹ b`` for right-hand sides (n,) or (n, k); ``A⁻ᵀ b`` where ``trans`` is ``"T"``."""


class Factors(SparseSolver):
    """A matrix taken apart into triangles."""

    @property
    @abstractmethod
    def negative(self) -> int:
        """Negative pivots; for symmetric elimination without pivoting, negative eigenvalues."""
