"""A piece of a straight body as a function of LLVM IR, and all that are equal to it.

What is not made within a piece is found at places that a row of a table tells.
Values stay in registers within a piece and pass from piece to piece through the work vector. Every
operation is rounded as written: nothing is fused or reordered.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dalembert.symbolic.native.calls import Called, written_call
from dalembert.symbolic.native.lines import Line, unknown
from dalembert.symbolic.native.real import TURNING, Real

Place = tuple[int | None, int]
"""A column of the table, if there is one, and what is added to its number."""
GIVEN = "ptr %arg, ptr %res, ptr %iw, ptr %w"
ZEROS = "zeros"
"""The array that stands for arguments that are not given."""
ARITHMETIC = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
COMPARISONS = {"==": "oeq", "!=": "une", "<=": "ole", "<": "olt"}
JUNCTIONS = {"&&": "and", "||": "or"}


@dataclass(frozen=True)
class Constants:
    """Numbers of a body.

    Attributes
    ----------
    name : of an array of them
    texts : as they are written
    """

    name: str
    texts: Sequence[str]


class Piece:
    """A piece of a body as a function of its own.

    Parameters
    ----------
    real : Real
    places : where numbers are that are not made within the piece, in the order they are asked for
    constants : of the body
    calls : of the body
    room : slots of the body in the work vector; behind them is that of what it calls
    alike : arguments that are the same in all lanes: one number stands for all of them
    """

    def __init__(
        self,
        real: Real,
        places: Sequence[Place],
        constants: Constants,
        calls: Sequence[Called],
        room: int,
        alike: Sequence[int] = (),
    ):
        self.real, self.count = real, 0
        self._places, self._constants = iter(places), constants
        self._calls, self.room, self._alike = calls, room, frozenset(alike)
        self._given: dict[int, str] = {}
        self._taken: dict[int, str] = {}
        self.lines: list[str] = []
        self.values: dict[str, str] = {}
        self.flags: dict[str, str] = {}
        self.turned: dict[str, str] = {}
        self._known: dict[str, str] = {}

    def text(self, name: str, lines: Sequence[Line], kept: Sequence[bool], width: int) -> list[str]:
        """IR of the function; it answers where the row after its own begins, and null to fail.

        Parameters
        ----------
        name : of the function
        lines : what is done
        kept : whether a later piece reads what a line makes
        width : numbers in a row of the table
        """
        for (what, target, given), stays in zip(lines, kept, strict=True):
            if what == "output":
                value = self.value(target)
                self._output(given[0], value)
            elif what == "give":
                self._given[int(given[0])] = self.value(target)
            elif what == "call":
                self._call(self._calls[int(given[0])])
            elif what == "take":
                self.values[target] = self._taken[int(given[0])]
            else:
                self.values[target] = self.assigned(what, given)
            if stays:
                self._store(self.values[target], self._element("%w"))
        head = f"define internal ptr @{name}({GIVEN}, ptr noalias readonly %t) noinline nounwind {{"
        end = [f"  %end = getelementptr i32, ptr %t, i64 {width}", "  ret ptr %end"]
        end += ["failed:", "  ret ptr null"] if any(line[0] == "call" for line in lines) else []
        end.append("}")
        nowhere = f"  %nowhere = alloca {self.real.ir}"
        return [head, nowhere, *self.lines, *end]

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
            self.values[operand] = self._load(self._element("%w"))
        return self.values[operand]

    def _call(self, call: Called) -> None:
        write = self.lines.append
        self._taken = written_call(call, self.real, self.room, self._given, self.new, write)
        self._given = {}

    def _load(self, place: str) -> str:
        return self.new(f"load {self.real.ir}, ptr {place}, align 8")

    def _store(self, value: str, place: str) -> None:
        self.lines.append(f"  store {self.real.ir} {value}, ptr {place}, align 8")

    def _element(self, array: str, kind: str = "") -> str:
        """Where in an array, by default of what stands for a number, the next place is."""
        column, number = next(self._places)
        ir = kind or self.real.ir
        if column is None:
            return self.new(f"getelementptr {ir}, ptr {array}, i64 {number}")
        begin = self.new(f"getelementptr {ir}, ptr {array}, i64 {self._told(column)}")
        return self.new(f"getelementptr {ir}, ptr {begin}, i64 {number}") if number else begin

    def _told(self, column: int) -> str:
        """A number of the table."""
        key = f"t{column}"
        if key not in self._known:
            place = self.new(f"getelementptr i32, ptr %t, i64 {column}")
            self._known[key] = self.new(f"sext i32 {self.new(f'load i32, ptr {place}')} to i64")
        return self._known[key]

    def _argument(self, index: str) -> str:
        """The array of an argument, or one of zeros."""
        key = f"g{index}"
        if key not in self._known:
            given, missing = self._array("%arg", index)
            self._known[key] = self.new(f"select i1 {missing}, ptr @{ZEROS}, ptr {given}")
        return self._known[key]

    def _output(self, index: str, value: str) -> None:
        """Store an entry of a result; nowhere where that is not wanted."""
        key = f"r{index}"
        if key not in self._known:
            wanted, self._known[f"m{index}"] = self._array("%res", index)
            self._known[key] = wanted
        place = self._element(self._known[key])
        missing = self._known[f"m{index}"]
        self._store(value, self.new(f"select i1 {missing}, ptr %nowhere, ptr {place}"))

    def _array(self, arrays: str, index: str) -> tuple[str, str]:
        """One of several arrays, and whether it is missing."""
        place = self.new(f"getelementptr ptr, ptr {arrays}, i64 {index}")
        found = self.new(f"load ptr, ptr {place}")
        return found, self.new(f"icmp eq ptr {found}, null")

    def _constant(self) -> str:
        """A number of the text, one of many where it is another one in other pieces like this."""
        column, number = next(self._places)
        if column is None:
            return self.real.constant(self._constants.texts[number])
        begin = self.new(
            f"getelementptr double, ptr @{self._constants.name}, i64 {self._told(column)}"
        )
        place = self.new(f"getelementptr double, ptr {begin}, i64 {number}") if number else begin
        return self._in_all_lanes(self.new(f"load double, ptr {place}"))

    def _in_all_lanes(self, one: str) -> str:
        ir, lanes = self.real.ir, self.real.lanes
        if lanes == 1:
            return one
        first = self.new(f"insertelement {ir} undef, double {one}, i32 0")
        everywhere = f"<{lanes} x i32> zeroinitializer"
        return self.new(f"shufflevector {ir} {first}, {ir} undef, {everywhere}")

    def assigned(self, what: str, given: tuple[str, ...]) -> str:
        """The value of an assignment."""
        ir = self.real.ir
        if what == "input":
            array = self._argument(given[0])
            if int(given[0]) not in self._alike:
                return self._load(self._element(array))
            place = self._element(array, "double")
            return self._in_all_lanes(self.new(f"load double, ptr {place}, align 8"))
        if what == "constant":
            return self._constant()
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
            raise unknown(f"{what}()")
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
