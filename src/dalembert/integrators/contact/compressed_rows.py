"""Matrices compressed by rows, for machine code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Rows(NamedTuple):
    """A matrix compressed by rows, with the attributes of SciPy's arrays.

    Attributes
    ----------
    data, indices : entries and their columns
    indptr : (rows + 1,) first entry of each row
    shape : of the matrix
    """

    data: np.ndarray
    indices: np.ndarray
    indptr: np.ndarray
    shape: tuple[int, int]

    @classmethod
    def of(cls, matrix: np.ndarray) -> Rows:
        """The entries of an array that are not zero."""
        row, column = np.nonzero(matrix)
        starts = np.searchsorted(row, np.arange(matrix.shape[0] + 1)).astype(np.int32)
        shape = matrix.shape[0], matrix.shape[1]
        return cls(matrix[row, column], column.astype(np.int32), starts, shape)
