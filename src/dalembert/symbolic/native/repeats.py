"""Parts of a straight body that are equal but for where their numbers are.

Equal elements of a model leave equal sequences of operations. The body is cut where a hash of the
last few operations says so (content-defined chunking, Muthitacharoen et al. 2001): equal sequences
are cut at equal places, wherever they stand. Pieces that almost always follow each other are
joined.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.symbolic.native.operations import Operations

WINDOW = 6
"""Operations that decide whether there is a cut after them."""
ONE_IN, LEAST, MOST = 8, 20, 200
"""A cut after one in so many windows, and the least and most operations of a piece at first."""
TOGETHER = 0.9
"""Share of their occurrences from which two pieces that follow each other are joined."""
OFTEN = 8
"""Occurrences of two together from which it is enough that one is hardly ever without the other."""
OUTSIDE = 1 << 40
"""From here on references count what comes from other pieces."""


@dataclass(frozen=True)
class Pieces:
    """A body cut into pieces.

    Attributes
    ----------
    operations : Operations
    cuts : where pieces begin, and the end
    """

    operations: Operations
    cuts: np.ndarray

    @classmethod
    def whole(cls, operations: Operations) -> Pieces:
        """All in one."""
        return cls(operations, np.array([0, operations.count]))

    @property
    def count(self) -> int:
        return len(self.cuts) - 1

    @property
    def lengths(self) -> np.ndarray:
        return np.diff(self.cuts)

    @cached_property
    def piece(self) -> np.ndarray:
        """The piece that each operation is in."""
        return np.repeat(np.arange(self.count), self.lengths)

    @cached_property
    def kept(self) -> np.ndarray:
        """Whether a later piece reads the value of each operation."""
        return self.operations.last_use >= self.cuts[self.piece + 1]

    @cached_property
    def outside(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Operands from other pieces, by twice the operation, and one more for the second.

        Returns
        -------
        use : where operands come from other pieces
        number : which one of its piece it is, in the order of their first uses
        new : whether it is the first use
        """
        o, begin = self.operations, self.cuts[self.piece]
        slots = np.column_stack([o.first, o.second]).ravel()
        sources = np.column_stack(o.sources).ravel()
        use = np.flatnonzero((slots >= 0) & (sources < np.repeat(begin, 2)))
        piece = self.piece[use // 2]
        keys = piece * (1 + o.target.max(initial=0)) + slots[use]
        _, firsts, which = np.unique(keys, return_index=True, return_inverse=True)
        rank = np.empty(len(firsts), dtype=np.int64)
        rank[np.argsort(firsts)] = np.arange(len(firsts))
        new = np.zeros(len(use), dtype=bool)
        new[firsts] = True
        before = np.concatenate([[0], np.cumsum(np.bincount(piece[new], minlength=self.count))])
        return use, rank[which] - before[piece], new

    @cached_property
    def _forms(self) -> np.ndarray:
        """What each operation does and where its operands come from, seen from its piece."""
        o, here = self.operations, np.arange(self.operations.count)
        operands = np.column_stack([o.first, o.second])
        inside = 1 + here[:, None] - np.column_stack(o.sources)
        forms = np.where(operands >= 0, inside, operands).ravel()
        use, number, _ = self.outside
        forms[use] = OUTSIDE + number
        return np.column_stack([o.what, forms.reshape(-1, 2), self.kept])

    @cached_property
    def labels(self) -> np.ndarray:
        """A number for each piece, equal for equal ones: that of the first such piece."""
        if not self.operations.count:
            return np.arange(self.count)
        within = np.arange(self.operations.count) - self.cuts[self.piece]
        hashed = _mixed(self._forms.astype(np.uint64) @ _ODD[:4])
        total = np.add.reduceat(_mixed(hashed + within.astype(np.uint64) * _ODD[4]), self.cuts[:-1])
        _, firsts, which = np.unique(total, return_index=True, return_inverse=True)
        labels = firsts[which]
        like = self.cuts[labels[self.piece]] + within
        same = (like < self.operations.count) & (self.lengths == self.lengths[labels])[self.piece]
        same &= (self._forms == self._forms[np.where(same, like, 0)]).all(axis=1)
        alone = np.unique(self.piece[~same])  # equal by hash alone
        labels[alone] = alone
        return labels

    @property
    def different(self) -> np.ndarray:
        """The first of each kind."""
        return np.unique(self.labels)

    @property
    def different_operations(self) -> int:
        return int(self.lengths[self.different].sum())

    def joined(self, longest: int) -> Pieces:
        """Pieces that almost always follow each other as one, up to so many operations."""
        labels, lengths = self.labels, self.lengths
        if self.count < 2:
            return self
        count = np.bincount(labels)
        _, which, pairs = np.unique(
            labels[:-1] * self.count + labels[1:], return_inverse=True, return_counts=True
        )
        first, second, pair = count[labels[:-1]], count[labels[1:]], pairs[which]
        always = pair >= TOGETHER * np.maximum(first, second)
        one_always = (pair >= TOGETHER * np.minimum(first, second)) & (pair >= OFTEN)
        linked = [False, *(always | one_always)]
        cuts, seen, size = list[int](), set[int](), 0
        for k, (label, length) in enumerate(zip(labels.tolist(), lengths.tolist(), strict=True)):
            if not linked[k] or label in seen:  # a period begins anew
                seen = set()
                size = longest
            if size + length > longest:
                cuts.append(int(self.cuts[k]))
                size = 0
            seen.add(label)
            size += length
        return Pieces(self.operations, np.array([*cuts, self.operations.count]))


def pieces(operations: Operations, longest: int) -> Pieces:
    """A body in pieces of at most about so many operations, cut alike where it is alike."""
    hashed = np.zeros(operations.count, dtype=np.uint64)
    for k in range(WINDOW):
        shifted = np.roll(operations.what, k).astype(np.uint64)
        hashed = _mixed(hashed + shifted * _ODD[k])
    wanted = np.flatnonzero(hashed % np.uint64(ONE_IN) == 0)
    cuts, last = [0], 0
    for cut in [*wanted.tolist(), operations.count]:
        while cut - last > MOST:
            last += MOST
            cuts.append(last)
        if cut - last >= LEAST or cut == operations.count > last:
            last = cut
            cuts.append(cut)
    return Pieces(operations, np.array(cuts)).joined(longest)


_ODD = np.array(
    [
        0x9E3779B97F4A7C15,
        0xC2B2AE3D27D4EB4F,
        0x165667B19E3779F9,
        0x27D4EB2F165667C5,
        0x85EBCA77C2B2AE63,
        0xD6E8FEB86659FD93,
    ],
    dtype=np.uint64,
)


def _mixed(numbers: np.ndarray) -> np.ndarray:
    """A hash of each number (Steele, Lea and Flood 2014)."""
    numbers = (numbers ^ (numbers >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    numbers = (numbers ^ (numbers >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return numbers ^ (numbers >> np.uint64(31))
