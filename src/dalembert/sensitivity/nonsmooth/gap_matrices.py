"""Derivatives of gaps as sparse matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps, PlaceSlopes, SourceGaps
from dalembert.sensitivity.nonsmooth.triplets import Sparse

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
    gaps, count, (width, laws) = gaps.by_rows, gaps.rows.size, gaps.shape
    place, entry = gaps.middle.moving.shape[0], gaps.start.geometry.shape[0]
    rows = {"before": count * width, "laws": count * laws, "first": count * width}
    local = {name: _Blocks(number, entry) for name, number in rows.items()}
    both = _Blocks(count * width, entry)
    across = [_Blocks(count * width, place) for _ in range(2)]
    for part in gaps.kinds:
        kind, row = part.kind, part.kind.row[:, None]
        components = width * row + np.arange(width)
        local["before"].add(part.before, components, part.entries)
        both.add(part.both, components, part.entries)
        local["first"].add(part.both_first, components, part.first)
        for total, blocks in zip(across, (part.start, part.blocks), strict=True):
            total.add(blocks, components, kind.velocities)
        one = np.ones((row.size, 1, 1))
        for column, entries in enumerate(kind.laws.T):
            local["laws"].add(one, laws * row + column, entries[:, None])
    slopes = {name: blocks.matrix @ gaps.start.geometry for name, blocks in local.items()}
    start, middle = _velocities(gaps)
    slopes["before"] = slopes["before"] + across[0].matrix @ start
    both_slopes = both.matrix @ gaps.middle.geometry + across[1].matrix @ middle
    slopes["after"] = both_slopes + slopes.pop("first") - gaps.end * slopes["before"]
    return slopes | {"distance": _distances(gaps), "momentum": _momentum(gaps)}


def _distances(gaps: SourceGaps) -> Sparse:
    """Derivatives of the distances by ``q``."""
    local = _Blocks(gaps.rows.size, gaps.start.geometry.shape[0])
    for part in gaps.kinds:
        local.add(part.distance[:, None], part.kind.row[:, None], part.entries)
    return local.matrix @ gaps.start.geometry


def _momentum(gaps: SourceGaps) -> Sparse:
    """Derivatives of ``Wᵀ P`` by ``q``."""
    shape = gaps.middle.moving.shape[0], gaps.middle.geometry.shape[0]
    wrench, first = _Blocks(*shape), _Blocks(*shape)
    for part in gaps.kinds:
        wrench.add(part.wrenches, part.kind.velocities, part.entries)
        first.add(part.wrenches_first, part.kind.velocities, part.first)
    wrenches = wrench.matrix @ gaps.middle.geometry + first.matrix @ gaps.start.geometry
    by_q = gaps.middle.moving.T @ wrenches + gaps.momenta
    return scipy.sparse.csr_array(by_q)


def _weighted(gaps: SourceGaps, weights: dict[str, np.ndarray]) -> Sparse:
    """``weighted_sums`` of one source, whose weights multiply the derivatives of gaps first."""
    (width, _), end = gaps.shape, gaps.end
    places = [gaps.start.geometry, gaps.middle.geometry, *_velocities(gaps)]
    first, ahead, start, middle = np.cumsum([0, *(place.shape[0] for place in places[:-1])])
    blocks = _Blocks(gaps.rows.size * width, middle + places[-1].shape[0])
    for part in gaps.kinds:
        kind = part.kind
        own = {name: weights[name][gaps.rows[kind.row]] for name in NAMES}
        components = width * kind.row[:, None] + np.arange(width)
        before, after = own["before"] - end * own["after"], own["after"]
        distances = own["distance"] * part.distance[:, None]
        blocks.add(distances + before @ part.before, components, first + part.entries)
        blocks.add(own["laws"][:, :, : kind.laws.shape[1]], components, first + kind.laws)
        blocks.add(after @ part.both, components, ahead + part.entries)
        blocks.add(after @ part.both_first, components, first + part.first)
        blocks.add(before @ part.start, components, start + kind.velocities)
        blocks.add(after @ part.blocks, components, middle + kind.velocities)
    return blocks.matrix @ scipy.sparse.vstack(places, "csr")


def _velocities(gaps: SourceGaps) -> tuple[Sparse, Sparse]:
    """Derivatives of ``τ`` at the start and in the middle by ``q``, also by the speeds in it."""
    start, middle = (place.velocities for place in (gaps.start, gaps.middle))
    moved = _moved(gaps, gaps.start), gaps.end * _moved(gaps, gaps.middle)
    return start + moved[0], middle + moved[1]


def _moved(gaps: SourceGaps, at: PlaceSlopes) -> Sparse:
    """``J`` in the columns of the speeds in ``q``."""
    moving, size = at.moving.tocoo(), at.geometry.shape[1]
    row, column = moving.coords
    places = row, gaps.speeds[column]
    return scipy.sparse.csr_array((moving.data, places), shape=(moving.shape[0], size))


def joined_matrices(gaps: Gaps) -> dict[str, Sparse]:
    """``gap_matrices`` of gaps of all sources, in their order, none of them means over a path."""
    parts = [part for part in gaps.parts if isinstance(part, SourceGaps | MatrixGaps)]
    slopes = [_of_part(part) for part in parts]
    rows = [part.rows for part in parts]
    joined = {name: _in_order(rows, [own[name] for own in slopes]) for name in NAMES}
    momenta = [own["momentum"] for own in slopes]
    return joined | {"momentum": sum(momenta[1:], momenta[0])}


def weighted_sums(gaps: Gaps, weights: dict[str, np.ndarray]) -> Sparse:
    """(n k, n_q) derivatives by ``q`` of sums of the fields ``NAMES`` of each gap with weights
    (n, k, m), constant themselves; for gaps without means over a path."""
    parts = _of_sources(gaps)
    return _in_order([part.rows for part in parts], [_weighted(part, weights) for part in parts])


def distance_slopes(gaps: Gaps) -> Sparse:
    """(n, n_q) derivatives of the distances by ``q``, for gaps without means over a path."""
    parts = _of_sources(gaps)
    return _in_order([part.rows for part in parts], [_distances(part) for part in parts])


def momentum_slopes(gaps: Gaps) -> Sparse:
    """(n_v, n_q) derivatives of ``Wᵀ P`` by ``q``, for gaps without means over a path."""
    momenta = [_momentum(part) for part in _of_sources(gaps)]
    return sum(momenta[1:], momenta[0])


def _of_sources(gaps: Gaps) -> list[SourceGaps]:
    return [part.by_rows for part in gaps.parts if isinstance(part, SourceGaps)]


def _in_order(rows: list[np.ndarray], matrices: list[Sparse]) -> Sparse:
    """Matrices of parts, with as many rows for each of the gaps ``rows``, in the order of these."""
    if len(matrices) == 1:
        return matrices[0]
    order = np.argsort(np.concatenate(rows))
    stacked = scipy.sparse.csr_array(scipy.sparse.vstack(matrices))
    width = stacked.shape[0] // max(order.size, 1)
    return stacked[(order[:, None] * width + np.arange(width)).ravel()]


def _of_part(part: SourceGaps | MatrixGaps) -> dict[str, Sparse]:
    if isinstance(part, SourceGaps):
        return gap_matrices(part)
    return part.slopes | {"momentum": part.momentum}
