"""Straight bodies as arrays, so that millions of lines are compared at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.calls import BEGUN, Called, read_call
from dalembert.symbolic.native.lines import Line, parsed, slot_digits

NONE = -1
"""The place of an operand that is not there; constants among operands lie below."""
DIGIT = ord("0")


@dataclass
class Names:
    """Texts by number, in the order they are met."""

    numbers: dict[str, int] = field(default_factory=dict)

    def number(self, text: str) -> int:
        return self.numbers.setdefault(text, len(self.numbers))

    @property
    def texts(self) -> list[str]:
        return list(self.numbers)


@dataclass(frozen=True)
class Operations:
    """What is done, line by line; all arrays are as long.

    Attributes
    ----------
    lines : texts, without those that do nothing; of a call what is given, itself, what is taken
    calls : of other functions
    numbers : constants as text
    what : number of the kind of operation; inputs and outputs are kinds of their own each
    target : slot the value goes to, ``NONE`` for outputs
    first, second : slots, ``NONE``, or ``NONE - 1 - k`` for the k-th number
    element : of an input or output the entry, of a constant its number, else ``NONE``
    tied : whether it must stay with the one before, as parts of a call must
    """

    lines: Sequence[str | Line]
    calls: list[Called]
    numbers: list[str]
    what: np.ndarray
    target: np.ndarray
    first: np.ndarray
    second: np.ndarray
    element: np.ndarray
    tied: np.ndarray

    @classmethod
    def read(cls, function: CFunction) -> Operations:
        """The operations of a straight body."""
        calls, tied = list[Called](), list[int]()
        lines = list(_with_calls(function, calls, tied) if function.uses else _plain(function))
        texts = [line if isinstance(line, str) else "" for line in lines]
        kinds, numbers, n = Names(), Names(), len(lines)
        columns = np.full((5, n), NONE, dtype=np.int64)
        for k in np.flatnonzero(~_regular(texts, slot_digits(function), kinds, columns)):
            columns[:, k] = _row(as_line(lines[k]), kinds, numbers, calls)
        what, target, first, second, element = columns
        bound = np.isin(np.arange(n), tied)
        return cls(lines, calls, numbers.texts, what, target, first, second, element, bound)

    @property
    def count(self) -> int:
        return len(self.lines)

    @cached_property
    def sources(self) -> tuple[np.ndarray, np.ndarray]:
        """Which operation made the first and the second operand; ``NONE`` for none."""
        makers = np.flatnonzero(self.target >= 0)
        keys = self.target[makers] * self.count + makers
        order = np.argsort(keys)
        keys, makers = keys[order], makers[order]
        here = np.arange(self.count)

        def source(operand: np.ndarray) -> np.ndarray:
            last = np.searchsorted(keys, operand * self.count + here) - 1
            return np.where(operand >= 0, makers[last], NONE)

        return source(self.first), source(self.second)

    @cached_property
    def last_use(self) -> np.ndarray:
        """The last operation that reads the value of each; ``NONE`` where none does."""
        found = np.full(self.count, NONE)
        here = np.arange(self.count)
        for source in self.sources:
            read = source >= 0
            np.maximum.at(found, source[read], here[read])
        return found


def _row(line: Line, kinds: Names, numbers: Names, calls: list[Called]) -> tuple[int, ...]:
    """The columns of a line."""
    what, slot, given = line
    if what in ("output", "give"):  # what goes out is read
        element = int(given[1]) if what == "output" else NONE
        return kinds.number(f"{what} {given[0]}"), NONE, _place(slot, numbers), NONE, element
    if what == "call":
        return kinds.number(f"call {calls[int(given[0])].way}"), NONE, NONE, NONE, NONE
    if what in ("input", "take"):
        element = int(given[1]) if what == "input" else NONE
        return kinds.number(f"{what} {given[0]}"), int(slot[1:]), NONE, NONE, element
    if what == "constant":
        return kinds.number(what), int(slot[1:]), NONE, NONE, numbers.number(given[0])
    first, second = [*(_place(operand, numbers) for operand in given), NONE][:2]
    return kinds.number(f"{what}, {len(given)}"), int(slot[1:]), first, second, NONE


def as_line(line: str | Line) -> Line:
    """A line that does something, read."""
    found = parsed(line) if isinstance(line, str) else line
    assert found is not None
    return found


def _plain(function: CFunction) -> Iterator[str]:
    return (line for line in function.lines[1:-1] if line.startswith(("  a", "  if")))


def _with_calls(function: CFunction, calls: list[Called], tied: list[int]) -> Iterator[str | Line]:
    """Lines, with those of calls read; what is ``tied`` to the line before is noted by number."""
    lines, count = iter(function.lines[1:-1]), 0
    for line in lines:
        while line.startswith(BEGUN):
            call, line = read_call(line, lines)
            parts: list[Line] = [("give", operand, (str(p),)) for p, operand in call.given.items()]
            parts.append(("call", "", (str(len(calls)),)))
            parts += [("take", slot, (str(place),)) for place, slot in call.taken.items()]
            calls.append(call)
            tied += range(count + 1, count + len(parts))
            count += len(parts)
            yield from parts
        if line.startswith(("  a", "  if")):
            count += 1
            yield line


def _place(operand: str, numbers: Names) -> int:
    return int(operand[1:]) if operand[0] == "a" else NONE - 1 - numbers.number(operand)


def _regular(lines: list[str], digits: int, kinds: Names, columns: np.ndarray) -> np.ndarray:
    """Fill in the columns of all lines ``a1=(a2+a3);``, and tell which these are."""
    width = 3 * digits + 10
    found = np.array([len(line) == width and line[digits + 4] == "(" for line in lines], dtype=bool)
    where = np.flatnonzero(found)
    if not where.size:
        return found
    text = "".join([lines[k] for k in where]).encode("ascii")
    table = np.frombuffer(text, dtype=np.uint8).reshape(-1, width)
    begins = (3, digits + 6, 2 * digits + 8)
    good = (table[:, begins[1] - 1] == ord("a")) & (table[:, begins[2] - 1] == ord("a"))
    table, where = table[good], where[good]
    weights = 10 ** np.arange(digits)[::-1]
    slots = [(table[:, b : b + digits] - DIGIT).astype(np.int64) @ weights for b in begins]
    signs = table[:, 2 * digits + 6]
    for sign in np.unique(signs):
        columns[0, where[signs == sign]] = kinds.number(f"{chr(sign)}, 2")
    for row, values in zip((1, 2, 3), slots, strict=True):
        columns[row, where] = values
    found[:] = False
    found[where] = True
    return found
