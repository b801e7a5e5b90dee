"""Residuals of equations, relative to their terms."""

from __future__ import annotations

import numpy as np

from dalembert.sensitivity.nonsmooth.proximal_factors import Block, entries_of

SOLVED = 1e-8
"""Tolerance of a residual relative to its terms [-]."""


def terms_of(right: np.ndarray, matrix: list[Block], z: np.ndarray) -> np.ndarray:
    """Sums of the magnitudes of the terms of equations, and of their residuals."""
    terms = np.abs(right)
    for block in map(entries_of, matrix):
        terms += np.bincount(block.row, np.abs(block.value * z[block.column]), terms.size)
    return terms


def is_solved(right: np.ndarray, matrix: list[Block], z: np.ndarray) -> bool:
    """Whether a residual is small, relative to the largest of its terms."""
    largest = terms_of(right, matrix, z).max(initial=1.0)
    return bool(np.abs(right).max(initial=0.0) <= SOLVED * largest)
