"""A piece of straight-line code as a function of LLVM IR, shared by all equal pieces.

Values from outside of a piece are addressed by the indices in a row of a table. Values stay in
registers within a piece and pass from piece to piece through the work vector. Every operation is
rounded as written: nothing is fused or reordered.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dalembert.symbolic.native.calls import FunctionCall, call_instructions
from dalembert.symbolic.native.operations import Line, unknown
from dalembert.symbolic.native.real import SINE_COSINE, Real

Place = tuple[int | None, int]
"""A column of the table or None, and an offset added to its index."""
PARAMETERS = "ptr %arg, ptr %res, ptr %iw, ptr %w"
ZEROS = "zeros"
"""Name of the array used for null arguments."""
ARITHMETIC = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
COMPARISONS = {"==": "oeq", "!=": "une", "<=": "ole", "<": "olt"}
JUNCTIONS = {"&&": "and", "||": "or"}


@dataclass(frozen=True)
class Constants:
    """Constants of a body.

    Attributes
    ----------
    name : of their array
    texts : as written
    """

    name: str
    texts: Sequence[str]


class Piece:
    """A piece of a body as a function.

    Parameters
    ----------
    real : Real
    places : locations of values from outside of the piece, in order of use
    constants : of the body
    calls : of the body
    room : slots of the body in the work vector; the work of called functions follows
    uniform : indices of arguments that are equal in all lanes and passed once
    """

    def __init__(
        self,
        real: Real,
        places: Sequence[Place],
        constants: Constants,
        calls: Sequence[FunctionCall],
        room: int,
        uniform: Sequence[int] = (),
    ):
        self.real, self.count = real, 0
        self._places, self._constants = iter(places), constants
        self._calls, self.room, self._uniform = calls, room, frozenset(uniform)
        self._operands: dict[int, str] = {}
        self._results: dict[int, str] = {}
        self.lines: list[str] = []
        self.values: dict[str, str] = {}
        self.flags: dict[str, str] = {}
        self.sincos: dict[str, str] = {}
        self._cached: dict[str, str] = {}

    def text(
        self, name: str, lines: Sequence[Line], stored: Sequence[bool], width: int
    ) -> list[str]:
        """IR of the function; it returns the address of the next row, or null on failure.

        Parameters
        ----------
        name : of the function
        lines : operations
        stored : whether a later piece reads the value of a line
        width : indices in a row of the table
        """
        for (operation, target, operands), store in zip(lines, stored, strict=True):
            if operation == "output":
                value = self.value(target)
                self._output(operands[0], value)
            elif operation == "give":
                self._operands[int(operands[0])] = self.value(target)
            elif operation == "call":
                self._call(self._calls[int(operands[0])])
            elif operation == "take":
                self.values[target] = self._results[int(operands[0])]
            else:
                self.values[target] = self.assigned(operation, operands)
            if store:
                self._store(self.values[target], self._element("%w"))
        parameters = f"{PARAMETERS}, ptr noalias readonly %t"
        head = f"define internal ptr @{name}({parameters}) noinline nounwind {{"
        end = [f"  %end = getelementptr i32, ptr %t, i64 {width}", "  ret ptr %end"]
        end += ["failed:", "  ret ptr null"] if any(line[0] == "call" for line in lines) else []
        end.append("}")
        nowhere = f"  %nowhere = alloca {self.real.ir}"
        return [head, nowhere, *self.lines, *end]

    def new(self, right: str) -> str:
        """Append an instruction; the name of its value."""
        self.count += 1
        self.lines.append(f"  %v{self.count} = {right}")
        return f"%v{self.count}"

    def value(self, operand: str) -> str:
        """The value of a slot, loaded from the work vector if an earlier piece defined it."""
        if operand[0] != "a":
            return self.real.constant(operand)
        if operand not in self.values:
            self.values[operand] = self._load(self._element("%w"))
        return self.values[operand]

    def _call(self, call: FunctionCall) -> None:
        write = self.lines.append
        self._results = call_instructions(
            call, self.real, self.room, self._operands, self.new, write
        )
        self._operands = {}

    def _load(self, place: str) -> str:
        return self.new(f"load {self.real.ir}, ptr {place}, align 8")

    def _store(self, value: str, place: str) -> None:
        self.lines.append(f"  store {self.real.ir} {value}, ptr {place}, align 8")

    def _element(self, array: str, kind: str = "") -> str:
        """Address of the next place in an array, by default of reals."""
        column, number = next(self._places)
        ir = kind or self.real.ir
        if column is None:
            return self.new(f"getelementptr {ir}, ptr {array}, i64 {number}")
        begin = self.new(f"getelementptr {ir}, ptr {array}, i64 {self._table_entry(column)}")
        return self.new(f"getelementptr {ir}, ptr {begin}, i64 {number}") if number else begin

    def _table_entry(self, column: int) -> str:
        """An index of the row of the table."""
        key = f"t{column}"
        if key not in self._cached:
            place = self.new(f"getelementptr i32, ptr %t, i64 {column}")
            self._cached[key] = self.new(f"sext i32 {self.new(f'load i32, ptr {place}')} to i64")
        return self._cached[key]

    def _argument(self, index: str) -> str:
        """The array of an argument, or zeros for a null argument."""
        key = f"g{index}"
        if key not in self._cached:
            array, missing = self._array("%arg", index)
            self._cached[key] = self.new(f"select i1 {missing}, ptr @{ZEROS}, ptr {array}")
        return self._cached[key]

    def _output(self, index: str, value: str) -> None:
        """Store an entry of a result, unless the result is null."""
        key = f"r{index}"
        if key not in self._cached:
            array, self._cached[f"m{index}"] = self._array("%res", index)
            self._cached[key] = array
        place = self._element(self._cached[key])
        missing = self._cached[f"m{index}"]
        self._store(value, self.new(f"select i1 {missing}, ptr %nowhere, ptr {place}"))

    def _array(self, arrays: str, index: str) -> tuple[str, str]:
        """An array of several, and whether it is null."""
        place = self.new(f"getelementptr ptr, ptr {arrays}, i64 {index}")
        array = self.new(f"load ptr, ptr {place}")
        return array, self.new(f"icmp eq ptr {array}, null")

    def _constant(self) -> str:
        """A constant, read from an array if it differs between equal pieces."""
        column, number = next(self._places)
        if column is None:
            return self.real.constant(self._constants.texts[number])
        begin = self.new(
            f"getelementptr double, ptr @{self._constants.name}, i64 {self._table_entry(column)}"
        )
        place = self.new(f"getelementptr double, ptr {begin}, i64 {number}") if number else begin
        return self._broadcast(self.new(f"load double, ptr {place}"))

    def _broadcast(self, number: str) -> str:
        """A double in all lanes."""
        ir, lanes = self.real.ir, self.real.lanes
        if lanes == 1:
            return number
        first = self.new(f"insertelement {ir} undef, double {number}, i32 0")
        mask = f"<{lanes} x i32> zeroinitializer"
        return self.new(f"shufflevector {ir} {first}, {ir} undef, {mask}")

    def assigned(self, operation: str, operands: tuple[str, ...]) -> str:
        """The value of an assignment."""
        ir = self.real.ir
        if operation == "input":
            array = self._argument(operands[0])
            if int(operands[0]) not in self._uniform:
                return self._load(self._element(array))
            place = self._element(array, "double")
            return self._broadcast(self.new(f"load double, ptr {place}, align 8"))
        if operation == "constant":
            return self._constant()
        values = [self.value(operand) for operand in operands]
        if operation in ARITHMETIC:
            return self.new(f"{ARITHMETIC[operation]} {ir} {values[0]}, {values[1]}")
        if operation == "-.":
            return self.new(f"fneg {ir} {values[0]}")
        if operation == "casadi_sq":
            return self.new(f"fmul {ir} {values[0]}, {values[0]}")
        if operation == "casadi_sign":
            return self.sign(values[0])
        if operation == "?":
            chosen = f"{self.real.flag} {self.flag(values[0])}, {ir} {values[1]}"
            return self.new(f"select {chosen}, {ir} {self.real.constant(0)}")
        if operation in COMPARISONS or operation in JUNCTIONS or operation == "!.":
            return self.logical(operation, values)
        if operation in SINE_COSINE and self.real.lanes > 1:
            if values[0] not in self.sincos:
                self.sincos[values[0]] = self.new(self.real.sincos(values[0]))
            pair = f"{self.real.pair} {self.sincos[values[0]]}"
            return self.new(f"extractvalue {pair}, {SINE_COSINE.index(operation)}")
        call = self.real.call(operation, values)
        if call is None:
            raise unknown(f"{operation}()")
        return self.new(call)

    def logical(self, operation: str, values: list[str]) -> str:
        """0 or 1, the value of a comparison or a logical operation."""
        if operation in COMPARISONS:
            flag = self.compared(COMPARISONS[operation], *values)
        elif operation in JUNCTIONS:
            left, right = (self.flag(value) for value in values)
            flag = self.new(f"{JUNCTIONS[operation]} {self.real.flag} {left}, {right}")
        else:
            flag = self.compared("oeq", values[0], self.real.constant(0))
        number = self.new(f"uitofp {self.real.flag} {flag} to {self.real.ir}")
        self.flags[number] = flag
        return number

    def compared(self, predicate: str, left: str, right: str) -> str:
        return self.new(f"fcmp {predicate} {self.real.ir} {left}, {right}")

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
