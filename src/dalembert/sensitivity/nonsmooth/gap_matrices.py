"""Derivatives of gaps as sparse matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps, PlaceSlopes, SourceGaps
from dalembert.sensitivity.nonsmooth.slope_function import Sparse

NAMES = "distance", "before", "after", "laws"
"""Fields of ``GapChanges``."""


@dataclass(frozen=True, eq=False)
class MatrixGaps:
    """Gaps with matrices of derivatives, by the speeds of a path, too.

    Attributes
    ----------
    rows : (n,) numbers of the gaps among all
    values : of the gaps, or of their means over the path
    across : ``W``
    slopes : matrices of each of ``NAMES`` by ``q`` and the speeds of the path
    momentum : derivatives of ``Wᵀ P`` by the same
    count : size of ``q``
    """

    rows: np.ndarray
    values: GapChanges
    across: Sparse
    slopes: dict[str, Sparse]
    momentum: Sparse
    count: int

    def push(self, dq: np.ndarray, path: np.ndarray | None = None) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c) and of the speeds of the
        path, 0 by default."""
        rest = np.zeros((self.momentum.shape[1] - self.count, dq.shape[1]))
        change = np.vstack([dq, rest if path is None else path])
        changes = self.values.like(dq.shape[1])
        for name, slope in self.slopes.items():
            total = getattr(changes, name)
            total[:] = (slope @ change).reshape(total.shape)
        return changes, np.asarray(self.momentum @ change)

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the gaps and of ``Wᵀ P``."""
        return self._weights(weights, momentum)[: self.count]

    def pull_path(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of the speeds of the path from those of the gaps and of ``Wᵀ P``."""
        return self._weights(weights, momentum)[self.count :]

    def directions(self) -> Sparse:
        """``W`` (n k, n_v)."""
        return self.across

    def _weights(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        total, columns = self.momentum.T @ momentum, momentum.shape[1]
        for name, slope in self.slopes.items():
            total = total + slope.T @ getattr(weights, name).reshape(-1, columns)
        return np.asarray(total)


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
    place, (entry, size) = gaps.middle.moving.shape[0], gaps.start.geometry.shape
    rows = {"distance": count, "before": count * width, "laws": count * laws}
    rows |= {"both": count * width, "wrench": place}
    local = {name: _Blocks(number, entry) for name, number in rows.items()}
    across = [_Blocks(count * width, place) for _ in range(2)]
    for part in gaps.kinds:
        kind, row = part.kind, part.kind.row[:, None]
        components = width * row + np.arange(width)
        local["distance"].add(part.distance[:, None], row, part.entries)
        local["before"].add(part.before, components, part.entries)
        local["both"].add(part.both, components, part.entries)
        local["wrench"].add(part.wrenches, kind.velocities, part.entries)
        for total, blocks in zip(across, (part.start, part.blocks), strict=True):
            total.add(blocks, components, kind.velocities)
        one = np.ones((row.size, 1, 1))
        for column, entries in enumerate(kind.laws.T):
            local["laws"].add(one, laws * row + column, entries[:, None])
    slopes = {name: local[name].matrix @ gaps.start.geometry for name in ("distance", "laws")}
    before, both = (
        local[name].matrix @ at.geometry + blocks.matrix @ (at.velocities + moved)
        for name, at, blocks, moved in (
            ("before", gaps.start, across[0], _moved(gaps, gaps.start, size)),
            ("both", gaps.middle, across[1], gaps.end * _moved(gaps, gaps.middle, size)),
        )
    )
    slopes |= {"before": before, "after": both - gaps.end * before}
    wrench = local["wrench"].matrix @ gaps.middle.geometry
    slopes["momentum"] = scipy.sparse.csr_array(gaps.middle.moving.T @ wrench + gaps.momenta)
    return slopes


def _moved(gaps: SourceGaps, at: PlaceSlopes, size: int) -> Sparse:
    """``J`` in the columns of the speeds in ``q``."""
    moving = at.moving.tocoo()
    row, column = moving.coords
    places = row, gaps.speeds[column]
    return scipy.sparse.csr_array((moving.data, places), shape=(moving.shape[0], size))


def joined_matrices(gaps: Gaps) -> dict[str, Sparse]:
    """``gap_matrices`` of gaps of all sources, in their order, none of them means over a path."""
    parts = [part for part in gaps.parts if isinstance(part, SourceGaps | MatrixGaps)]
    slopes = [_of_part(part) for part in parts]
    if len(parts) == 1:
        return slopes[0]
    order, joined = np.argsort(np.concatenate([part.rows for part in parts])), {}
    for name in NAMES:
        stacked = scipy.sparse.csr_array(scipy.sparse.vstack([own[name] for own in slopes]))
        width = stacked.shape[0] // max(order.size, 1)
        joined[name] = stacked[(order[:, None] * width + np.arange(width)).ravel()]
    momenta = [own["momentum"] for own in slopes]
    return joined | {"momentum": sum(momenta[1:], momenta[0])}


def _of_part(part: SourceGaps | MatrixGaps) -> dict[str, Sparse]:
    if isinstance(part, SourceGaps):
        return gap_matrices(part)
    return part.slopes | {"momentum": part.momentum}
