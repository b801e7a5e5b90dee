"""Expressions of the C that CasADi writes, as LLVM IR.

Comparisons of numbers in lanes have no one answer; functions whose course depends on one are
refused.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pycparser import c_ast

from dalembert.symbolic.native.c_instructions import Instructions, Value
from dalembert.symbolic.native.c_types import INT, REAL, SMALL, VOID, CType, declared, pointer
from dalembert.symbolic.native.real import INTRINSICS, LIBRARY
from dalembert.symbolic.native.toolchain import NotTranslated

WHOLE_COMPARED = {"==": "eq", "!=": "ne", "<": "slt", "<=": "sle", ">": "sgt", ">=": "sge"}
REAL_COMPARED = {"==": "oeq", "!=": "une", "<": "olt", "<=": "ole", ">": "ogt", ">=": "oge"}
NAMED = {"casadi_inf": "inf", "INFINITY": "inf", "casadi_nan": "nan", "NAN": "nan"}


class Expressions(Instructions):
    """Writes the instructions of expressions."""

    def value(self, node: Any) -> Value:
        """The value of an expression."""
        return self._methods[type(node)](self, node)

    def condition(self, node: Any) -> str:
        """Whether an expression is true."""
        name, lanes = self.test(node)
        if lanes:
            raise NotTranslated("lanes do not agree on a choice")
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
        raise NotTranslated(f"{type(node).__name__} is no variable")

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
        raise NotTranslated(f"the operator {node.op} is not known")

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
            raise NotTranslated(f"the function {name} is not known")
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
