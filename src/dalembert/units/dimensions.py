"""Dimensional analysis of formulas: terms of sums and comparisons have the same dimension.

Names and numbers with units have a dimension. A plain number stands for an SI quantity of any
dimension: ``2*x`` may be a force, so products with it are unknown, and it can be added to anything.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Any, Protocol

from dalembert.errors import ExpressionError
from dalembert.units.amounts import Amount
from dalembert.units.unit import si_unit, unit

Dimension = Mapping[str, float] | None
"""Exponents of kg, m, s, …; None if unknown."""

VERBS: dict[type, str] = {ast.Add: "added", ast.Sub: "subtracted"}
ALIKE = ("abs", "min", "max", "hypot", "smooth_abs")
"""Functions whose arguments and result have the same dimension."""
ANGLES = ("asin", "acos", "atan", "atan2")


class Formula(Protocol):
    """A parsed formula."""

    numbers: dict[ast.AST, Amount | float]
    """Values of the parts without names."""

    def source(self, node: ast.AST) -> str:
        """The text of a part."""

    def is_name(self, node: ast.AST) -> bool:
        """Whether a part is a name, dots included."""

    def value_of(self, node: ast.AST) -> Any:
        """The value of a name."""


def dimension_of(node: ast.AST, formula: Formula) -> Dimension:
    """The dimension of a part of a formula.

    Raises
    ------
    ExpressionError
        Quantities of different kinds are added or compared.
    """
    if node in formula.numbers:
        number = formula.numbers[node]
        return number.unit.dimension if isinstance(number, Amount) else None
    if isinstance(node, ast.UnaryOp):
        return dimension_of(node.operand, formula)
    if isinstance(node, ast.BinOp):
        return _combined(node, formula)
    if isinstance(node, ast.Compare):
        _alike("compared", [node.left, node.comparators[0]], formula)
        return {}
    if formula.is_name(node):
        return dimension_of_unit(getattr(formula.value_of(node), "unit", ""))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return _function(node.func.id, node.args, formula)
    return None


def dimension_of_unit(text: str) -> Dimension:
    """The dimension of a unit; None without one, and for texts such as ``N or N m``."""
    try:
        return unit(text).dimension if text else None
    except ExpressionError:
        return None


def _combined(node: ast.BinOp, formula: Formula) -> Dimension:
    if type(node.op) in VERBS:
        return _alike(VERBS[type(node.op)], [node.left, node.right], formula)
    first, second = dimension_of(node.left, formula), dimension_of(node.right, formula)
    if first is None:
        return None
    if isinstance(node.op, ast.Pow):
        power = formula.numbers.get(node.right)
        return _raised(first, power) if isinstance(power, float) else None
    if second is None:
        return None
    sign = 1 if isinstance(node.op, ast.Mult) else -1
    return {b: first.get(b, 0) + sign * second.get(b, 0) for b in {**first, **second}}


def _function(name: str, arguments: list[ast.expr], formula: Formula) -> Dimension:
    if name == "where":
        dimension_of(arguments[0], formula)
        return _alike("chosen between", arguments[1:], formula)
    if name in ALIKE or name == "atan2":
        dimension = _alike("taken together", arguments, formula)
    elif name == "interp":
        dimension_of(arguments[0], formula)
        dimension = dimension_of_unit(formula.value_of(arguments[1]).units[1])
    else:
        (dimension,) = (dimension_of(argument, formula) for argument in arguments)
    if name in ANGLES:
        return {"rad": 1}
    if name == "sqrt" and dimension is not None:
        return _raised(dimension, 0.5)
    return dimension if name in (*ALIKE, "interp") else None


def _alike(verb: str, parts: list[ast.expr], formula: Formula) -> Dimension:
    """The common dimension of parts; None if that of one is unknown."""
    dimensions = [(part, dimension_of(part, formula)) for part in parts]
    known = [(part, dimension) for part, dimension in dimensions if dimension is not None]
    for part, dimension in known[1:]:
        if _without_angle(dimension) != _without_angle(known[0][1]):
            first, second = (
                f"{formula.source(p)} [{si_unit(d) or '1'}]"
                for p, d in (known[0], (part, dimension))
            )
            raise ExpressionError(
                f"{first} and {second} cannot be {verb}; a factor that leads from one to the other "
                "has a unit, as in 2 N/m*x"
            )
    return known[0][1] if len(known) == len(parts) else None


def _raised(dimension: Mapping[str, float], power: float) -> Dimension:
    return {base: n * power for base, n in dimension.items()}


def _without_angle(dimension: Mapping[str, float]) -> dict[str, float]:
    """The dimension without angles, which may be omitted, as in the ``N m`` of a stiffness."""
    return {base: n for base, n in dimension.items() if n and base != "rad"}
