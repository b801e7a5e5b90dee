"""Where pieces of a straight body find their numbers.

Pieces that are equal share their code; each has a row of places. What is alike in all of them is
written into the code, and places that keep their distance are told by one number.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dalembert.symbolic.native.piece import Place
from dalembert.symbolic.native.repeats import Pieces


@dataclass(frozen=True)
class Table:
    """Places of all pieces.

    Attributes
    ----------
    places : label → places in the order in which the code asks for them
    widths : label → length of a row
    numbers : all rows, one after the other
    """

    places: dict[int, list[Place]]
    widths: dict[int, int]
    numbers: np.ndarray

    @classmethod
    def of(cls, cut: Pieces) -> Table:
        """The table of a body cut into pieces."""
        owner, wanted = _wanted(cut)
        begins = np.searchsorted(owner, np.arange(cut.count + 1))
        labels, places, widths, columns = cut.labels, {}, {}, {}
        order = np.argsort(labels, kind="stable")
        bounds = np.flatnonzero(np.diff(labels[order], prepend=-1, append=cut.count))
        for begin, end in pairwise(bounds):
            members = order[begin:end]
            label = int(members[0])
            width = begins[label + 1] - begins[label]
            rows = wanted[begins[members][:, None] + np.arange(width)]
            places[label], columns[label] = _shared(rows)
            widths[label] = columns[label].shape[1]
        width = np.zeros(cut.count, dtype=np.int64)
        width[list(widths)] = list(widths.values())
        first = np.concatenate([[0], np.cumsum(width[labels])])
        numbers = np.zeros(first[-1], dtype=np.int64)
        for label, rows in columns.items():
            members = np.flatnonzero(labels == label)
            numbers[first[members][:, None] + np.arange(rows.shape[1])] = rows
        return cls(places, widths, numbers)


def _wanted(cut: Pieces) -> tuple[np.ndarray, np.ndarray]:
    """The pieces and the places that they ask for, in this order.

    A line asks for operands made elsewhere, then for its own element, then where its value goes.
    """
    o = cut.operations
    use, _, new = cut.outside
    loads = use[new]
    slots = np.column_stack([o.first, o.second]).ravel()[loads]
    elements, stores = np.flatnonzero(o.element >= 0), np.flatnonzero(cut.kept)
    turns = [4 * (loads // 2) + loads % 2, 4 * elements + 2, 4 * stores + 3]
    values = [slots, o.element[elements], o.target[stores]]
    turn = np.concatenate(turns)
    order = np.argsort(turn)
    return cut.piece[turn[order] // 4], np.concatenate(values)[order]


def _shared(rows: np.ndarray) -> tuple[list[Place], np.ndarray]:
    """Places, and the columns of a table that they refer to."""
    moved = (rows - rows[0]).T
    _, which = np.unique(moved, axis=0, return_inverse=True)
    places: list[Place] = []
    column: dict[int, tuple[int, int]] = {}
    for k, group in enumerate(which.ravel().tolist()):
        here = int(rows[0, k])
        if not moved[k].any():
            places.append((None, here))
            continue
        if group not in column:
            column[group] = len(column), k
        number, origin = column[group]
        places.append((number, here - int(rows[0, origin])))
    return places, rows[:, [origin for _, origin in column.values()]]
