"""Straight-line bodies, ``a3=(a1*a2);`` line by line, as LLVM IR.

Most of a text is such lines. Values stay in registers within a piece of so many operations and
pass from piece to piece through the work vector, so that the time to compile grows with the length
of the text and no faster. Every operation is rounded as written: nothing is fused or reordered.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator

from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.calls import Called, read_call, written_call
from dalembert.symbolic.native.real import TURNING, Real
from dalembert.symbolic.native.toolchain import NotTranslated

PIECE, SHORT = 1000, 6000
"""Operations that are compiled together; of functions as short as this all."""
ZEROS = "zeros"
"""The array that stands for arguments that are not given."""
OPERAND = r"(a\d+|-?\d+\.\d*(?:e[+-]?\d+)?)"
BINARY = re.compile(rf"\({OPERAND}(==|!=|<=|<|&&|\|\||[-+*/]){OPERAND}\)$")
INPUT = re.compile(r"arg\[(\d+)\]\? arg\[\1\]\[(\d+)\] : 0$")
UNARY = re.compile(rf"\(([-!]){OPERAND}\)$")
SELECTION = re.compile(rf"\({OPERAND}\?{OPERAND}:0\)$")
CALL = re.compile(rf"(\w+)\({OPERAND}(?:,{OPERAND})?\)$")
OUTPUT = re.compile(r"  if \(res\[(\d+)\]!=0\) res\[\1\]\[(\d+)\]=(a\d+);$")
CONSTANTS = {"casadi_inf": "inf", "-casadi_inf": "-inf", "casadi_nan": "nan"}
ARITHMETIC = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
COMPARISONS = {"==": "oeq", "!=": "une", "<=": "ole", "<": "olt"}
JUNCTIONS = {"&&": "and", "||": "or"}

BEGUN = ("  arg[", "  res[", "  w[")
"""How the lines of a call begin."""
FAILED = ["failed:", "  ret i32 1"]
Line = tuple[str, str, tuple[str, ...]]
"""What is done, the slot it goes to, and slots and constants it is done with."""
Lines = list[Line | Called]


def straight_line(function: CFunction, real: Real) -> list[str]:
    """IR of a function ``i32 (arg, res, iw, w, mem)`` with such a body."""
    lines: Lines = list(_parsed(function))
    room = slot_count(function)
    size = PIECE if len(lines) > SHORT else SHORT
    pieces = [lines[k : k + size] for k in range(0, len(lines), size)]
    alive, text, calls = _alive(pieces), list[str](), list[str]()
    for k, piece in enumerate(pieces):
        name = f"{function.name}.{k}"
        text += _Piece(real, room).text(name, piece, alive[k + 1])
        calls.append(f"  %e{k} = call i32 @{name}(ptr %arg, ptr %res, ptr %iw, ptr %w)")
        if any(isinstance(line, Called) for line in piece):
            calls.append(f"  %b{k} = icmp ne i32 %e{k}, 0")
            calls += [f"  br i1 %b{k}, label %failed, label %on{k}", f"on{k}:"]
    head = f"define internal i32 @{function.name}(ptr %arg, ptr %res, ptr %iw, ptr %w, i32 %mem)"
    return [*text, f"{head} nounwind {{", *calls, "  ret i32 0", *FAILED, "}"]


def longest_input(function: CFunction) -> int:
    """One more than the largest index into an argument."""
    found = (re.findall(r"\? arg\[\d+\]\[(\d+)\] : 0;$", line) for line in function.lines)
    return 1 + max((int(index) for line in found for index in line), default=0)


def slot_count(function: CFunction) -> int:
    """One more than the largest slot."""
    head = itertools.takewhile(lambda line: line.startswith("  casadi_real"), function.lines[1:])
    last = [re.findall(r"a(\d+)", line)[-1] for line in head]
    return 1 + max(map(int, last), default=-1)


def _parsed(function: CFunction) -> Iterator[Line | Called]:
    lines = iter(function.lines[1:-1])
    for line in lines:
        while line.startswith(BEGUN):
            call, line = read_call(line, lines)
            yield call
        if line.startswith("  a"):
            target, _, right = line[2:-1].partition("=")
            yield _assignment(target, right)
        elif found := OUTPUT.match(line):
            yield "output", found[3], (found[1], found[2])
        elif not line.startswith(("  casadi_real", "  return")):
            raise _unknown(line)


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
        raise _unknown(f"{target}={right}") from None
    return "constant", target, (number,)


def _unknown(line: str) -> NotTranslated:
    return NotTranslated(f"{line.strip()!r} is nothing that it knows")


def _reads(line: Line | Called) -> tuple[str, ...]:
    if isinstance(line, Called):
        return line.reads
    what, target, given = line
    return (target,) if what == "output" else given


def _writes(line: Line | Called) -> tuple[str, ...]:
    if isinstance(line, Called):
        return line.writes
    return () if line[0] == "output" else (line[1],)


def _alive(pieces: list[Lines]) -> list[set[str]]:
    """Slots whose values are read in a piece, or after it, before they are written anew."""
    alive: list[set[str]] = [set() for _ in range(len(pieces) + 1)]
    for k in reversed(range(len(pieces))):
        seen = set(alive[k + 1])
        for line in reversed(pieces[k]):
            seen.difference_update(_writes(line))
            seen.update(given for given in _reads(line) if given[0] == "a")
        alive[k] = seen
    return alive


class _Piece:
    """A piece of a body as a function of its own."""

    def __init__(self, real: Real, room: int):
        self.real, self.room, self.count = real, room, 0
        self.lines: list[str] = []
        self.first: list[str] = []
        self.values: dict[str, str] = {}
        self.flags: dict[str, str] = {}
        self.turned: dict[str, str] = {}
        self.arguments: dict[str, str] = {}
        self.outputs: dict[str, list[tuple[str, str]]] = {}
        self.written: set[str] = set()

    def text(self, name: str, lines: Lines, alive: set[str]) -> list[str]:
        for line in lines:
            if isinstance(line, Called):
                self.call(line)
                continue
            what, target, given = line
            if what == "output":
                index, element = given
                self.outputs.setdefault(index, []).append((element, self.value(target)))
            else:
                self.values[target] = self.assigned(what, given)
                self.written.add(target)
        own = "ptr %arg, ptr %res, ptr %iw, ptr %w"
        head = f"define internal i32 @{name}({own}) noinline nounwind {{"
        end = ["  ret i32 0", *FAILED, "}"]
        return [head, *self.first, *self.lines, *self.last(alive), *end]

    def call(self, call: Called) -> None:
        """A call; its part of the work vector is behind the slots."""
        given = {place: self.value(operand) for place, operand in call.given.items()}
        write = self.lines.append
        made = written_call(call, self.real, self.room, given, self.new, write)
        for place, slot in call.taken.items():
            self.values[slot] = made[place]
            self.written.add(slot)

    def last(self, alive: set[str]) -> list[str]:
        """Store the outputs that are wanted, and what later pieces need."""
        made, ir = list[str](), self.real.ir
        for slot in sorted(alive & self.written):
            place = f"%s{slot}"
            made.append(f"  {place} = getelementptr {ir}, ptr %w, i64 {int(slot[1:])}")
            made.append(f"  store {ir} {self.values[slot]}, ptr {place}, align 8")
        for index, stores in self.outputs.items():
            made.append(f"  %rp{index} = getelementptr ptr, ptr %res, i64 {index}")
            made.append(f"  %r{index} = load ptr, ptr %rp{index}")
            made.append(f"  %rn{index} = icmp eq ptr %r{index}, null")
            made.append(f"  br i1 %rn{index}, label %after{index}, label %store{index}")
            made.append(f"store{index}:")
            for element, value in stores:
                place = f"%r{index}.{element}"
                made.append(f"  {place} = getelementptr {ir}, ptr %r{index}, i64 {element}")
                made.append(f"  store {ir} {value}, ptr {place}, align 8")
            made += [f"  br label %after{index}", f"after{index}:"]
        return made

    def new(self, right: str) -> str:
        """A new value."""
        self.count += 1
        self.lines.append(f"  %v{self.count} = {right}")
        return f"%v{self.count}"

    def value(self, operand: str) -> str:
        """The value of a slot, from the work vector where an earlier piece made it."""
        if operand[0] != "a":
            return self.real.constant(operand)
        if operand not in self.values:
            ir = self.real.ir
            self.first.append(f"  %p{operand} = getelementptr {ir}, ptr %w, i64 {int(operand[1:])}")
            self.first.append(f"  %{operand} = load {ir}, ptr %p{operand}, align 8")
            self.values[operand] = f"%{operand}"
        return self.values[operand]

    def argument(self, index: str) -> str:
        """The array of an argument, or one of zeros."""
        if index not in self.arguments:
            self.first.append(f"  %gp{index} = getelementptr ptr, ptr %arg, i64 {index}")
            self.first.append(f"  %gl{index} = load ptr, ptr %gp{index}")
            self.first.append(f"  %gn{index} = icmp eq ptr %gl{index}, null")
            self.first.append(f"  %g{index} = select i1 %gn{index}, ptr @{ZEROS}, ptr %gl{index}")
            self.arguments[index] = f"%g{index}"
        return self.arguments[index]

    def assigned(self, what: str, given: tuple[str, ...]) -> str:
        """The value of an assignment."""
        ir = self.real.ir
        if what == "input":
            place = self.new(f"getelementptr {ir}, ptr {self.argument(given[0])}, i64 {given[1]}")
            return self.new(f"load {ir}, ptr {place}, align 8")
        if what == "constant":
            return self.real.constant(given[0])
        values = [self.value(operand) for operand in given]
        if what in ARITHMETIC:
            return self.new(f"{ARITHMETIC[what]} {ir} {values[0]}, {values[1]}")
        if what == "-.":
            return self.new(f"fneg {ir} {values[0]}")
        if what == "casadi_sq":
            return self.new(f"fmul {ir} {values[0]}, {values[0]}")
        if what == "casadi_sign":
            return self.sign(values[0])
        if what == "?":
            chosen = f"{self.real.flag} {self.flag(values[0])}, {ir} {values[1]}"
            return self.new(f"select {chosen}, {ir} {self.real.constant(0)}")
        if what in COMPARISONS or what in JUNCTIONS or what == "!.":
            return self.told(what, values)
        if what in TURNING and self.real.lanes > 1:
            if values[0] not in self.turned:
                self.turned[values[0]] = self.new(self.real.turned(values[0]))
            pair = f"{self.real.both} {self.turned[values[0]]}"
            return self.new(f"extractvalue {pair}, {TURNING.index(what)}")
        call = self.real.call(what, values)
        if call is None:
            raise _unknown(f"{what}()")
        return self.new(call)

    def told(self, what: str, values: list[str]) -> str:
        """0 or 1, by a comparison or of others."""
        if what in COMPARISONS:
            flag = self.compared(COMPARISONS[what], *values)
        elif what in JUNCTIONS:
            left, right = (self.flag(value) for value in values)
            flag = self.new(f"{JUNCTIONS[what]} {self.real.flag} {left}, {right}")
        else:
            flag = self.compared("oeq", values[0], self.real.constant(0))
        number = self.new(f"uitofp {self.real.flag} {flag} to {self.real.ir}")
        self.flags[number] = flag
        return number

    def compared(self, how: str, left: str, right: str) -> str:
        return self.new(f"fcmp {how} {self.real.ir} {left}, {right}")

    def flag(self, value: str) -> str:
        """Whether a number is not zero."""
        if value not in self.flags:
            self.flags[value] = self.compared("une", value, self.real.constant(0))
        return self.flags[value]

    def sign(self, value: str) -> str:
        """``x < 0 ? −1 : x > 0 ? 1 : x``."""
        real, zero = self.real, self.real.constant(0)
        above = self.compared("ogt", value, zero)
        one = f"{real.ir} {real.constant(1)}"
        first = self.new(f"select {real.flag} {above}, {one}, {real.ir} {value}")
        below = self.compared("olt", value, zero)
        minus = f"{real.ir} {real.constant(-1)}"
        return self.new(f"select {real.flag} {below}, {minus}, {real.ir} {first}")
