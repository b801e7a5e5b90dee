"""Formulas in text, as expressions; the grammar is that of :mod:`dalembert.grammar`, with the
functions of :mod:`dalembert.symbolic.functions`.
"""

from __future__ import annotations

from collections.abc import Callable

from dalembert.amounts import Amount
from dalembert.errors import ExpressionError
from dalembert.grammar import Grammar
from dalembert.symbolic.expression import Expression
from dalembert.symbolic.functions import FORMULA_FUNCTIONS
from dalembert.symbolic.interpolation import Interpolation, interp

FUNCTIONS = {**FORMULA_FUNCTIONS, "interp": (interp, 2)}
"""Functions of formulas."""


def parse_formula(
    text: str, lookup: Callable[[str], Expression | None], known: Callable[[], list[str]] = list
) -> Expression:
    """Turn the text of a formula into an expression.

    Parameters
    ----------
    text : str
        The formula; a text of numbers and units alone has their dimension as its unit.
    lookup : callable
        Gives the expression behind a (dotted) name, or None.
    known : callable, optional
        Gives the names to suggest from when one is unknown.

    Raises
    ------
    ExpressionError
        With the text, the place and a cure; ``UnknownNameError`` where a name is unknown.
    """
    value = Grammar(text, lookup, known, FUNCTIONS).run()
    if isinstance(value, Amount):
        return Expression(value.value, "", value.si)
    if isinstance(value, Interpolation):
        raise ExpressionError(
            f"in formula {text[:60]!r}: a table is no number; write interp(x, {value.name})"
        )
    return value if isinstance(value, Expression) else Expression(value)
