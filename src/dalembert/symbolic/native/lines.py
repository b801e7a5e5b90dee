"""Lines of straight bodies, ``a3=(a1*a2);``, read one by one."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator

from dalembert.symbolic.native.c_text import CFunction
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
"""What is done, the slot it goes to, and slots and constants it is done with."""


def parsed(line: str) -> Line | None:
    """A line of a body; None for one that does nothing."""
    if line.startswith("  a"):
        target, _, right = line[2:-1].partition("=")
        return _assignment(target, right)
    if found := OUTPUT.match(line):
        return "output", found[3], (found[1], found[2])
    if line.startswith(("  casadi_real", "  return")):
        return None
    raise unknown(line)


def slot_count(function: CFunction) -> int:
    """One more than the largest slot."""
    return 1 + max((int(line[-1]) for line in _slots(function)), default=-1)


def slot_digits(function: CFunction) -> int:
    """Digits of all slots, which are as long."""
    return max((len(line[-1]) for line in _slots(function)), default=0)


def _slots(function: CFunction) -> Iterator[list[str]]:
    head = itertools.takewhile(lambda line: line.startswith("  casadi_real"), function.lines[1:])
    return (re.findall(r"a(\d+)", line) for line in head)


def _assignment(target: str, right: str) -> Line:
    if found := BINARY.match(right):
        left, what, other = found.groups()
        return what, target, (left, other)
    if found := INPUT.match(right):
        return "input", target, (found[1], found[2])
    if found := UNARY.match(right):
        return f"{found[1]}.", target, (found[2],)
    if found := SELECTION.match(right):
        return "?", target, (found[1], found[2])
    if found := CALL.match(right):
        return found[1], target, tuple(given for given in found.groups()[1:] if given)
    number = CONSTANTS.get(right, right)
    try:
        float(number)
    except ValueError:
        raise unknown(f"{target}={right}") from None
    return "constant", target, (number,)


def unknown(line: str) -> NotTranslated:
    """What is raised for a line that nobody has seen."""
    return NotTranslated(f"{line.strip()!r} is nothing that it knows")
