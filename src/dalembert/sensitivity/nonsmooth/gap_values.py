"""Gaps at a state, without derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.triplets import Sparse


@dataclass(frozen=True, eq=False)
class GapValues:
    """Gaps with their velocities before and after a step.

    Attributes
    ----------
    values : GapChanges
    directions : (n k, n_v) ``W``
    """

    values: GapChanges
    directions: Sparse

    @classmethod
    def joined(cls, parts: Sequence[tuple[np.ndarray, GapValues]]) -> GapValues:
        """Gaps of several parts, each with the rows of its gaps among all."""
        own = [part.values for _, part in parts]
        count = sum(rows.size for rows, _ in parts)
        values = GapChanges.zero(count, own[0].before.shape[1], own[0].laws.shape[1])
        for (rows, _), gaps in zip(parts, own, strict=True):
            values.add(rows, gaps)
        order = [rows for rows, _ in parts]
        return cls(values, joined_directions(order, [part.directions for _, part in parts]))

    def some(self, rows: np.ndarray) -> GapValues:
        """Some gaps."""
        width = self.values.before.shape[1]
        lines = (rows[:, None] * width + np.arange(width)).ravel()
        return GapValues(self.values.some(rows), self.directions[lines])

    def turning(self, change: np.ndarray) -> np.ndarray:
        """(n, k) changes ``2 b`` of the velocities at constant speeds, for the change (n_v,) of
        these between the velocities before and after."""
        by_speeds = (self.directions @ change).reshape(self.values.before.shape)
        return np.asarray(self.values.after - self.values.before - by_speeds)


def joined_directions(rows: list[np.ndarray], directions: list[Sparse]) -> Sparse:
    """``W`` of gaps from those of parts, with the rows of their gaps among all."""
    order, stacked = np.argsort(np.concatenate(rows)), directions[0]
    if len(directions) > 1:
        stacked = scipy.sparse.vstack(directions)
    across = scipy.sparse.csr_array(stacked)
    if (np.diff(order) != 1).any():
        width = across.shape[0] // order.size
        across = across[(order[:, None] * width + np.arange(width)).ravel()]
    across.sort_indices()
    return across


def directions_of(
    kinds: Sequence[tuple[GapKind, np.ndarray]], rows: int, moving: Sparse, zeros: bool = False
) -> Sparse:
    """``W`` (rows, n_v) of gaps, ``B J``.

    Parameters
    ----------
    kinds : gaps of one kind, with their ``B`` (n, k, w)
    moving : ``J``
    zeros : whether zeros are stored for all speeds of the shapes of a gap
    """
    parts, moves = [], np.diff(moving.indptr) > 0
    for kind, blocks in kinds:
        width = blocks.shape[1]
        row = kind.row[:, None, None] * width + np.arange(width)[:, None]
        place = np.broadcast_to(kind.velocities[:, None], blocks.shape)
        used = moves[place] if zeros else blocks != 0
        parts.append((blocks[used], np.broadcast_to(row, blocks.shape)[used], place[used]))
    if not parts:
        return scipy.sparse.csr_array((rows, moving.shape[1]))
    values, row, column = (np.concatenate(entries) for entries in zip(*parts, strict=True))
    shape = rows, moving.shape[0]
    return scipy.sparse.csr_array((values, (row, column)), shape=shape) @ moving
