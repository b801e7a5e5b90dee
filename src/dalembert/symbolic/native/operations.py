"""Straight-line code, ``a3=(a1*a2);`` line by line, as arrays of operations."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.calls import CALL_STARTS, FunctionCall, read_call
from dalembert.symbolic.native.toolchain import NotTranslated

OPERAND = r"(a\d+|-?\d+\.\d*(?:e[+-]?\d+)?)"
BINARY = re.compile(rf"\({OPERAND}(==|!=|<=|<|&&|\|\||[-+*/]){OPERAND}\)$")
INPUT = re.compile(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0$")
UNARY = re.compile(rf"\(([-!]){OPERAND}\)$")
SELECTION = re.compile(rf"\({OPERAND}\?{OPERAND}:0\)$")
CALL = re.compile(rf"(\w+)\({OPERAND}(?:,{OPERAND})?\)$")
OUTPUT = re.compile(r"  if \(res\[(\d+)\]!=0\) res\[\1\]\[(\d+)\]=(a\d+);$")
CONSTANTS = {"casadi_inf": "inf", "-casadi_inf": "-inf", "casadi_nan": "nan"}

Line = tuple[str, str, tuple[str, ...]]
"""Operation, target slot, and operands: slots and constants."""


def parse_line(line: str) -> Line | None:
    """A line of a body; None for a line without an operation."""
    if line.startswith("  a"):
        target, _, right = line[2:-1].partition("=")
        return _assignment(target, right)
    if match := OUTPUT.match(line):
        return "output", match[3], (match[1], match[2])
    if line.startswith(("  casadi_real", "  return")):
        return None
    raise unknown(line)


def slot_count(function: CFunction) -> int:
    """Number of slots: one more than the largest index."""
    return 1 + max((int(line[-1]) for line in _slots(function)), default=-1)


def slot_digits(function: CFunction) -> int:
    """Number of digits of the slots, equal for all."""
    return max((len(line[-1]) for line in _slots(function)), default=0)


def _slots(function: CFunction) -> Iterator[list[str]]:
    head = itertools.takewhile(lambda line: line.startswith("  casadi_real"), function.lines[1:])
    return (re.findall(r"a(\d+)", line) for line in head)


def _assignment(target: str, right: str) -> Line:
    if match := BINARY.match(right):
        first, operation, second = match.groups()
        return operation, target, (first, second)
    if match := INPUT.match(right):
        return "input", target, (match[1], match[2])
    if match := UNARY.match(right):
        return f"{match[1]}.", target, (match[2],)
    if match := SELECTION.match(right):
        return "?", target, (match[1], match[2])
    if match := CALL.match(right):
        return match[1], target, tuple(operand for operand in match.groups()[1:] if operand)
    number = CONSTANTS.get(right, right)
    try:
        float(number)
    except ValueError:
        raise unknown(f"{target}={right}") from None
    return "constant", target, (number,)


def unknown(line: str) -> NotTranslated:
    """The error for a line of unknown form."""
    return NotTranslated(f"unknown form of a line: {line.strip()!r}")


NONE = -1
"""Index of a missing operand; indices below denote constants."""
DIGIT = ord("0")


@dataclass
class Numbering:
    """Consecutive numbers of texts, in order of first appearance."""

    numbers: dict[str, int] = field(default_factory=dict)

    def number(self, text: str) -> int:
        return self.numbers.setdefault(text, len(self.numbers))

    @property
    def texts(self) -> list[str]:
        return list(self.numbers)


@dataclass(frozen=True)
class Operations:
    """Operations of straight-line code; all arrays have one entry per operation.

    Attributes
    ----------
    lines : texts with an operation; a call has one line per operand, for itself, and per result
    calls : of other functions
    numbers : constants as text
    operation : number of the kind of operation; each input and output is a kind of its own
    target : slot of the value, ``NONE`` for outputs
    first, second : slots, ``NONE``, or ``NONE - 1 - k`` for the k-th number
    element : entry of an input or output, number of a constant, else ``NONE``
    tied : whether it must not be separated from the previous operation, as parts of a call
    """

    lines: Sequence[str | Line]
    calls: list[FunctionCall]
    numbers: list[str]
    operation: np.ndarray
    target: np.ndarray
    first: np.ndarray
    second: np.ndarray
    element: np.ndarray
    tied: np.ndarray

    @classmethod
    def read(cls, function: CFunction) -> Operations:
        """The operations of a straight-line function."""
        calls, tied = list[FunctionCall](), list[int]()
        lines = list(_with_calls(function, calls, tied) if function.uses else _plain(function))
        texts = [line if isinstance(line, str) else "" for line in lines]
        kinds, numbers, n = Numbering(), Numbering(), len(lines)
        columns = np.full((5, n), NONE, dtype=np.int64)
        for k in np.flatnonzero(~_regular(texts, slot_digits(function), kinds, columns)):
            columns[:, k] = _row(as_line(lines[k]), kinds, numbers, calls)
        operation, target, first, second, element = columns
        mask = np.isin(np.arange(n), tied)
        return cls(lines, calls, numbers.texts, operation, target, first, second, element, mask)

    @property
    def count(self) -> int:
        return len(self.lines)

    @cached_property
    def sources(self) -> tuple[np.ndarray, np.ndarray]:
        """Operations that define the first and the second operand; ``NONE`` for none."""
        definitions = np.flatnonzero(self.target >= 0)
        keys = self.target[definitions] * self.count + definitions
        order = np.argsort(keys)
        keys, definitions = keys[order], definitions[order]
        here = np.arange(self.count)

        def source(operand: np.ndarray) -> np.ndarray:
            last = np.searchsorted(keys, operand * self.count + here) - 1
            return np.where(operand >= 0, definitions[last], NONE)

        return source(self.first), source(self.second)

    @cached_property
    def last_use(self) -> np.ndarray:
        """The last operation that reads each value; ``NONE`` if there is none."""
        last = np.full(self.count, NONE)
        here = np.arange(self.count)
        for source in self.sources:
            read = source >= 0
            np.maximum.at(last, source[read], here[read])
        return last


def _row(
    line: Line, kinds: Numbering, numbers: Numbering, calls: list[FunctionCall]
) -> tuple[int, ...]:
    """The columns of a line."""
    operation, slot, operands = line
    if operation in ("output", "give"):  # an output reads its slot
        element = int(operands[1]) if operation == "output" else NONE
        kind = kinds.number(f"{operation} {operands[0]}")
        return kind, NONE, _operand(slot, numbers), NONE, element
    if operation == "call":
        signature = calls[int(operands[0])].signature
        return kinds.number(f"call {signature}"), NONE, NONE, NONE, NONE
    if operation in ("input", "take"):
        element = int(operands[1]) if operation == "input" else NONE
        return kinds.number(f"{operation} {operands[0]}"), int(slot[1:]), NONE, NONE, element
    if operation == "constant":
        return kinds.number(operation), int(slot[1:]), NONE, NONE, numbers.number(operands[0])
    first, second = [*(_operand(operand, numbers) for operand in operands), NONE][:2]
    return kinds.number(f"{operation}, {len(operands)}"), int(slot[1:]), first, second, NONE


def as_line(line: str | Line) -> Line:
    """A parsed line with an operation."""
    parsed = parse_line(line) if isinstance(line, str) else line
    assert parsed is not None
    return parsed


def _plain(function: CFunction) -> Iterator[str]:
    return (line for line in function.lines[1:-1] if line.startswith(("  a", "  if")))


def _with_calls(
    function: CFunction, calls: list[FunctionCall], tied: list[int]
) -> Iterator[str | Line]:
    """Lines, with calls parsed; indices of lines tied to the previous one are added to ``tied``."""
    lines, count = iter(function.lines[1:-1]), 0
    for line in lines:
        while line.startswith(CALL_STARTS):
            call, line = read_call(line, lines)
            parts: list[Line] = [("give", slot, (str(p),)) for p, slot in call.operands.items()]
            parts.append(("call", "", (str(len(calls)),)))
            parts += [("take", slot, (str(p),)) for p, slot in call.results.items()]
            calls.append(call)
            tied += range(count + 1, count + len(parts))
            count += len(parts)
            yield from parts
        if line.startswith(("  a", "  if")):
            count += 1
            yield line


def _operand(operand: str, numbers: Numbering) -> int:
    return int(operand[1:]) if operand[0] == "a" else NONE - 1 - numbers.number(operand)


def _regular(lines: list[str], digits: int, kinds: Numbering, columns: np.ndarray) -> np.ndarray:
    """Fill in the columns of all lines ``a1=(a2+a3);``; the mask of these lines."""
    width = 3 * digits + 10
    mask = np.array([len(line) == width and line[digits + 4] == "(" for line in lines], dtype=bool)
    where = np.flatnonzero(mask)
    if not where.size:
        return mask
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
    mask[:] = False
    mask[where] = True
    return mask
