"""Function calls in straight-line code, for graphs that call functions.

The called function is scalar and called for one lane after the other, as its control flow may
depend on the data.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.toolchain import NotTranslated

SET = re.compile(r"  (arg|res)\[(\d+)\]=(?:w\+(\d+)|0);$")
PUT = re.compile(r"  w\[(\d+)\] = (a\d+|-?\d+\.\d*(?:e[+-]?\d+)?);$")
CALL = re.compile(r"  if \((\w+)\(arg\+(\d+), res\+(\d+), iw, w\+(\d+), 0\)\) return 1;$")
TAKE = re.compile(r"  (a\d+) = w\[(\d+)\];$")
CALL_STARTS = ("  arg[", "  res[", "  w[")
"""Prefixes of the lines of a call."""
SCALAR_SUFFIX = "_lone"
"""Suffix of the names of scalar functions in a module of lanes."""


@dataclass
class FunctionCall:
    """A call with its operands and results.

    Attributes
    ----------
    name : of the function
    arg, res, w : offsets of its arguments, results and work
    operands : index in the work vector → operand
    results : index in the work vector → slot
    pointers : ``("arg", 3)`` → index of the target in the work vector; None for a null pointer
    """

    name: str = ""
    arg: int = 0
    res: int = 0
    w: int = 0
    operands: dict[int, str] = field(default_factory=dict)
    results: dict[int, str] = field(default_factory=dict)
    pointers: dict[tuple[str, int], int | None] = field(default_factory=dict)

    @property
    def signature(self) -> str:
        """Common label of calls that differ in slots only."""
        return f"{self.name} {self.arg} {self.res} {self.w} {self.pointers} {[*self.results]}"


def read_call(line: str, lines: Iterator[str]) -> tuple[FunctionCall, str]:
    """The call that begins with a line, and the line after it.

    Raises
    ------
    NotTranslated
        The text has another form.
    """
    call = FunctionCall()
    while match := SET.match(line) or PUT.match(line):
        if match.re is SET:
            call.pointers[match[1], int(match[2])] = int(match[3]) if match[3] else None
        else:
            call.operands[int(match[1])] = match[2]
        line = next(lines)
    head = CALL.match(line)
    if head is None:
        raise NotTranslated(f"unknown form of a call: {line.strip()!r}")
    call.name, call.arg, call.res, call.w = head[1], int(head[2]), int(head[3]), int(head[4])
    line = next(lines)
    while match := TAKE.match(line):
        call.results[int(match[2])] = match[1]
        line = next(lines)
    return call, line


def called_functions(lines: list[str]) -> list[tuple[str, int]]:
    """Names of the functions called by straight-line code, and the offsets of their work."""
    matches = (CALL.match(line) for line in lines if line.startswith("  if (casadi_"))
    return [(call[1], int(call[4])) for call in matches if call]


def call_instructions(
    call: FunctionCall,
    real: Real,
    room: int,
    values: dict[int, str],
    new: Callable[[str], str],
    write: Callable[[str], None],
) -> dict[int, str]:
    """Write the IR of a call, which jumps to the label ``failed`` if the function fails.

    Parameters
    ----------
    room : slots of the work vector used by the caller
    values : index in the work vector → value of the operand
    new : writes an instruction and returns the name of its value
    write : writes a line

    Returns
    -------
    dict
        Index in the work vector → value of the result.
    """
    own = new(f"getelementptr {real.ir}, ptr %w, i64 {room}")
    work = new(f"getelementptr double, ptr {own}, i64 {call.w}")
    for (array, index), place in call.pointers.items():
        address = new(f"getelementptr ptr, ptr %{array}, i64 {index}")
        target = "null" if place is None else new(f"getelementptr double, ptr {own}, i64 {place}")
        write(f"  store ptr {target}, ptr {address}")
    arg, res = (
        new(f"getelementptr ptr, ptr %{array}, i64 {offset}")
        for array, offset in (("arg", call.arg), ("res", call.res))
    )
    results = dict.fromkeys(call.results, "undef")
    name = f"{call.name}{SCALAR_SUFFIX if real.lanes > 1 else ''}"
    for lane in range(real.lanes):
        for place, value in values.items():
            number = value
            if real.lanes > 1:
                number = new(f"extractelement {real.ir} {value}, i32 {lane}")
            address = new(f"getelementptr double, ptr {own}, i64 {place}")
            write(f"  store double {number}, ptr {address}, align 8")
        status = new(f"call i32 @{name}(ptr {arg}, ptr {res}, ptr %iw, ptr {work}, i32 0)")
        bad, after = new(f"icmp ne i32 {status}, 0"), f"on{status[2:]}"
        write(f"  br i1 {bad}, label %failed, label %{after}")
        write(f"{after}:")
        for place in call.results:
            value = new(f"getelementptr double, ptr {own}, i64 {place}")
            value = new(f"load double, ptr {value}, align 8")
            if real.lanes > 1:
                value = new(f"insertelement {real.ir} {results[place]}, double {value}, i32 {lane}")
            results[place] = value
    return results
