"""Validation of numbers and formulas: finite, of the right size and dimension."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.budget import numeral
from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.expression import (
    Dimensioned,
    Expression,
    as_sx,
    check_magnitude,
    splines_of,
)
from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of
from dalembert.units.unit import unit as unit_of


def _amount(text: str, entity: str) -> Amount | float:
    """The number, with its unit, in a text."""
    try:
        return amount_of(text)
    except UnknownNameError:
        message = f"expected a number, got {text!r:.60}; a text is a number with its unit"
        raise ExpressionError(message, entity) from None
    except ExpressionError as error:
        raise ExpressionError(error.message, entity) from None


def checked_expression(
    value: Any,
    entity: str,
    unit: str | None = None,
    size: int = 1,
    read: Callable[[str, str], Any] = _amount,
) -> Expression:
    """Check that ``value`` is a finite number or a formula of the right size and dimension.

    Parameters
    ----------
    unit : of the number, or alternatives separated by ``|``; None for any dimension
    read : ``(text, entity)`` → value of a text; by default a number with its unit

    Raises
    ------
    ExpressionError
        Wrong type, wrong number of components, a unit that does not fit, NaN or infinity.
    """
    if isinstance(value, str):
        value = read(value, entity)
    elif isinstance(value, (list, tuple)):
        value = [read(v, entity) if isinstance(v, str) else v for v in value]
    if isinstance(value, (bool, bytes)) or value is None:
        raise ExpressionError(
            f"expected {'a number' if size == 1 else f'{size} numbers'} or a formula, "
            f"got {value!r}",
            entity,
        )
    if unit is not None:
        for component in value if isinstance(value, list) else [value]:
            _check_unit(component, unit, entity)
    try:
        sx = as_sx(value)
    except OverflowError:
        raise ExpressionError(f"is {_first_huge(value)}, not a finite number", entity) from None
    except (TypeError, ValueError, NotImplementedError):
        raise ExpressionError(
            f"expected a number or a formula, got {type(value).__name__} {value!r}", entity
        ) from None
    if sx.numel() != size:
        raise ExpressionError(f"expected {size} component(s), got {sx.numel()}", entity)
    if size > 1 or not sx.is_dense():
        sx = ca.densify(ca.reshape(sx, size, 1))
    for component in ca.vertsplit(sx) if size > 1 else [sx]:
        if component.is_constant():
            check_magnitude(float(component), entity)
    if unit is None:
        unit = value.unit if isinstance(value, Expression) and sx.is_constant() else ""
    elif isinstance(value, Expression) and value.unit in unit.split(" | "):
        unit = value.unit
    name = value.name if isinstance(value, Expression) else ""
    return Expression(sx, name, unit, splines_of(value))


def _first_huge(value: Any) -> str:
    """The first integer too large for a float."""
    if isinstance(value, (list, tuple, np.ndarray)):
        texts = (_first_huge(item) for item in value)
        return next((text for text in texts if text), "")
    try:
        as_sx(value)
    except OverflowError:
        return numeral(value)
    except (TypeError, ValueError, NotImplementedError):
        pass
    return ""


def _check_unit(value: Any, unit: str, entity: str) -> None:
    """Check the unit of an amount or a parameter against the expected one."""
    if isinstance(value, Amount):
        check_unit(value.si, unit, entity, str(value))
        return
    if not isinstance(value, Expression) or not value.unit:
        return
    if value.is_parameter or (not value.name and value.sx.is_constant()):
        label = f"{value.name} [{value.unit}]" if value.name else f"{value.sx} {value.unit}"
        if isinstance(value, Dimensioned) and unit_of(value.unit).without_angle().fits(unit):
            return
        check_unit(value.unit, unit, entity, label)
