"""Formulas in text: an allow-listed grammar, parsed without ``eval``.

Numbers, numbers with units, names, ``+ - * / **``, comparisons, and functions. A name may be dotted
(``crank.end.x``), and its parts may have a number (``bars[3].stress``,
``plate.von_mises.max(0.1)``). Length, depth and node count are limited, so that a hostile file
cannot exhaust the machine.
"""

from __future__ import annotations

import ast
import math
import operator
import re
import warnings
from collections.abc import Callable, Mapping
from typing import Any

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.text.wording import nearest, unknown
from dalembert.units.amounts import Amount, with_names
from dalembert.units.dimensions import Dimension, dimension_of

MAX_LENGTH = 2000
MAX_DEPTH = 50
MAX_NODES = 1000
TERM = 0.4
"""Depth of a term of a sum, each of which stands one deeper than the next in the tree."""

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


Functions = Mapping[str, tuple[Callable[..., Any], int]]
OF_AMOUNTS = {"atan2", "interp", "hypot", "max", "min", "smooth_abs", "where"}
"""Functions of numbers that may have units."""
_OF_ONE = "sqrt sin cos tan asin acos atan sinh cosh tanh exp log floor".split()
PLAIN_FUNCTIONS: Functions = {
    **{name: (getattr(math, name), 1) for name in _OF_ONE},
    **{name: (getattr(math, name), 2) for name in ("atan2", "hypot")},
    "abs": (abs, 1),
    "min": (min, 2),
    "max": (max, 2),
}
"""Functions of texts that have numbers and units only."""


def amount_of(text: str) -> Amount | float:
    """The number behind a text without names, with its dimension where it has a unit.

    Raises
    ------
    ExpressionError
        A name, or a formula outside the grammar.
    """
    return Grammar(text, lambda name: None, list, PLAIN_FUNCTIONS).run()


def _goes_on(node: ast.BinOp) -> bool:
    """Whether it is a sum whose first term is one."""
    sums = (ast.Add, ast.Sub)
    left = node.left
    return isinstance(node.op, sums) and isinstance(left, ast.BinOp) and isinstance(left.op, sums)


class Grammar:
    """Reads one formula; what names and functions stand for, the caller says.

    Parameters
    ----------
    text : the formula, at most ``MAX_LENGTH`` characters
    lookup : gives what is behind a (dotted) name, or None
    known : gives the names to suggest from when one is unknown
    functions : name → (function, number of arguments)
    """

    def __init__(
        self,
        text: str,
        lookup: Callable[[str], Any],
        known: Callable[[], list[str]],
        functions: Functions,
    ):
        self.text, self.lookup, self.known, self.functions = text, lookup, known, functions
        self.amounts: dict[str, Amount] = {}
        self.numbers: dict[ast.AST, Amount | float] = {}
        self.names: dict[str, Any] = {}
        self.dimension: Dimension = None
        self.nodes = 0

    def fail(self, message: str) -> ExpressionError:
        shown = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return ExpressionError(f"in formula {shown!r}: {message}")

    def run(self) -> Any:
        """A number, an amount, or what names and functions make of them.

        Raises
        ------
        ExpressionError
            With the text, the place and a cure; ``UnknownNameError`` where a name is unknown.
        """
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
            self.formula, self.amounts = with_names(text.strip(), self.is_known)
        except ExpressionError as error:
            raise self.fail(error.message) from None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SyntaxWarning)
                tree = ast.parse(self.formula, mode="eval")
        except SyntaxError as error:
            raise self.fail(f"syntax error at column {error.offset}: {error.msg}") from None
        except (ValueError, RecursionError, MemoryError):
            raise self.fail("it cannot be read as a formula") from None
        value = self.visit(tree.body, 0)
        try:
            self.dimension = dimension_of(tree.body, self)
        except ExpressionError as error:
            raise self.fail(error.message) from None
        return value

    def shown(self, node: ast.AST) -> str:
        """The text of a part."""
        written = ast.get_source_segment(self.formula, node) or ""
        for name, amount in self.amounts.items():
            told = f"{amount.value / amount.unit.factor:g} {amount.unit.text}"
            written = re.sub(rf"\b{name}\b", told, written)
        return written

    def behind(self, node: ast.AST) -> Any:
        """What stands behind a name."""
        return self.names.get(self.spelled(node))

    def is_known(self, name: str) -> bool:
        """Whether something has this name, allowed here or not."""
        try:
            return self.lookup(name) is not None
        except ExpressionError:
            return True

    def visit(self, node: ast.AST, depth: float) -> Any:
        value = self.evaluated(node, depth)
        if isinstance(value, (Amount, float)):
            self.numbers[node] = value
        return value

    def evaluated(self, node: ast.AST, depth: float) -> Any:
        self.nodes += 1
        if depth > MAX_DEPTH or self.nodes > MAX_NODES:
            raise self.fail(f"too large (at most {MAX_NODES} parts, {MAX_DEPTH} deep)")
        if isinstance(node, ast.Constant):
            return self.number(node.value)
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self.apply(
                _OPERATORS[type(node.op)],
                self.visit(node.left, depth + (TERM if _goes_on(node) else 1)),
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
            return self.name(self.spelled(node))
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
        except ExpressionError as error:
            raise self.fail(error.message) from None
        except TypeError:
            raise self.fail("numbers with units, and tables, have no such operation") from None
        if isinstance(value, complex):
            raise self.fail("a root of a negative number")
        return float(value) if isinstance(value, (bool, int, float)) else value

    def call(self, node: ast.Call, depth: float) -> Any:
        if not isinstance(node.func, ast.Name) or node.func.id not in self.functions:
            name = ast.unparse(node.func)[:40]
            raise self.fail(unknown("function", name, self.functions))
        function, arity = self.functions[node.func.id]
        if node.keywords or len(node.args) != arity:
            raise self.fail(f"{node.func.id} takes {arity} argument(s), got {len(node.args)}")
        given = [self.visit(a, depth + 1) for a in node.args]
        for value in given:
            if isinstance(value, Amount) and node.func.id not in OF_AMOUNTS and not value.is_plain:
                raise self.fail(f"{node.func.id} takes a plain number or an angle, got {value}")
        try:
            return function(*given)
        except ExpressionError as error:
            raise self.fail(str(error)) from None
        except (ValueError, OverflowError):
            raise self.fail(f"{node.func.id} has no value there") from None

    def is_name(self, node: ast.AST) -> bool:
        """A plain name, or one with further parts after dots."""
        dotted = isinstance(node, ast.Name)
        while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call)):
            dotted |= isinstance(node, ast.Attribute)
            node = node.func if isinstance(node, ast.Call) else node.value
        if dotted and not isinstance(node, ast.Name):
            raise self.fail("a dotted name must be made of names only")
        return dotted

    def spelled(self, node: ast.AST) -> str:
        """A name without spaces."""
        return "".join((ast.get_source_segment(self.formula, node) or "").split())

    def name(self, name: str) -> Any:
        if name in self.amounts:
            return self.amounts[name]
        found = self.lookup(name)
        if found is not None:
            self.names[name] = found
            return found
        if name in CONSTANTS:
            return CONSTANTS[name]
        fault = self.fail(f"unknown name {name!r}{nearest(name, self.known())}")
        raise UnknownNameError(fault.message, name)
