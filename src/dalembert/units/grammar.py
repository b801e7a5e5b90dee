"""Formulas in text: an allow-listed grammar, parsed without ``eval``.

Numbers, numbers with units, names, ``+ - * / **``, comparisons, and functions. A name may be dotted
(``crank.end.x``), and its parts may have an index or an argument (``bars[3].stress``,
``plate.von_mises.max(0.1)``). Length, depth and node count are limited to bound memory and time.
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
from dalembert.remedies import Advice, remedies_in
from dalembert.text.wording import misspelt, unknown
from dalembert.units.amounts import Amount, with_names
from dalembert.units.dimensions import Dimension, dimension_of

MAX_LENGTH = 2000
MAX_DEPTH = 50
MAX_NODES = 1000
TERM = 0.4
"""Weight of a term of a sum in the depth; the tree nests each term one deeper than the next."""

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
"""Functions whose arguments may have units."""
_OF_ONE = "sqrt sin cos tan asin acos atan sinh cosh tanh exp log floor".split()
PLAIN_FUNCTIONS: Functions = {
    **{name: (getattr(math, name), 1) for name in _OF_ONE},
    **{name: (getattr(math, name), 2) for name in ("atan2", "hypot")},
    "abs": (abs, 1),
    "min": (min, 2),
    "max": (max, 2),
}
"""Functions of formulas without names."""


def amount_of(text: str) -> Amount | float:
    """The value of a formula without names, with its dimension if it has a unit.

    Raises
    ------
    ExpressionError
        A name, or a formula outside the grammar.
    """
    return Grammar(text, lambda name: None, list, PLAIN_FUNCTIONS).run()


def _continues_sum(node: ast.BinOp) -> bool:
    """Whether a node is a sum whose first term is a sum."""
    sums = (ast.Add, ast.Sub)
    first = node.left
    return isinstance(node.op, sums) and isinstance(first, ast.BinOp) and isinstance(first.op, sums)


class Grammar:
    """Parser of one formula; the caller supplies names and functions.

    Parameters
    ----------
    text : the formula, at most ``MAX_LENGTH`` characters
    lookup : (dotted) name → value, or None
    known : returns the names to suggest from when one is unknown
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
        text = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return ExpressionError(Advice(f"in formula {text!r}: {message}", remedies_in(message)))

    def run(self) -> Any:
        """The value of the formula: a number, an amount, or the result of names and functions.

        Raises
        ------
        ExpressionError
            Quotes the formula and names a fix; ``UnknownNameError`` for an unknown name.
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
            raise self.fail(self.syntax_error(error)) from None
        except (ValueError, RecursionError, MemoryError):
            raise self.fail("it cannot be read as a formula") from None
        value = self.visit(tree.body, 0)
        try:
            self.dimension = dimension_of(tree.body, self)
        except ExpressionError as error:
            raise self.fail(error.message) from None
        return value

    def source(self, node: ast.AST) -> str:
        """The text of a part."""
        return self.as_written(ast.get_source_segment(self.formula, node) or "")

    def syntax_error(self, error: SyntaxError) -> str:
        """Message about a formula that is no expression: what is wrong, and at which part."""
        rest = self.formula[error.offset - 1 :] if error.offset else ""
        if not rest.strip():
            return (
                f"syntax error: the formula ends with {self.formula.rstrip()[-1:]!r}; complete it"
            )
        reason = "" if error.msg == "invalid syntax" else f": {error.msg}"
        return f"syntax error at {self.as_written(rest)!r}{reason}"

    def as_written(self, source: str) -> str:
        """A part of the formula with its numbers with units in place of their names."""
        for name, amount in self.amounts.items():
            original = f"{amount.value / amount.unit.factor:g} {amount.unit.text}"
            source = re.sub(rf"\b{name}\b", original, source)
        return source

    def value_of(self, node: ast.AST) -> Any:
        """The value of a name."""
        return self.names.get(self.spelled(node))

    def is_known(self, name: str) -> bool:
        """Whether the name exists, allowed here or not."""
        try:
            return self.lookup(name) is not None
        except ExpressionError:
            return True

    def visit(self, node: ast.AST, depth: float) -> Any:
        value = self.evaluate(node, depth)
        if isinstance(value, (Amount, float)):
            self.numbers[node] = value
        return value

    def evaluate(self, node: ast.AST, depth: float) -> Any:
        self.nodes += 1
        if depth > MAX_DEPTH or self.nodes > MAX_NODES:
            raise self.fail(f"too large (at most {MAX_NODES} parts, {MAX_DEPTH} deep)")
        if isinstance(node, ast.Constant):
            return self.number(node.value)
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self.apply(
                _OPERATORS[type(node.op)],
                self.visit(node.left, depth + (TERM if _continues_sum(node) else 1)),
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
        if isinstance(node, ast.Tuple):
            raise self.fail("a comma separates arguments; write decimals with a point")
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
        arguments = [self.visit(a, depth + 1) for a in node.args]
        for value in arguments:
            if isinstance(value, Amount) and node.func.id not in OF_AMOUNTS and not value.is_plain:
                raise self.fail(f"{node.func.id} takes a plain number or an angle, got {value}")
        try:
            return function(*arguments)
        except ExpressionError as error:
            raise self.fail(error.message) from None
        except (ValueError, OverflowError):
            raise self.fail(f"{node.func.id} has no value there") from None

    def is_name(self, node: ast.AST) -> bool:
        """Whether a node is a plain or dotted name."""
        dotted = isinstance(node, ast.Name)
        while isinstance(node, (ast.Attribute, ast.Subscript, ast.Call)):
            dotted |= isinstance(node, ast.Attribute)
            node = node.func if isinstance(node, ast.Call) else node.value
        if dotted and not isinstance(node, ast.Name):
            raise self.fail("a dotted name must consist of names only")
        return dotted

    def spelled(self, node: ast.AST) -> str:
        """The text of a name without spaces."""
        return "".join((ast.get_source_segment(self.formula, node) or "").split())

    def name(self, name: str) -> Any:
        if name in self.amounts:
            return self.amounts[name]
        value = self.lookup(name)
        if value is not None:
            self.names[name] = value
            return value
        if name in CONSTANTS:
            return CONSTANTS[name]
        fault = self.fail(misspelt(f"unknown name {name!r}", name, self.known(), ""))
        raise UnknownNameError(fault.message, name)
