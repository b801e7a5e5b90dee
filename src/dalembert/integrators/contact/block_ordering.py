"""Order of elimination of the speeds of bodies, body by body, and the blocks of the factors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

ORDERING = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 1e-3,
    "options": {"SymmetricMode": True},
}
"""Ordering for symmetric patterns; diagonal pivots unless they are small."""
KEPT = 1.3
"""Upper limit of the pairs of bodies of a new order, with those of the order before, relative to
those in contact [-]."""


@dataclass(frozen=True, eq=False)
class BlockOrdering:
    """Blocks of a matrix ``A + Wᵀ G W`` and of its factors, in the order of elimination.

    Attributes
    ----------
    owner, position : (n,) block of each speed, and its place in the block
    first, row : (b + 1,) first block below each one of the diagonal, and the rows of all of these
    members : (b, w) speeds of each block, -1 for padding
    pairs : sorted numbers of the pairs of bodies that the blocks cover
    """

    owner: np.ndarray
    position: np.ndarray
    first: np.ndarray
    row: np.ndarray
    members: np.ndarray
    pairs: np.ndarray

    @property
    def entries(self) -> int:
        """Number of entries of all blocks."""
        blocks, size = self.members.shape
        return (blocks + 2 * self.row.size) * size**2


class BlockOrderings:
    """Orders of a model's speeds; the last one is used as long as it covers all contacts.

    Parameters
    ----------
    sizes : (b,) numbers of speeds of the bodies, which are consecutive
    coupled : (2, m) rows and columns of other entries of the matrix
    """

    def __init__(self, sizes: np.ndarray, coupled: np.ndarray):
        self._sizes, self._body = sizes, np.repeat(np.arange(sizes.size), sizes)
        first, second = self._body[coupled]
        self._coupled = self._numbers(first, second)
        self._last: BlockOrdering | None = None
        self._covered: scipy.sparse.csr_array | None = None

    def forget(self) -> None:
        """Begin anew, so that results do not depend on earlier runs, by rounding."""
        self._last = self._covered = None

    def repeated(self, count: int) -> BlockOrderings:
        """Orders of the speeds of several steps that follow one another."""
        first, step = np.cumsum(self._sizes) - self._sizes, np.arange(count)[:, None]
        coupled = first[np.stack(np.divmod(self._coupled, self._sizes.size))]
        coupled = (coupled[:, None] + self._body.size * step).reshape(2, -1)
        return BlockOrderings(np.tile(self._sizes, count), coupled)

    def __call__(self, directions: scipy.sparse.csr_array, width: int) -> BlockOrdering:
        """Order for contacts with ``width`` rows of directions each."""
        last = self._last
        if last is not None and directions is self._covered:
            return last
        self._covered = directions
        return self._covering(self._pairs(directions, width))

    def between(self, first: np.ndarray, second: np.ndarray) -> BlockOrdering:
        """Order for contacts between bodies (n,) and (n,)."""
        self._covered = None
        pairs = self._numbers(first, second)
        return self._covering(np.union1d(pairs, self._coupled))

    def _covering(self, pairs: np.ndarray) -> BlockOrdering:
        """The last order if it covers pairs of bodies, otherwise a new one."""
        last = self._last
        if last is not None:
            place = np.searchsorted(last.pairs, pairs)
            if place.max(initial=-1) < last.pairs.size and (last.pairs[place] == pairs).all():
                return last
            joined = np.union1d(last.pairs, pairs)
            pairs = joined if joined.size <= KEPT * pairs.size else pairs
        self._last = self._ordered(pairs)
        return self._last

    def _numbers(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Sorted numbers of pairs of different bodies."""
        low, high = np.minimum(first, second), np.maximum(first, second)
        return np.unique((low * self._sizes.size + high)[low != high])

    def _pairs(self, directions: scipy.sparse.csr_array, width: int) -> np.ndarray:
        """Sorted numbers of the pairs of bodies in contact, and of those coupled otherwise."""
        starts = directions.indptr[::width].astype(int)
        bodies, starts = self._body[directions.indices], starts[:-1][np.diff(starts) > 0]
        if not starts.size:
            return self._coupled
        low, high = np.minimum.reduceat(bodies, starts), np.maximum.reduceat(bodies, starts)
        sizes = np.diff(np.append(starts, bodies.size))
        ends = (bodies == np.repeat(low, sizes)) | (bodies == np.repeat(high, sizes))
        pairs = self._numbers(low, high)
        if not ends.all():  # contacts of more than two bodies, such as beams between nodes
            contact = np.repeat(np.arange(starts.size), sizes)
            ones = np.ones(bodies.size)
            shape = starts.size, self._sizes.size
            incidence = scipy.sparse.csr_array((ones, (contact, bodies)), shape=shape)
            graph = scipy.sparse.coo_array(incidence.T @ incidence)
            pairs = self._numbers(graph.row, graph.col)
        return np.union1d(pairs, self._coupled) if self._coupled.size else pairs

    def _ordered(self, pairs: np.ndarray) -> BlockOrdering:
        """Minimum degree order of the bodies; the pattern of their factors is that of a graph
        Laplacian plus one, in which nothing cancels."""
        count, width = self._sizes.size, int(self._sizes.max(initial=1))
        low, high = np.divmod(pairs, count)
        ends = np.concatenate([low, high])
        data = np.concatenate([-np.ones(ends.size), 1.0 + np.bincount(ends, minlength=count)])
        diagonal = np.arange(count)
        rows = np.concatenate([ends, diagonal]), np.concatenate([high, low, diagonal])
        laplacian = scipy.sparse.csc_array((data, rows), shape=(count, count))
        factors = scipy.sparse.linalg.splu(laplacian, **ORDERING)
        lower = factors.L.tocsc()
        lower.sort_indices()
        column = np.repeat(np.arange(count), np.diff(lower.indptr))
        below = lower.indices > column
        first = np.searchsorted(column[below], np.arange(count + 1))
        rank = factors.perm_c.astype(int)
        start = np.cumsum(self._sizes) - self._sizes
        position = np.arange(self._body.size) - start[self._body]
        members = np.full((count, width), -1)
        members[rank[self._body], position] = np.arange(self._body.size)
        indices = rank[self._body], position, first, lower.indices[below], members
        arrays: list[np.ndarray] = [np.asarray(part, dtype=np.int32) for part in indices]
        return BlockOrdering(arrays[0], arrays[1], arrays[2], arrays[3], arrays[4], pairs)
