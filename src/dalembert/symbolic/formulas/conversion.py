"""Conversion of numbers, texts and formulas to expressions."""

from __future__ import annotations

from typing import Any

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.checked import checked_expression
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.units.amounts import Amount
from dalembert.units.grammar import amount_of


def as_expression(value: Any, entity: str, unit: str | None = None, size: int = 1) -> Expression:
    """Check that ``value`` is a finite number or a formula of the right size and dimension.

    A text is a number with its unit, ``"45 mm"``, or a function of time, ``"10 deg + 45 rpm*t"``;
    formulas of parameters are written with the parameters themselves.

    Parameters
    ----------
    unit : of the number, or alternatives separated by ``|``; None for any dimension

    Raises
    ------
    ExpressionError
        Wrong type, wrong number of components, a unit that does not fit, NaN or infinity.
    """
    return checked_expression(value, entity, unit, size, _read)


def _read(text: str, entity: str) -> Amount | Expression | float:
    """The number in a text, with its unit, or the function of time."""
    try:
        return amount_of(text)
    except ExpressionError:
        pass
    try:
        return parse_formula(text, {"t": t}.get)
    except UnknownNameError as unknown:
        message = (
            f"expected a number or a formula, got {text!r:.60}; {unknown.name!r} is unknown: a "
            "text has numbers, units, t and functions, and formulas of parameters and measures are "
            "written without quotes"
        )
    except ExpressionError as fault:
        message = fault.message
    raise ExpressionError(message, entity)
