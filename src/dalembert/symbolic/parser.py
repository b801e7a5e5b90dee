"""Formulas in text: an allow-listed grammar, parsed without ``eval``.

Numbers, names, ``+ - * / **``, comparisons, and the functions of
:mod:`dalembert.symbolic.functions`. A name may be dotted (``crank.end.x``), and its parts may have
a number (``bars[3].stress``, ``plate.von_mises.max(0.1)``). Length, depth and node count are
limited, so that a hostile file cannot exhaust the machine.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.expression import Expression
from dalembert.symbolic.functions import FORMULA_FUNCTIONS
from dalembert.text import nearest, unknown

MAX_LENGTH = 2000
MAX_DEPTH = 50
MAX_NODES = 1000

_OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_COMPARISONS = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
CONSTANTS = {"pi": math.pi, "e": math.e}


def parse_formula(
    text: str, lookup: Callable[[str], Expression | None], known: Callable[[], list[str]] = list
) -> Expression:
    """Turn the text of a formula into an expression.

    Parameters
    ----------
    text : str
        The formula, at most ``MAX_LENGTH`` characters.
    lookup : callable
        Gives the expression behind a (dotted) name, or None.
    known : callable, optional
        Gives the names to suggest from when one is unknown.

    Raises
    ------
    ExpressionError
        With the text, the place and a cure; ``UnknownNameError`` where a name is unknown.
    """
    return _Parser(text, lookup, known).run()


class _Parser:
    def __init__(self, text: str, lookup, known: Callable[[], list[str]]):
        self.text, self.lookup, self.known = text, lookup, known
        self.nodes = 0

    def fail(self, message: str) -> ExpressionError:
        shown = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return ExpressionError(f"in formula {shown!r}: {message}")

    def run(self) -> Expression:
        text = self.text
        if len(text) > MAX_LENGTH:
            raise self.fail(f"{len(text)} characters, at most {MAX_LENGTH} are allowed")
        if not text.strip():
            raise self.fail("it is empty; write a number or a formula")
        depth = 0
        for character in text:
            depth += (character in "([{") - (character in ")]}")
            if depth > MAX_DEPTH:
                raise self.fail(f"nested more than {MAX_DEPTH} deep")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SyntaxWarning)
                tree = ast.parse(text.strip(), mode="eval")
        except SyntaxError as error:
            raise self.fail(f"syntax error at column {error.offset}: {error.msg}") from None
        except (ValueError, RecursionError, MemoryError):
            raise self.fail("it cannot be read as a formula") from None
        value = self.visit(tree.body, 0)
        return value if isinstance(value, Expression) else Expression(value)

    def visit(self, node: ast.AST, depth: int) -> Expression | float:
        self.nodes += 1
        if depth > MAX_DEPTH or self.nodes > MAX_NODES:
            raise self.fail(f"too large (at most {MAX_NODES} parts, {MAX_DEPTH} deep)")
        if isinstance(node, ast.Constant):
            return self.number(node.value)
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self.apply(
                _OPERATORS[type(node.op)],
                self.visit(node.left, depth + 1),
                self.visit(node.right, depth + 1),
            )
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
            value = self.visit(node.operand, depth + 1)
            return -value if isinstance(node.op, ast.USub) else value
        if (
            isinstance(node, ast.Compare)
            and len(node.ops) == 1
            and type(node.ops[0]) in _COMPARISONS
        ):
            return self.apply(
                _COMPARISONS[type(node.ops[0])],
                self.visit(node.left, depth + 1),
                self.visit(node.comparators[0], depth + 1),
            )
        if self.is_name(node):
            written = ast.get_source_segment(self.text.strip(), node) or ""
            return self.name("".join(written.split()))
        if isinstance(node, ast.Call):
            return self.call(node, depth)
        raise self.fail(
            f"{type(node).__name__} is not allowed; use numbers, names, + - * / **, "
            "comparisons and functions"
        )

    def number(self, value) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.fail(f"{value!r} is not a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise self.fail("a number is not finite")
        return number

    def apply(self, operate, a, b):
        try:
            value = operate(a, b)
        except ZeroDivisionError:
            raise self.fail("division by zero") from None
        except OverflowError:
            raise self.fail("a number is not finite") from None
        if isinstance(value, complex):
            raise self.fail("a root of a negative number")
        return value if isinstance(value, Expression) else float(value)

    def call(self, node: ast.Call, depth: int) -> Expression:
        if not isinstance(node.func, ast.Name) or node.func.id not in FORMULA_FUNCTIONS:
            name = ast.unparse(node.func)[:40]
            raise self.fail(unknown("function", name, FORMULA_FUNCTIONS))
        function, arity = FORMULA_FUNCTIONS[node.func.id]
        if node.keywords or len(node.args) != arity:
            raise self.fail(f"{node.func.id} takes {arity} argument(s), got {len(node.args)}")
        return function(*(self.visit(a, depth + 1) for a in node.args))

    def is_name(self, node: ast.AST) -> bool:
        """A plain name, or one with further parts after dots."""
        dotted = isinstance(node, ast.Name)
        while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call)):
            dotted |= isinstance(node, ast.Attribute)
            node = node.func if isinstance(node, ast.Call) else node.value
        if dotted and not isinstance(node, ast.Name):
            raise self.fail("a dotted name must be made of names only")
        return dotted

    def name(self, name: str) -> Expression | float:
        found = self.lookup(name)
        if found is not None:
            return found
        if name in CONSTANTS:
            return CONSTANTS[name]
        fault = self.fail(f"unknown name {name!r}{nearest(name, self.known())}")
        raise UnknownNameError(fault.message, name)
