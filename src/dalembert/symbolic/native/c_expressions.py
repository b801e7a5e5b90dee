"""Expressions of the C that CasADi writes, as LLVM IR.

Every variable has a place in memory; LLVM turns these into registers. Comparisons and conditions
of numbers in lanes have no one answer, so that functions with such a choice are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pycparser import c_ast

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.c_types import INT, REAL, SMALL, VOID, CType, declared, pointer
from dalembert.symbolic.native.real import INTRINSICS, LIBRARY, Real

Value = tuple[str, CType]
SIMPLE = {"+": "add", "-": "sub", "*": "mul", "/": "sdiv", "%": "srem"}
SIMPLE |= {"&": "and", "|": "or", "^": "xor", "<<": "shl", ">>": "ashr"}
REALS = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
WHOLE_COMPARED = {"==": "eq", "!=": "ne", "<": "slt", "<=": "sle", ">": "sgt", ">=": "sge"}
REAL_COMPARED = {"==": "oeq", "!=": "une", "<": "olt", "<=": "ole", ">": "ogt", ">=": "oge"}
NAMED = {"casadi_inf": "inf", "INFINITY": "inf", "casadi_nan": "nan", "NAN": "nan"}


@dataclass
class Surroundings:
    """What functions see of their file.

    Attributes
    ----------
    real : Real
    functions : name → type of the result, types of the arguments
    arrays : name → type
    structs : name → names and types of the fields
    """

    real: Real
    functions: dict[str, tuple[CType, list[CType]]] = field(default_factory=dict)
    arrays: dict[str, CType] = field(default_factory=dict)
    structs: dict[str, list[tuple[str, CType]]] = field(default_factory=dict)


class Expressions:
    """Writes the instructions of one function."""

    def __init__(self, around: Surroundings):
        self.around, self.real = around, around.real
        self.lines: list[str] = []
        self.places: list[str] = []
        self.names: dict[str, Value] = {}
        self.count = 0

    # instructions -------------------------------------------------------------------
    def new(self, right: str) -> str:
        """The value of an instruction."""
        self.count += 1
        self.lines.append(f"  %v{self.count} = {right}")
        return f"%v{self.count}"

    def label(self, name: str) -> str:
        self.count += 1
        return f"{name}{self.count}"

    def begin(self, label: str) -> None:
        """Begin a block; the one before runs on into it."""
        self.lines += [f"  br label %{label}", f"{label}:"]

    def jump(self, label: str) -> None:
        """Go elsewhere; what follows in the text is reached from nowhere else."""
        self.lines += [f"  br label %{label}", f"{self.label('dead')}:"]

    def branch(self, condition: str, yes: str, no: str) -> None:
        self.lines.append(f"  br i1 {condition}, label %{yes}, label %{no}")

    def place(self, kind: CType) -> str:
        """Room for a variable, made when the function begins."""
        self.count += 1
        self.places.append(f"  %x{self.count} = alloca {kind.ir(self.real)}")
        return f"%x{self.count}"

    def load(self, place: str, kind: CType) -> Value:
        if kind.kind == "array":
            return place, pointer(kind.target)
        if kind.kind == "struct":
            return place, kind
        return self.new(f"load {kind.ir(self.real)}, ptr {place}{self._align(kind)}"), kind

    def store(self, value: Value, place: str, kind: CType) -> str:
        made = self.converted(value, kind)
        text = f"{kind.ir(self.real)} {made}, ptr {place}{self._align(kind)}"
        self.lines.append(f"  store {text}")
        return made

    def _align(self, kind: CType) -> str:
        return ", align 8" if kind.kind == "real" else ""

    # expressions --------------------------------------------------------------------
    def value(self, node: Any) -> Value:
        """The value of an expression."""
        return self._methods[type(node)](self, node)

    def converted(self, value: Value, kind: CType) -> str:
        """A value as another type."""
        name, given = value
        if given == kind or (given.kind == kind.kind != "struct"):
            return name
        if kind.kind == "real":
            if name.lstrip("-").isdigit():
                return self.real.constant(name)
            one = self.new(f"sitofp {given.ir(self.real)} {name} to double")
            return self._in_all_lanes(one)
        if given.kind == "real" and kind.kind in ("int", "small"):
            if self.real.lanes > 1:
                raise UnsupportedError("backend 'jit': lanes do not tell one whole number")
            return self.new(f"fptosi double {name} to {kind.ir(self.real)}")
        if kind.kind == "pointer" and name == "0":
            return "null"
        if {kind.kind, given.kind} == {"int", "small"}:
            if name.lstrip("-").isdigit():
                return name
            how = "sext" if kind.kind == "int" else "trunc"
            return self.new(f"{how} {given.ir(self.real)} {name} to {kind.ir(self.real)}")
        raise UnsupportedError(f"backend 'jit': a {given.kind} is no {kind.kind}")

    def _in_all_lanes(self, one: str) -> str:
        if self.real.lanes == 1:
            return one
        ir, last = self.real.ir, "undef"
        for lane in range(self.real.lanes):
            last = self.new(f"insertelement {ir} {last}, double {one}, i32 {lane}")
        return last

    def condition(self, node: Any) -> str:
        """Whether an expression is true."""
        name, lanes = self.test(node)
        if lanes:
            raise UnsupportedError("backend 'jit': lanes do not agree on a choice")
        return name

    def test(self, node: Any) -> tuple[str, bool]:
        """Whether an expression is true; and whether that is told for each lane."""
        if isinstance(node, c_ast.BinaryOp) and node.op in WHOLE_COMPARED:
            left, right, kind = self._alike(self.value(node.left), self.value(node.right))
            return self._compared(node.op, left, right, kind)
        if isinstance(node, c_ast.UnaryOp) and node.op == "!":
            name, lanes = self.test(node.expr)
            flag = self.real.flag if lanes else "i1"
            return self.new(f"xor {flag} {name}, {self.real.all_true if lanes else 'true'}"), lanes
        if isinstance(node, c_ast.BinaryOp) and node.op in ("&&", "||"):
            return self._junction(node)
        name, kind = self.value(node)
        nothing = {"real": self.real.constant(0), "pointer": "null"}.get(kind.kind, "0")
        return self._compared("!=", name, nothing, kind)

    def _compared(self, op: str, left: str, right: str, kind: CType) -> tuple[str, bool]:
        if kind.kind == "real":
            text = f"fcmp {REAL_COMPARED[op]} {self.real.ir} {left}, {right}"
            return self.new(text), self.real.lanes > 1
        how = WHOLE_COMPARED[op]
        if kind.kind == "pointer":
            how = how.replace("s", "u", 1) if how[0] == "s" else how
        return self.new(f"icmp {how} {kind.ir(self.real)} {left}, {right}"), False

    def _junction(self, node: Any) -> tuple[str, bool]:
        """``&&`` and ``||``: the right side counts only where the left one leaves it open."""
        left, lanes = self.test(node.left)
        if lanes:
            how, flag = "and" if node.op == "&&" else "or", self.real.flag
            return self.new(f"{how} {flag} {left}, {self.test(node.right)[0]}"), True
        more, end, place = self.label("more"), self.label("end"), self.label("%x")
        self.places.append(f"  {place} = alloca i1")
        self.lines.append(f"  store i1 {left}, ptr {place}")
        self.branch(left, *((more, end) if node.op == "&&" else (end, more)))
        self.lines.append(f"{more}:")
        self.lines.append(f"  store i1 {self.condition(node.right)}, ptr {place}")
        self.begin(end)
        return self.new(f"load i1, ptr {place}"), False

    def _alike(self, left: Value, right: Value) -> tuple[str, str, CType]:
        """Two values in the type that holds both."""
        kinds = {left[1].kind, right[1].kind}
        for kind in ("pointer", "real", "int", "small"):
            if kind in kinds:
                common = left[1] if left[1].kind == kind else right[1]
                return self.converted(left, common), self.converted(right, common), common
        raise UnsupportedError(f"backend 'jit': {' and '.join(kinds)} are not compared")

    def _constant(self, node: Any) -> Value:
        if node.type == "double" or "." in node.value or "e" in node.value.lower():
            return self.real.constant(node.value), REAL
        return str(int(node.value.rstrip("lLuU"), 0)), SMALL if "L" not in node.value else INT

    def _identifier(self, node: Any) -> Value:
        if node.name in NAMED:
            return self.real.constant(NAMED[node.name]), REAL
        if node.name in self.around.arrays and node.name not in self.names:
            return f"@{node.name}", pointer(self.around.arrays[node.name])
        return self.load(*self.names[node.name])

    def _read(self, node: Any) -> Value:
        return self.load(*self.located(node))

    def located(self, node: Any) -> Value:
        """Where a variable lies, and its type."""
        if isinstance(node, c_ast.ID):
            return self.names[node.name]
        if isinstance(node, c_ast.ArrayRef):
            base, kind = self.value(node.name)
            return self._moved(base, kind, self.value(node.subscript)), kind.target
        if isinstance(node, c_ast.UnaryOp) and node.op == "*":
            name, kind = self.value(node.expr)
            return name, kind.target
        if isinstance(node, c_ast.StructRef):
            place, kind = self.value(node.name) if node.type == "->" else self.located(node.name)
            struct = kind.target if node.type == "->" else kind
            fields = self.around.structs[struct.name]
            number = [name for name, _ in fields].index(node.field.name)
            found = self.new(
                f"getelementptr {struct.ir(self.real)}, ptr {place}, i32 0, i32 {number}"
            )
            return found, fields[number][1]
        raise UnsupportedError(f"backend 'jit': {type(node).__name__} is no variable")

    def _moved(self, base: str, kind: CType, by: Value) -> str:
        index = self.converted(by, INT)
        return self.new(f"getelementptr {kind.target.ir(self.real)}, ptr {base}, i64 {index}")

    def _binary(self, node: Any) -> Value:
        if node.op in WHOLE_COMPARED or node.op in ("&&", "||"):
            return self._truth(node)
        return self._combined(node.op, self.value(node.left), self.value(node.right))

    def _truth(self, node: Any) -> Value:
        """A condition as a number; of real numbers one for each lane."""
        name, lanes = self.test(node)
        if lanes:
            return self.new(f"uitofp {self.real.flag} {name} to {self.real.ir}"), REAL
        return self.new(f"zext i1 {name} to i32"), SMALL

    def _combined(self, op: str, left: Value, right: Value) -> Value:
        if left[1].kind == "pointer" and right[1].kind != "pointer":
            by = right if op == "+" else (self._negative(right), right[1])
            return self._moved(*left, by), left[1]
        if right[1].kind == "pointer" and left[1].kind != "pointer":
            return self._moved(*right, left), right[1]
        a, b, kind = self._alike(left, right)
        if kind.kind == "pointer":
            raise UnsupportedError("backend 'jit': pointers are not subtracted")
        how = REALS[op] if kind.kind == "real" else SIMPLE[op]
        return self.new(f"{how} {kind.ir(self.real)} {a}, {b}"), kind

    def _negative(self, value: Value) -> str:
        name, kind = value
        if kind.kind == "real":
            return self.new(f"fneg {kind.ir(self.real)} {name}")
        return self.new(f"sub {kind.ir(self.real)} 0, {name}")

    def _unary(self, node: Any) -> Value:
        if node.op == "*":
            return self._read(node)
        if node.op == "&":
            place, kind = self.located(node.expr)
            return place, pointer(kind)
        if node.op == "!":
            return self._truth(node)
        if node.op == "-":
            value = self.value(node.expr)
            return self._negative(value), value[1]
        if node.op in ("++", "--", "p++", "p--"):
            place, kind = self.located(node.expr)
            old = self.load(place, kind)
            new = self._combined(node.op[-1], old, ("1", SMALL))
            self.store(new, place, kind)
            return old if node.op[0] == "p" else new
        raise UnsupportedError(f"backend 'jit': the operator {node.op} is not known")

    def _assignment(self, node: Any) -> Value:
        if node.op == "=":
            value = self.value(node.rvalue)
            place, kind = self.located(node.lvalue)
            return self.store(value, place, kind), kind
        right = self.value(node.rvalue)
        place, kind = self.located(node.lvalue)
        made = self._combined(node.op[:-1], self.load(place, kind), right)
        return self.store(made, place, kind), kind

    def _ternary(self, node: Any) -> Value:
        name, lanes = self.test(node.cond)
        if lanes:
            yes, no = (self.converted(self.value(s), REAL) for s in (node.iftrue, node.iffalse))
            chosen = f"select {self.real.flag} {name}, {self.real.ir} {yes}, {self.real.ir} {no}"
            return self.new(chosen), REAL
        labels, end = (self.label("yes"), self.label("no")), self.label("end")
        self.branch(name, *labels)
        before, sides = self.lines, list[tuple[list[str], Value]]()
        for label, side in zip(labels, (node.iftrue, node.iffalse), strict=True):
            self.lines = [f"{label}:"]
            value = self.value(side)
            sides.append((self.lines, value))
        kind = max((value[1] for _, value in sides), key=_rank)
        place = self.place(kind)
        for lines, value in sides:
            self.lines = lines
            self.store(value, place, kind)
            before += [*self.lines, f"  br label %{end}"]
        self.lines = [*before, f"{end}:"]
        return self.load(place, kind)

    def _cast(self, node: Any) -> Value:
        kind = declared(node.to_type)
        return self.converted(self.value(node.expr), kind), kind

    def _list(self, node: Any) -> Value:
        return [self.value(expression) for expression in node.exprs][-1]

    def _call(self, node: Any) -> Value:
        name = node.name.name
        given = [self.value(argument) for argument in (node.args.exprs if node.args else ())]
        if name == "casadi_to_int":
            return self.converted(given[0], INT), INT
        if name in INTRINSICS or name in LIBRARY:
            call = self.real.call(name, [self.converted(value, REAL) for value in given])
            return self.new(str(call)), REAL
        if name not in self.around.functions:
            raise UnsupportedError(f"backend 'jit': the function {name} is not known")
        kind, wanted = self.around.functions[name]
        parts = [
            f"{to.ir(self.real)} {self.converted(value, to)}"
            for value, to in zip(given, wanted, strict=True)
        ]
        text = f"call {kind.ir(self.real)} @{name}({', '.join(parts)})"
        if kind is VOID:
            self.lines.append(f"  {text}")
            return "0", SMALL
        return self.new(text), kind

    _methods: dict[type, Callable[[Any, Any], Value]] = {
        c_ast.Constant: _constant,
        c_ast.ID: _identifier,
        c_ast.ArrayRef: _read,
        c_ast.StructRef: _read,
        c_ast.BinaryOp: _binary,
        c_ast.UnaryOp: _unary,
        c_ast.Assignment: _assignment,
        c_ast.TernaryOp: _ternary,
        c_ast.Cast: _cast,
        c_ast.ExprList: _list,
        c_ast.FuncCall: _call,
    }


def _rank(kind: CType) -> int:
    """Of two types the one that holds the values of both."""
    return ["void", "small", "int", "real", "pointer", "array", "struct"].index(kind.kind)
