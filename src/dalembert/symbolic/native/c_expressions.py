"""Translation of C expressions, as written by CasADi, to LLVM IR.

A comparison of lanes has one result per lane; functions whose control flow depends on one are
rejected.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pycparser import c_ast

from dalembert.symbolic.native.c_instructions import (
    INT,
    REAL,
    SMALL,
    VOID,
    CType,
    Instructions,
    Value,
    declared_type,
    pointer,
)
from dalembert.symbolic.native.real import INTRINSICS, LIBRARY
from dalembert.symbolic.native.toolchain import NotTranslated

INT_COMPARISONS = {"==": "eq", "!=": "ne", "<": "slt", "<=": "sle", ">": "sgt", ">=": "sge"}
REAL_COMPARISONS = {"==": "oeq", "!=": "une", "<": "olt", "<=": "ole", ">": "ogt", ">=": "oge"}
NAMED = {"casadi_inf": "inf", "INFINITY": "inf", "casadi_nan": "nan", "NAN": "nan"}


class Expressions(Instructions):
    """Writer of the instructions of expressions."""

    def value(self, node: Any) -> Value:
        """The value of an expression."""
        return self._methods[type(node)](self, node)

    def condition(self, node: Any) -> str:
        """The truth of an expression as one flag."""
        name, lanes = self.test(node)
        if lanes:
            raise NotTranslated("control flow that depends on lanes")
        return name

    def test(self, node: Any) -> tuple[str, bool]:
        """The truth of an expression, and whether it has one flag per lane."""
        if isinstance(node, c_ast.BinaryOp) and node.op in INT_COMPARISONS:
            left, right, kind = self._promoted(self.value(node.left), self.value(node.right))
            return self._compare(node.op, left, right, kind)
        if isinstance(node, c_ast.UnaryOp) and node.op == "!":
            name, lanes = self.test(node.expr)
            flag = self.real.flag if lanes else "i1"
            return self.new(f"xor {flag} {name}, {self.real.all_true if lanes else 'true'}"), lanes
        if isinstance(node, c_ast.BinaryOp) and node.op in ("&&", "||"):
            return self._junction(node)
        name, kind = self.value(node)
        zero = {"real": self.real.constant(0), "pointer": "null"}.get(kind.kind, "0")
        return self._compare("!=", name, zero, kind)

    def _compare(self, op: str, left: str, right: str, kind: CType) -> tuple[str, bool]:
        if kind.kind == "real":
            text = f"fcmp {REAL_COMPARISONS[op]} {self.real.ir} {left}, {right}"
            return self.new(text), self.real.lanes > 1
        predicate = INT_COMPARISONS[op]
        if kind.kind == "pointer":
            predicate = predicate.replace("s", "u", 1) if predicate[0] == "s" else predicate
        return self.new(f"icmp {predicate} {kind.ir(self.real)} {left}, {right}"), False

    def _junction(self, node: Any) -> tuple[str, bool]:
        """``&&`` and ``||`` with short-circuit evaluation."""
        left, lanes = self.test(node.left)
        if lanes:
            instruction, flag = "and" if node.op == "&&" else "or", self.real.flag
            return self.new(f"{instruction} {flag} {left}, {self.test(node.right)[0]}"), True
        more, end, address = self.label("more"), self.label("end"), self.label("%x")
        self.allocations.append(f"  {address} = alloca i1")
        self.lines.append(f"  store i1 {left}, ptr {address}")
        self.branch(left, *((more, end) if node.op == "&&" else (end, more)))
        self.lines.append(f"{more}:")
        self.lines.append(f"  store i1 {self.condition(node.right)}, ptr {address}")
        self.begin(end)
        return self.new(f"load i1, ptr {address}"), False

    def _constant(self, node: Any) -> Value:
        if node.type == "double" or "." in node.value or "e" in node.value.lower():
            return self.real.constant(node.value), REAL
        return str(int(node.value.rstrip("lLuU"), 0)), SMALL if "L" not in node.value else INT

    def _identifier(self, node: Any) -> Value:
        if node.name in NAMED:
            return self.real.constant(NAMED[node.name]), REAL
        if node.name in self.module.arrays and node.name not in self.names:
            return f"@{node.name}", pointer(self.module.arrays[node.name])
        return self.load(*self.names[node.name])

    def _read(self, node: Any) -> Value:
        return self.load(*self.address_of(node))

    def address_of(self, node: Any) -> Value:
        """Address and type of a variable."""
        if isinstance(node, c_ast.ID):
            return self.names[node.name]
        if isinstance(node, c_ast.ArrayRef):
            base, kind = self.value(node.name)
            return self._offset(base, kind, self.value(node.subscript)), kind.target
        if isinstance(node, c_ast.UnaryOp) and node.op == "*":
            name, kind = self.value(node.expr)
            return name, kind.target
        if isinstance(node, c_ast.StructRef):
            address, kind = (
                self.value(node.name) if node.type == "->" else self.address_of(node.name)
            )
            struct = kind.target if node.type == "->" else kind
            fields = self.module.structs[struct.name]
            number = [name for name, _ in fields].index(node.field.name)
            address = self.new(
                f"getelementptr {struct.ir(self.real)}, ptr {address}, i32 0, i32 {number}"
            )
            return address, fields[number][1]
        raise NotTranslated(f"{type(node).__name__} is not a variable")

    def _binary(self, node: Any) -> Value:
        if node.op in INT_COMPARISONS or node.op in ("&&", "||"):
            return self._flag_value(node)
        return self._combine(node.op, self.value(node.left), self.value(node.right))

    def _flag_value(self, node: Any) -> Value:
        """A condition as a number; for reals in lanes one number per lane."""
        name, lanes = self.test(node)
        if lanes:
            return self.new(f"uitofp {self.real.flag} {name} to {self.real.ir}"), REAL
        return self.new(f"zext i1 {name} to i32"), SMALL

    def _unary(self, node: Any) -> Value:
        if node.op == "*":
            return self._read(node)
        if node.op == "&":
            address, kind = self.address_of(node.expr)
            return address, pointer(kind)
        if node.op == "!":
            return self._flag_value(node)
        if node.op == "-":
            value = self.value(node.expr)
            return self._negate(value), value[1]
        if node.op in ("++", "--", "p++", "p--"):
            address, kind = self.address_of(node.expr)
            old = self.load(address, kind)
            new = self._combine(node.op[-1], old, ("1", SMALL))
            self.store(new, address, kind)
            return old if node.op[0] == "p" else new
        raise NotTranslated(f"unknown operator {node.op}")

    def _assignment(self, node: Any) -> Value:
        if node.op == "=":
            value = self.value(node.rvalue)
            address, kind = self.address_of(node.lvalue)
            return self.store(value, address, kind), kind
        right = self.value(node.rvalue)
        address, kind = self.address_of(node.lvalue)
        value = self._combine(node.op[:-1], self.load(address, kind), right)
        return self.store(value, address, kind), kind

    def _ternary(self, node: Any) -> Value:
        name, lanes = self.test(node.cond)
        if lanes:
            yes, no = (self.convert(self.value(s), REAL) for s in (node.iftrue, node.iffalse))
            chosen = f"select {self.real.flag} {name}, {self.real.ir} {yes}, {self.real.ir} {no}"
            return self.new(chosen), REAL
        labels, end = (self.label("yes"), self.label("no")), self.label("end")
        self.branch(name, *labels)
        before, branches = self.lines, list[tuple[list[str], Value]]()
        for label, branch in zip(labels, (node.iftrue, node.iffalse), strict=True):
            self.lines = [f"{label}:"]
            value = self.value(branch)
            branches.append((self.lines, value))
        kind = max((value[1] for _, value in branches), key=_rank)
        address = self.allocate(kind)
        for lines, value in branches:
            self.lines = lines
            self.store(value, address, kind)
            before += [*self.lines, f"  br label %{end}"]
        self.lines = [*before, f"{end}:"]
        return self.load(address, kind)

    def _cast(self, node: Any) -> Value:
        kind = declared_type(node.to_type)
        return self.convert(self.value(node.expr), kind), kind

    def _list(self, node: Any) -> Value:
        return [self.value(expression) for expression in node.exprs][-1]

    def _call(self, node: Any) -> Value:
        name = node.name.name
        values = [self.value(argument) for argument in (node.args.exprs if node.args else ())]
        if name == "casadi_to_int":
            return self.convert(values[0], INT), INT
        if name in INTRINSICS or name in LIBRARY:
            call = self.real.call(name, [self.convert(value, REAL) for value in values])
            return self.new(str(call)), REAL
        if name not in self.module.functions:
            raise NotTranslated(f"unknown function {name}")
        kind, argument_types = self.module.functions[name]
        arguments = [
            f"{to.ir(self.real)} {self.convert(value, to)}"
            for value, to in zip(values, argument_types, strict=True)
        ]
        text = f"call {kind.ir(self.real)} @{name}({', '.join(arguments)})"
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
    """Rank of a type; the higher one of two can represent the values of both."""
    return ["void", "small", "int", "real", "pointer", "array", "struct"].index(kind.kind)
