"""Dimensions of formulas: what is added or compared is of one kind, where kinds are known.

Names with units and numbers with units are known. A plain number is SI of any kind, ``2*x`` may be
a force, so that nothing is known of its products, and it is added to anything.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Any, Protocol

from dalembert.errors import ExpressionError
from dalembert.units.amounts import Amount
from dalembert.units.unit import si_unit, unit

Dimension = Mapping[str, float] | None
"""Exponents of kg, m, s, …; None where it is not known."""

VERBS: dict[type, str] = {ast.Add: "added", ast.Sub: "subtracted"}
ALIKE = ("abs", "min", "max", "hypot", "smooth_abs")
"""Functions of arguments of one kind, of which their result is as well."""
ANGLES = ("asin", "acos", "atan", "atan2")


class Formula(Protocol):
    """A formula that was read."""

    numbers: dict[ast.AST, Amount | float]
    """Parts without names."""

    def shown(self, node: ast.AST) -> str:
        """The text of a part."""

    def is_name(self, node: ast.AST) -> bool:
        """Whether a part is a name, dots included."""

    def behind(self, node: ast.AST) -> Any:
        """What stands behind a name."""


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
        return known_dimension(getattr(formula.behind(node), "unit", ""))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return _function(node.func.id, node.args, formula)
    return None


def known_dimension(text: str) -> Dimension:
    """The dimension of a unit; None of none, and of what is no unit, such as ``N or N m``."""
    try:
        return unit(text).dimension if text else None
    except ExpressionError:
        return None


def _combined(node: ast.BinOp, formula: Formula) -> Dimension:
    if type(node.op) in VERBS:
        return _alike(VERBS[type(node.op)], [node.left, node.right], formula)
    left, right = dimension_of(node.left, formula), dimension_of(node.right, formula)
    if left is None:
        return None
    if isinstance(node.op, ast.Pow):
        power = formula.numbers.get(node.right)
        return _raised(left, power) if isinstance(power, float) else None
    if right is None:
        return None
    sign = 1 if isinstance(node.op, ast.Mult) else -1
    return {b: left.get(b, 0) + sign * right.get(b, 0) for b in {**left, **right}}


def _function(name: str, arguments: list[ast.expr], formula: Formula) -> Dimension:
    if name == "where":
        dimension_of(arguments[0], formula)
        return _alike("chosen between", arguments[1:], formula)
    if name in ALIKE or name == "atan2":
        found = _alike("taken together", arguments, formula)
    elif name == "interp":
        dimension_of(arguments[0], formula)
        found = known_dimension(formula.behind(arguments[1]).units[1])
    else:
        (found,) = (dimension_of(one, formula) for one in arguments)
    if name in ANGLES:
        return {"rad": 1}
    if name == "sqrt" and found is not None:
        return _raised(found, 0.5)
    return found if name in (*ALIKE, "interp") else None


def _alike(verb: str, parts: list[ast.expr], formula: Formula) -> Dimension:
    """The common dimension of parts; None if one of them is not known."""
    found = [(part, dimension_of(part, formula)) for part in parts]
    known = [(part, one) for part, one in found if one is not None]
    for part, one in known[1:]:
        if _without_angle(one) != _without_angle(known[0][1]):
            first, second = (
                f"{formula.shown(p)} [{si_unit(d) or '1'}]" for p, d in (known[0], (part, one))
            )
            raise ExpressionError(
                f"{first} and {second} cannot be {verb}; a factor that leads from one to the other "
                "has a unit, as in 2 N/m*x"
            )
    return known[0][1] if len(known) == len(parts) else None


def _raised(dimension: Mapping[str, float], power: float) -> Dimension:
    return {base: n * power for base, n in dimension.items()}


def _without_angle(dimension: Mapping[str, float]) -> dict[str, float]:
    """Angles may be left out, as in the ``N m`` of a stiffness."""
    return {base: n for base, n in dimension.items() if n and base != "rad"}
