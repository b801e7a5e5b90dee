"""Translation of straight-line code to LLVM IR, piece by piece.

Most of a text is straight-line code. Long bodies are compiled in pieces, so that the compile time
grows linearly with the length of the text. Pieces that are equal except for the locations of their
values are compiled once, so that neither the time nor the code grows with the number of equal
elements. The body is then a list of pieces and an index table with a row of locations for each
piece; locations that are equal in all rows are written into the code, and locations at a constant
distance share a column.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.operations import Operations, as_line, slot_count
from dalembert.symbolic.native.piece import PARAMETERS, Constants, Piece, Place
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.repeats import Pieces, pieces


@dataclass(frozen=True)
class Table:
    """Index table of all pieces.

    Attributes
    ----------
    places : label → locations in order of use
    widths : label → length of a row
    numbers : all rows in sequence
    """

    places: dict[int, list[Place]]
    widths: dict[int, int]
    numbers: np.ndarray

    @classmethod
    def of(cls, cut: Pieces) -> Table:
        """The table of a body cut into pieces."""
        owner, locations = _locations(cut)
        begins = np.searchsorted(owner, np.arange(cut.count + 1))
        labels, places, widths, columns = cut.labels, {}, {}, {}
        order = np.argsort(labels, kind="stable")
        bounds = np.flatnonzero(np.diff(labels[order], prepend=-1, append=cut.count))
        for begin, end in pairwise(bounds):
            members = order[begin:end]
            label = int(members[0])
            width = begins[label + 1] - begins[label]
            rows = locations[begins[members][:, None] + np.arange(width)]
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


def _locations(cut: Pieces) -> tuple[np.ndarray, np.ndarray]:
    """Pieces, and the locations used by them in this order.

    An operation uses operands from other pieces, then its element, then the slot of its value.
    """
    o = cut.operations
    use, _, new = cut.outside
    loads = use[new]
    slots = np.column_stack([o.first, o.second]).ravel()[loads]
    elements, stores = np.flatnonzero(o.element >= 0), np.flatnonzero(cut.stored)
    turns = [4 * (loads // 2) + loads % 2, 4 * elements + 2, 4 * stores + 3]
    values = [slots, o.element[elements], o.target[stores]]
    turn = np.concatenate(turns)
    order = np.argsort(turn)
    return cut.piece[turn[order] // 4], np.concatenate(values)[order]


def _shared(rows: np.ndarray) -> tuple[list[Place], np.ndarray]:
    """Places, and the columns of the table that they refer to."""
    differences = (rows - rows[0]).T
    _, which = np.unique(differences, axis=0, return_inverse=True)
    places: list[Place] = []
    column: dict[int, tuple[int, int]] = {}
    for k, group in enumerate(which.ravel().tolist()):
        here = int(rows[0, k])
        if not differences[k].any():
            places.append((None, here))
            continue
        if group not in column:
            column[group] = len(column), k
        number, origin = column[group]
        places.append((number, here - int(rows[0, origin])))
    return places, rows[:, [origin for _, origin in column.values()]]


PIECE = 1000
"""Upper limit of the operations of a piece."""


def split(function: CFunction, short: int) -> Pieces:
    """A body in pieces; with ``short`` operations or less in one."""
    operations = Operations.read(function)
    whole = operations.count <= short
    return Pieces.whole(operations) if whole else pieces(operations, PIECE)


def straight_line(
    function: CFunction, cut: Pieces, real: Real, uniform: Sequence[int] = ()
) -> list[str]:
    """IR of a straight-line function ``i32 (arg, res, iw, w, mem)``.

    ``uniform`` are the indices of arguments that are equal in all lanes.
    """
    operations, table, name = cut.operations, Table.of(cut), function.name
    room = slot_count(function)
    constants = Constants(f"{name}.numbers", operations.numbers)
    text = list[str]()
    for label in cut.distinct.tolist():
        begin, end = cut.cuts[label], cut.cuts[label + 1]
        lines = [as_line(operations.lines[k]) for k in range(begin, end)]
        piece = Piece(real, table.places[label], constants, operations.calls, room, uniform)
        stored = cut.stored[begin:end].tolist()
        text += piece.text(f"{name}.{label}", lines, stored, table.widths[label])
    driver = _driver(name, cut.count, bool(operations.calls))
    return [*text, *_arrays(name, cut, table, constants), *driver]


def longest_input(function: CFunction) -> int:
    """Length of the longest argument: one more than the largest index."""
    lines = "\n".join([line for line in function.lines if "? arg[" in line])
    return 1 + max(map(int, re.findall(r"\[(\d+)\] : 0;$", lines, re.MULTILINE)), default=0)


def _arrays(name: str, cut: Pieces, table: Table, constants: Constants) -> list[str]:
    """The sequence of pieces, the table of locations, and the constants."""
    bodies = ", ".join(f"ptr @{name}.{label}" for label in cut.distinct)
    order = np.searchsorted(cut.distinct, cut.labels)
    numbers = np.array([float(text) for text in constants.texts])
    return [
        f"@{name}.bodies = internal constant [{len(cut.distinct)} x ptr] [{bodies}]",
        _data(f"{name}.order", order.astype("<i4")),
        _data(f"{name}.table", table.numbers.astype("<i4")),
        _data(constants.name, numbers.astype("<f8")),
    ]


def _data(name: str, numbers: np.ndarray) -> str:
    content = numbers.tobytes()
    text = "\\" + content.hex("\\") if content else ""
    return f'@{name} = internal constant [{len(content)} x i8] c"{text}", align 8'


def _driver(name: str, count: int, may_fail: bool) -> list[str]:
    """The function that calls all pieces in sequence."""
    before = "on" if may_fail else "next"
    check = [
        "  %bad = icmp eq ptr %rest, null",
        "  br i1 %bad, label %failed, label %on",
        "failed:",
        "  ret i32 1",
        "on:",
    ]
    return [
        f"define internal i32 @{name}({PARAMETERS}, i32 %mem) nounwind {{",
        "  br label %next",
        "next:",
        f"  %k = phi i64 [0, %0], [%following, %{before}]",
        f"  %t = phi ptr [@{name}.table, %0], [%rest, %{before}]",
        f"  %place = getelementptr i32, ptr @{name}.order, i64 %k",
        "  %which = load i32, ptr %place",
        f"  %entry = getelementptr ptr, ptr @{name}.bodies, i32 %which",
        "  %body = load ptr, ptr %entry",
        f"  %rest = call ptr %body({PARAMETERS}, ptr %t)",
        *(check if may_fail else ()),
        "  %following = add i64 %k, 1",
        f"  %more = icmp ult i64 %following, {count}",
        "  br i1 %more, label %next, label %end",
        "end:",
        "  ret i32 0",
        "}",
    ]
