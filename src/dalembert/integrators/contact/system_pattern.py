"""Sparsity of the equations of Newton's method for contacts, in speeds and joint multipliers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.integrators.contact.compressed_rows import Rows
from dalembert.symbolic.evaluation.kernel import Matrix


@dataclass(frozen=True, eq=False)
class SystemPattern:
    """Entries of ``[[A + Wᵀ G W, Cᵀ], [C, 0]]`` by columns, and their origin.

    Attributes
    ----------
    constant : (e,) values of ``A`` and ``C``
    rows, pointers : (e,) row of each entry, (n + m + 1,) first entry of each column
    start, column : (contacts + 1,) first speed of each contact, and all speeds of contacts
    local : (w,) position of each entry of ``W`` among the speeds of its contact
    block, place : (contacts,) first entry of the block of each contact, and the places of the
        entries of all blocks
    """

    constant: np.ndarray
    rows: np.ndarray
    pointers: np.ndarray
    start: np.ndarray
    column: np.ndarray
    local: np.ndarray
    block: np.ndarray
    place: np.ndarray

    @classmethod
    def of(cls, directions: Rows, inertia: Matrix, joints: Matrix, width: int) -> SystemPattern:
        """Pattern for contacts with ``width`` rows of ``W`` each."""
        count, n = directions.shape[0] // width, directions.shape[1]
        size = n + joints.shape[0]
        contact = np.repeat(np.arange(directions.shape[0]) // width, np.diff(directions.indptr))
        keys, local = np.unique(contact * n + directions.indices, return_inverse=True)
        start = np.searchsorted(keys, np.arange(count + 1) * n)
        column, widths = keys % n, np.diff(start)
        block = np.cumsum(widths**2) - widths**2
        owner = np.repeat(np.arange(count), widths**2)
        position = np.arange(owner.size) - block[owner]
        across, down = np.divmod(position, widths[owner])
        blocks = column[start[owner] + across] * size + column[start[owner] + down]
        a, c = (scipy.sparse.coo_array(matrix) for matrix in (inertia, joints))
        fixed = [a.col * size + a.row, c.col * size + n + c.row, (n + c.row) * size + c.col]
        numbers = np.concatenate([*fixed, blocks], dtype=np.int64)
        entries, place = np.unique(numbers, return_inverse=True)
        constant, split = np.zeros(entries.size), a.nnz + 2 * c.nnz
        np.add.at(constant, place[:split], np.concatenate([a.data, c.data, c.data]))
        pointers = np.searchsorted(entries, np.arange(size + 1) * size)
        parts = entries % size, pointers, start, column, local - start[contact], block
        indices = (np.ascontiguousarray(part, dtype=np.int32) for part in (*parts, place[split:]))
        return cls(constant, *indices)
