"""Derivatives of the gaps of a source as sparse matrices."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.sensitivity.nonsmooth.gap_slopes import SourceGaps
from dalembert.sensitivity.nonsmooth.slope_function import Sparse


class _Blocks:
    """Sum of dense blocks at rows and columns of a sparse matrix."""

    def __init__(self, rows: int, columns: int):
        self._shape = rows, columns
        self._parts = [(np.zeros(0), np.zeros(0, dtype=int), np.zeros(0, dtype=int))]

    def add(self, blocks: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> None:
        """Add blocks (n, a, b) at rows (n, a) and columns (n, b)."""
        places = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
        used = blocks != 0
        self._parts.append((blocks[used], *(place[used] for place in places)))

    @property
    def matrix(self) -> Sparse:
        """The sum."""
        values, rows, columns = (np.concatenate(p) for p in zip(*self._parts, strict=True))
        return scipy.sparse.csr_array((values, (rows, columns)), shape=self._shape)


def gap_matrices(gaps: SourceGaps) -> dict[str, Sparse]:
    """Derivatives by ``q`` of the fields of ``GapChanges``, and of ``momentum``, ``Wᵀ P``."""
    count, (width, laws) = gaps.rows.size, gaps.shape
    place, (entry, size) = gaps.moving.shape[0], gaps.geometry.shape
    rows = {"distance": count, "before": count * width, "after": count * width}
    rows |= {"laws": count * laws, "wrench": place}
    local = {name: _Blocks(number, entry) for name, number in rows.items()}
    across = _Blocks(count * width, place)
    for part in gaps.kinds:
        kind, row = part.kind, part.kind.row[:, None]
        components = width * row + np.arange(width)
        local["distance"].add(part.distance[:, None], row, part.entries)
        local["before"].add(part.before, components, part.entries)
        local["after"].add(part.after, components, part.entries)
        local["wrench"].add(part.wrenches, kind.velocities, part.entries)
        across.add(part.blocks, components, kind.velocities)
        one = np.ones((row.size, 1, 1))
        for column, entries in enumerate(kind.laws.T):
            local["laws"].add(one, laws * row + column, entries[:, None])
    slopes = {name: blocks.matrix @ gaps.geometry for name, blocks in local.items()}
    before, after = gaps.velocities
    moving = gaps.moving.tocoo()
    columns = moving.coords[1] + gaps.first
    moved = scipy.sparse.csr_array((moving.data, (moving.coords[0], columns)), shape=(place, size))
    slopes["before"] = slopes["before"] + across.matrix @ (before + moved)
    slopes["after"] = slopes["after"] + across.matrix @ after
    slopes["momentum"] = gaps.moving.T @ slopes.pop("wrench") + gaps.momenta
    return slopes
