"""Formulas in text, as expressions; the grammar is that of :mod:`dalembert.units.grammar`, with the
functions of :mod:`dalembert.symbolic.formulas.functions`.
"""

from __future__ import annotations

from collections.abc import Callable

from dalembert.errors import ExpressionError
from dalembert.symbolic.formulas.expression import Dimensioned, Expression
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS
from dalembert.symbolic.formulas.interpolation import Interpolation, interp
from dalembert.units.amounts import Amount
from dalembert.units.grammar import Grammar
from dalembert.units.unit import MOST_POWER, si_unit

FUNCTIONS = {**FORMULA_FUNCTIONS, "interp": (interp, 2)}
"""Functions of formulas."""


def parse_formula(
    text: str, lookup: Callable[[str], Expression | None], known: Callable[[], list[str]] = list
) -> Expression:
    """Turn the text of a formula into an expression.

    Parameters
    ----------
    text : str
        The formula; its unit is that of its dimension, where that is known.
    lookup : callable
        Gives the expression behind a (dotted) name, or None.
    known : callable, optional
        Gives the names to suggest from when one is unknown.

    Raises
    ------
    ExpressionError
        With the text, the place and a cure; ``UnknownNameError`` where a name is unknown.
    """
    grammar = Grammar(text, lookup, known, FUNCTIONS)
    value = grammar.run()
    if isinstance(value, Amount):
        return Expression(value.value, "", value.si)
    if isinstance(value, Interpolation):
        raise ExpressionError(
            f"in formula {text[:60]!r}: a table is no number; write interp(x, {value.name})"
        )
    made = value if isinstance(value, Expression) else Expression(value)
    kind = grammar.dimension
    if kind is None or made.unit or any(abs(n) > MOST_POWER for n in kind.values()):
        return made
    if not grammar.amounts:  # such as -body.vx, which stands for a force of 1 N s/m, too
        return Expression(made.sx, made.name, si_unit(kind))
    return Dimensioned(made.sx, text.strip()[:60], si_unit(kind))
