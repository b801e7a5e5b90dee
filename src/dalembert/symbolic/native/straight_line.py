"""Straight bodies, ``a3=(a1*a2);`` line by line, as LLVM IR.

Most of a text is such lines. Long bodies are compiled piece by piece, so that the time to compile
grows with the length of the text and no faster; pieces that are equal but for the places of their
numbers are compiled once, so that neither the time nor the code grows with the number of equal
elements. A list of the pieces and a table of places are then what remains of the body.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.lines import slot_count
from dalembert.symbolic.native.operations import Operations, as_line
from dalembert.symbolic.native.piece import GIVEN, Constants, Piece
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.repeats import Pieces, pieces
from dalembert.symbolic.native.table import Table

PIECE = 1000
"""Operations that are compiled together."""


def cut_up(function: CFunction, short: int) -> Pieces:
    """A body in the pieces that it is compiled in; one of so few operations in one."""
    operations = Operations.read(function)
    whole = operations.count <= short
    return Pieces.whole(operations) if whole else pieces(operations, PIECE)


def straight_line(
    function: CFunction, cut: Pieces, real: Real, alike: Sequence[int] = ()
) -> list[str]:
    """IR of a function ``i32 (arg, res, iw, w, mem)`` with such a body.

    ``alike`` are the arguments that are the same in all lanes.
    """
    operations, table, name = cut.operations, Table.of(cut), function.name
    room = slot_count(function)
    constants = Constants(f"{name}.numbers", operations.numbers)
    text = list[str]()
    for label in cut.different.tolist():
        begin, end = cut.cuts[label], cut.cuts[label + 1]
        lines = [as_line(operations.lines[k]) for k in range(begin, end)]
        piece = Piece(real, table.places[label], constants, operations.calls, room, alike)
        kept = cut.kept[begin:end].tolist()
        text += piece.text(f"{name}.{label}", lines, kept, table.widths[label])
    driver = _driver(name, cut.count, bool(operations.calls))
    return [*text, *_arrays(name, cut, table, constants), *driver]


def longest_input(function: CFunction) -> int:
    """One more than the largest index into an argument."""
    lines = "\n".join([line for line in function.lines if "? arg[" in line])
    return 1 + max(map(int, re.findall(r"\[(\d+)\] : 0;$", lines, re.MULTILINE)), default=0)


def _arrays(name: str, cut: Pieces, table: Table, constants: Constants) -> list[str]:
    """The pieces in their order, the table of places, and the constants."""
    bodies = ", ".join(f"ptr @{name}.{label}" for label in cut.different)
    order = np.searchsorted(cut.different, cut.labels)
    numbers = np.array([float(text) for text in constants.texts])
    return [
        f"@{name}.bodies = internal constant [{len(cut.different)} x ptr] [{bodies}]",
        _data(f"{name}.order", order.astype("<i4")),
        _data(f"{name}.table", table.numbers.astype("<i4")),
        _data(constants.name, numbers.astype("<f8")),
    ]


def _data(name: str, numbers: np.ndarray) -> str:
    content = numbers.tobytes()
    text = "\\" + content.hex("\\") if content else ""
    return f'@{name} = internal constant [{len(content)} x i8] c"{text}", align 8'


def _driver(name: str, count: int, may_fail: bool) -> list[str]:
    """The function that calls piece after piece."""
    before = "on" if may_fail else "next"
    check = [
        "  %bad = icmp eq ptr %rest, null",
        "  br i1 %bad, label %failed, label %on",
        "failed:",
        "  ret i32 1",
        "on:",
    ]
    return [
        f"define internal i32 @{name}({GIVEN}, i32 %mem) nounwind {{",
        "  br label %next",
        "next:",
        f"  %k = phi i64 [0, %0], [%following, %{before}]",
        f"  %t = phi ptr [@{name}.table, %0], [%rest, %{before}]",
        f"  %place = getelementptr i32, ptr @{name}.order, i64 %k",
        "  %which = load i32, ptr %place",
        f"  %entry = getelementptr ptr, ptr @{name}.bodies, i32 %which",
        "  %body = load ptr, ptr %entry",
        f"  %rest = call ptr %body({GIVEN}, ptr %t)",
        *(check if may_fail else ()),
        "  %following = add i64 %k, 1",
        f"  %more = icmp ult i64 %following, {count}",
        "  br i1 %more, label %next, label %end",
        "end:",
        "  ret i32 0",
        "}",
    ]
