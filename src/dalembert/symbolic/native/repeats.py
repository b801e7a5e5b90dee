"""Repeated pieces of straight-line code, which differ only in the locations of their values.

Equal elements of a model yield equal sequences of operations. The body is cut where a hash of the
last few operations meets a condition (content-defined chunking, Muthitacharoen et al. 2001): equal
sequences are cut equally, independent of their position. Pieces that almost always follow each
other are merged.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.symbolic.native.operations import Operations

WINDOW = 6
"""Number of operations in the hash that decides on a cut."""
ONE_IN, MIN_LENGTH, MAX_LENGTH = 8, 20, 200
"""Average windows per cut, and limits of the operations of a piece before merging."""
TOGETHER = 0.9
"""Threshold for merging two pieces: share of their occurrences in sequence."""
OFTEN = 8
"""Occurrences in sequence above which the share of one of the two pieces suffices."""
OUTSIDE = 1 << 40
"""Offset of references to values from other pieces."""


@dataclass(frozen=True)
class Pieces:
    """A body cut into pieces.

    Attributes
    ----------
    operations : Operations
    cuts : first operations of the pieces, and the end
    """

    operations: Operations
    cuts: np.ndarray

    @classmethod
    def whole(cls, operations: Operations) -> Pieces:
        """The body as one piece."""
        return cls(operations, np.array([0, operations.count]))

    @property
    def count(self) -> int:
        return len(self.cuts) - 1

    @property
    def lengths(self) -> np.ndarray:
        return np.diff(self.cuts)

    @cached_property
    def piece(self) -> np.ndarray:
        """The piece of each operation."""
        return np.repeat(np.arange(self.count), self.lengths)

    @cached_property
    def stored(self) -> np.ndarray:
        """Whether a later piece reads the value of each operation."""
        return self.operations.last_use >= self.cuts[self.piece + 1]

    @cached_property
    def outside(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Operands from other pieces.

        Returns
        -------
        use : twice the index of the operation, plus one for its second operand
        number : number of the value in its piece, in the order of first uses
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
        """Each operation with its operands relative to its piece."""
        o, here = self.operations, np.arange(self.operations.count)
        operands = np.column_stack([o.first, o.second])
        inside = 1 + here[:, None] - np.column_stack(o.sources)
        forms = np.where(operands >= 0, inside, operands).ravel()
        use, number, _ = self.outside
        forms[use] = OUTSIDE + number
        return np.column_stack([o.operation, forms.reshape(-1, 2), self.stored])

    @cached_property
    def labels(self) -> np.ndarray:
        """A label for each piece, equal for equal pieces: the index of the first one."""
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
        collisions = np.unique(self.piece[~same])  # equal by hash only
        labels[collisions] = collisions
        return labels

    @property
    def distinct(self) -> np.ndarray:
        """The first piece of each label."""
        return np.unique(self.labels)

    @property
    def distinct_operations(self) -> int:
        return int(self.lengths[self.distinct].sum())

    def merged(self, longest: int) -> Pieces:
        """Pieces that almost always follow each other merged, up to ``longest`` operations."""
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
    """A body cut into pieces of about ``longest`` operations or less, equal parts equally."""
    hashed = np.zeros(operations.count, dtype=np.uint64)
    for k in range(WINDOW):
        shifted = np.roll(operations.operation, k).astype(np.uint64)
        hashed = _mixed(hashed + shifted * _ODD[k])
    candidates = np.flatnonzero((hashed % np.uint64(ONE_IN) == 0) & ~operations.tied)
    cuts, last = [0], 0
    for cut in [*candidates.tolist(), operations.count]:
        while cut - last > MAX_LENGTH:
            last += MAX_LENGTH
            while operations.tied[last]:
                last -= 1
            cuts.append(last)
        if cut - last >= MIN_LENGTH or cut == operations.count > last:
            last = cut
            cuts.append(cut)
    return Pieces(operations, np.array(cuts)).merged(longest)


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
