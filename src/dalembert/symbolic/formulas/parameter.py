"""Parameters: numbers that may change between runs without rebuilding the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from dalembert.budget import numeral
from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.expression import Expression, check_magnitude
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import plain_text, unknown
from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of
from dalembert.units.unit import Unit, unit

Bounds = tuple[float | str | None, float | str | None] | None
"""Lower and upper bound; None for no bound."""


class Parameter(CheckedArguments, Expression):
    """A named number with unit, bounds and description.

    Parameters
    ----------
    name : str
        Identifier, usable in formulas.
    value : float or str
        Nominal value, in ``unit``, or a text such as ``"45 mm"``.
    unit : str
        Unit of value and bounds, ``"mm"``, ``"deg"``, ``"rpm"``; SI units by default.
    bounds : (float or str, float or str), optional
        Lower and upper bound for design; None for no bound.
    description : str
        Shown in results and reports.

    Attributes
    ----------
    value, bounds : in SI units
    unit : their SI unit
    declared_unit : the unit of the arguments, used for output

    Raises
    ------
    ModelError
        A name that is not an identifier, a value not finite or outside its bounds, bounds in the
        wrong order, an unknown unit.

    Examples
    --------
    >>> import dalembert as da
    >>> crank = da.System("press").parameter("crank", 45, unit="mm", bounds=(30, "6 cm"))
    >>> isinstance(crank, da.Parameter), crank.value, crank.unit, crank.declared_unit
    (True, 0.045, 'm', 'mm')
    """

    __slots__ = ("bounds", "declared_unit", "description", "value")
    is_parameter = True
    role = "parameter"

    def __repr__(self) -> str:
        return f"<Parameter {self.name!r} = {self.value:.6g}{' ' + self.unit if self.unit else ''}>"

    def __init__(
        self,
        name: str,
        value: float | str,
        unit: str = "",
        bounds: Bounds = None,
        description: str = "",
    ):
        if not isinstance(name, str) or not name.isidentifier():
            raise ModelError(
                f"{name!r} is not an identifier; use letters, digits and '_'", "parameter"
            )
        self.declared_unit = plain_text(unit, f"{name}.unit") or _unit_in(value)
        si_unit = _unit(self.declared_unit, name)
        super().__init__(ca.SX.sym(name), name, si_unit.si)
        self.value = si_value(value, si_unit, name, "value")
        lower, upper = bounds if bounds is not None else (None, None)
        self.bounds = (
            -math.inf if lower is None else si_value(lower, si_unit, name, "lower bound", True),
            math.inf if upper is None else si_value(upper, si_unit, name, "upper bound", True),
        )
        self.description = plain_text(description, f"{name}.description")
        if math.isnan(self.bounds[0]) or math.isnan(self.bounds[1]):
            raise ModelError(f"bounds {bounds} contain NaN; give numbers", name)
        if self.bounds[0] > self.bounds[1]:
            raise ModelError(f"lower bound {lower} is above upper bound {upper}; swap them", name)
        if not self.bounds[0] <= self.value <= self.bounds[1]:
            raise ModelError(f"value {value} lies outside its bounds [{lower}, {upper}]", name)

    def in_si(self, value: float | str) -> float:
        """A value given in its unit, or a text with a unit, in SI units."""
        return si_value(value, _unit(self.declared_unit, self.name), self.name, "value")

    def in_declared_unit(self, value: float) -> float:
        """A value in SI units, converted to the unit of the parameter."""
        return value / _unit(self.declared_unit, self.name).factor


def _unit_in(value: Any) -> str:
    """The unit of a text, or an empty text."""
    if not isinstance(value, str):
        return ""
    try:
        amount = amount_of(value)
    except ExpressionError:  # raised where the value is read
        return ""
    return amount.unit.text if isinstance(amount, Amount) else ""


def _unit(text: str, name: str) -> Unit:
    try:
        return unit(text)
    except ExpressionError as error:
        raise ModelError(error.message, f"{name}.unit") from None


def coherent(text: str, name: str) -> str:
    """Check that the unit of a formula is an SI unit.

    Raises
    ------
    ModelError
        Another unit.
    """
    si_unit = _unit(plain_text(text, f"{name}.unit"), name)
    if si_unit.factor != 1.0:
        raise ModelError(
            f"a formula gives {si_unit.si}, not {text}; write unit = {si_unit.si!r}", name
        )
    return text


def si_value(
    value: float | str, si_unit: Unit, name: str, quantity: str, may_be_infinite: bool = False
) -> float:
    """A number of units, or a text with a unit of the same dimension, in SI units.

    Raises
    ------
    ModelError
        Not a finite number, or another dimension.
    """
    if isinstance(value, str):
        try:
            amount = amount_of(value)
            if isinstance(amount, Amount):
                check_unit(amount.si, si_unit.text, name, repr(value))
                return _finite(amount.value, name, quantity)
        except ExpressionError as error:
            raise ModelError(f"{quantity}: {error.message}", name) from None
        value = amount
    if may_be_infinite and isinstance(value, float) and not math.isfinite(value):
        return value
    return _finite(_finite(value, name, quantity) * si_unit.factor, name, quantity)


def _finite(value, name: str, quantity: str) -> float:
    try:
        number = float(value)
    except OverflowError:
        raise ModelError(f"{quantity} {numeral(value)} is not a finite number", name) from None
    except (TypeError, ValueError):
        raise ModelError(f"{quantity} {value!r} is not a number", name) from None
    if isinstance(value, bool) or not math.isfinite(number):
        raise ModelError(f"{quantity} {value} is not a finite number", name)
    check_magnitude(number, name)
    return number


def parameter_vector(
    parameters: Mapping[str, Parameter], replaced: Mapping[str, float | str] | None, owner: str
) -> np.ndarray:
    """Values of all parameters, some of them replaced.

    Raises
    ------
    ModelError
        Unknown parameter or a value that is not finite; names the owner or the parameter.
    """
    values = {name: parameter.value for name, parameter in parameters.items()}
    for name, value in (replaced or {}).items():
        if name not in values:
            raise ModelError(unknown("parameter", name, values), owner)
        parameter_of_name = parameters[name]
        values[name] = (
            parameter_of_name.in_si(value)
            if isinstance(value, str)
            else _finite(value, name, "value")
        )
    return np.array(list(values.values()), dtype=float)
