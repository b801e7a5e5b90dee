"""Scalar and vector expressions: what users write wherever a number is accepted."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.budget import LARGEST, numeral
from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.ufuncs import FUNCTIONS, OPERATORS
from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of
from dalembert.units.unit import unit as unit_of


class Expression:
    """A formula of parameters, time and measures, differentiable to any order.

    Parameters
    ----------
    sx : casadi.SX
        Column of scalar expressions.
    name, unit : str
        Labels used in results; arithmetic drops them.
    splines : tuple
        Splines of the tables that the formula evaluates; arithmetic keeps them.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lever")
    >>> length = system.parameter("length", 0.5, "m")
    >>> bar = system.add(planar.Bar("bar", length=length))
    >>> reach = 2 * length * da.cos(bar.angle) + 0.1  # formulas of parameters, measures and da.t
    >>> isinstance(reach, da.Expression), bar.angle.name, bar.angle.unit
    (True, 'bar.angle', 'rad')
    >>> float(da.Expression(2.0) ** 3)
    8.0
    """

    __slots__ = ("name", "splines", "sx", "unit")
    is_parameter = False
    """Its unit is known, and is checked where a number of another dimension is expected."""

    def __init__(self, sx, name: str = "", unit: str = "", splines: tuple = ()):
        self.sx = ca.SX(sx)
        self.name = name
        self.unit = unit
        self.splines = splines

    def named(self, name: str, unit: str = "") -> Expression:
        """The same formula under a name and a unit."""
        return Expression(self.sx, name, unit, self.splines)

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        """One entry of an array of formulas; NumPy would take its components apart."""
        found = np.empty((), dtype=object)
        found[()] = self
        return found

    def __array_ufunc__(self, ufunc, method: str, *inputs, out=None, **options) -> Any:
        """NumPy's operators are those below; its functions are those of CasADi."""
        operate, function = OPERATORS.get(ufunc.__name__), FUNCTIONS.get(ufunc.__name__)
        if method == "__call__" and not options:
            if operate is not None:
                return _binary(inputs[0], inputs[1], operate)
            if function is not None:
                return Expression(function(*(as_sx(one) for one in inputs)))
        known = ", ".join(FUNCTIONS)
        raise ExpressionError(
            f"np.{ufunc.__name__} takes numbers and no formulas; known of formulas: {known}",
            self.name or None,
        )

    # components of a vector ------------------------------------------------
    def __len__(self) -> int:
        return self.sx.numel()

    def __getitem__(self, index: int) -> Expression:
        if not -len(self) <= index < len(self):
            raise IndexError(f"{self.name or 'expression'} has {len(self)} component(s)")
        return self.component(index, "xyz"[index] if len(self) <= 3 else str(index))

    def component(self, index: int, label: str) -> Expression:
        name = f"{self.name}.{label}" if self.name else ""
        return Expression(self.sx[index], name, self.unit, self.splines)

    @property
    def x(self) -> Expression:
        """First component of a vector."""
        return self[0]

    @property
    def y(self) -> Expression:
        """Second component of a vector."""
        return self[1]

    # arithmetic --------------------------------------------------------------
    def __add__(self, other):
        return _binary(self, other, lambda a, b: a + b)

    def __radd__(self, other):
        return _binary(other, self, lambda a, b: a + b)

    def __sub__(self, other):
        return _binary(self, other, lambda a, b: a - b)

    def __rsub__(self, other):
        return _binary(other, self, lambda a, b: a - b)

    def __mul__(self, other):
        return _binary(self, other, lambda a, b: a * b)

    def __rmul__(self, other):
        return _binary(other, self, lambda a, b: a * b)

    def __truediv__(self, other):
        return _binary(self, other, lambda a, b: a / b)

    def __rtruediv__(self, other):
        return _binary(other, self, lambda a, b: a / b)

    def __pow__(self, other):
        return _binary(self, other, lambda a, b: a**b)

    def __rpow__(self, other):
        return _binary(other, self, lambda a, b: a**b)

    def __neg__(self):
        return Expression(-self.sx, splines=self.splines)

    def __pos__(self):
        return self

    def __abs__(self):
        return Expression(ca.fabs(self.sx))

    # comparisons give 0/1 expressions for `where` ------------------------------
    def __lt__(self, other):
        return _binary(self, other, lambda a, b: a < b)

    def __le__(self, other):
        return _binary(self, other, lambda a, b: a <= b)

    def __gt__(self, other):
        return _binary(self, other, lambda a, b: a > b)

    def __ge__(self, other):
        return _binary(self, other, lambda a, b: a >= b)

    def __bool__(self):
        raise ExpressionError(
            "whether a formula is true is not known before a run; use where(condition, a, b)",
            self.name or None,
        )

    def __float__(self) -> float:
        if self.sx.numel() == 1 and self.sx.is_constant():
            return float(self.sx)
        raise ExpressionError(
            "this formula is not a constant number; functions of formulas are da.sin, da.sqrt, …, "
            "those of math take numbers only",
            self.name or None,
        )

    def __repr__(self) -> str:
        label = f"{self.name} = " if self.name else ""
        return f"<{label}{str(self.sx)[:80]}{' ' + self.unit if self.unit else ''}>"


class Dimensioned(Expression):
    """A formula in text whose parts have units, from which its own follows."""

    __slots__ = ()
    is_parameter = True


def _binary(a, b, operate) -> Any:
    try:
        return Expression(operate(as_sx(a), as_sx(b)), splines=splines_of(a, b))
    except TypeError:  # what is no formula, such as a law, may know how
        return NotImplemented


def as_sx(value) -> ca.SX:
    """CasADi form of a number, a sequence of numbers or an expression."""
    if isinstance(value, Expression):
        return value.sx
    if isinstance(value, ca.SX):
        return value
    if isinstance(value, (list, tuple, np.ndarray)):
        return ca.vertcat(*(as_sx(item) for item in value))
    return ca.SX(float(value))


def as_expression(value, entity: str, unit: str | None = None, size: int = 1) -> Expression:
    """Check that ``value`` is a finite number or a formula of the right size and dimension.

    A text is a number with its unit, ``"45 mm"``, or a function of time, ``"10 deg + 45 rpm*t"``;
    formulas of parameters are written with the parameters themselves.

    Parameters
    ----------
    unit : of the number, or units with ``|`` between; None where any dimension may stand

    Raises
    ------
    ExpressionError
        Wrong type, wrong number of components, a unit that does not fit, NaN or infinity.
    """
    if isinstance(value, str):
        value = _read(value, entity)
    elif isinstance(value, (list, tuple)):
        value = [_read(v, entity) if isinstance(v, str) else v for v in value]
    if isinstance(value, (bool, bytes)) or value is None:
        raise ExpressionError(
            f"expected {'a number' if size == 1 else f'{size} numbers'} or a formula, "
            f"got {value!r}",
            entity,
        )
    if unit is not None:
        for one in value if isinstance(value, list) else [value]:
            _check_unit(one, unit, entity)
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
    sx = ca.densify(ca.reshape(sx, size, 1))
    for i in range(size):
        if sx[i].is_constant():
            refuse_unusable(float(sx[i]), entity)
    if unit is None:
        unit = value.unit if isinstance(value, Expression) and sx.is_constant() else ""
    name = value.name if isinstance(value, Expression) else ""
    return Expression(sx, name, unit, splines_of(value))


def splines_of(*values: Any) -> tuple:
    """The splines of tables from which formulas are made."""
    return tuple(s for v in values if isinstance(v, Expression) for s in v.splines)


def _first_huge(value: Any) -> str:
    """The first whole number that no float can hold."""
    if isinstance(value, (list, tuple, np.ndarray)):
        told = (_first_huge(item) for item in value)
        return next((text for text in told if text), "")
    try:
        as_sx(value)
    except OverflowError:
        return numeral(value)
    except (TypeError, ValueError, NotImplementedError):
        pass
    return ""


def _read(text: str, entity: str) -> Amount | Expression | float:
    """The number in a text, with its unit, or the function of time."""
    from dalembert.symbolic.formulas.parser import parse_formula  # which makes expressions

    try:
        return amount_of(text)
    except ExpressionError:
        pass
    try:
        return parse_formula(text, {"t": t}.get)
    except UnknownNameError as unknown:
        told = (
            f"expected a number or a formula, got {text!r:.60}; {unknown.name!r} is unknown: a "
            "text has numbers, units, t and functions, and formulas of parameters and measures are "
            "written without quotes"
        )
    except ExpressionError as fault:
        told = fault.message
    raise ExpressionError(told, entity)


def _check_unit(value: Any, unit: str, entity: str) -> None:
    """What is known to have a unit has one that fits: an amount, or a parameter."""
    if isinstance(value, Amount):
        check_unit(value.si, unit, entity, str(value))
        return
    if not isinstance(value, Expression) or not value.unit:
        return
    if value.is_parameter or (not value.name and value.sx.is_constant()):
        shown = f"{value.name} [{value.unit}]" if value.name else f"{value.sx} {value.unit}"
        if isinstance(value, Dimensioned) and unit_of(value.unit).without_angle().fits(unit):
            return
        check_unit(value.unit, unit, entity, shown)


def refuse_unusable(number: float, entity: str) -> None:
    """NaN, infinity, and numbers whose products or quotients overflow.

    Raises
    ------
    ExpressionError
        Names the entity and the number.
    """
    if not math.isfinite(number):
        raise ExpressionError(f"{number} is not a finite number", entity)
    if number and not 1 / LARGEST <= abs(number) <= LARGEST:
        reach = f"{1 / LARGEST:g} to {LARGEST:g}"
        raise ExpressionError(
            f"{number:g} is no number to compute with, products or quotients overflow; numbers "
            f"are 0 or {reach} in size: check its unit",
            entity,
        )


t = Expression(ca.SX.sym("t"), "t", "s")
"""Time, usable in laws, forces and user constraints."""


def free_symbols(sx: ca.SX) -> set[str]:
    """Names of the symbols an expression depends on."""
    return set() if sx.is_constant() else {symbol.name() for symbol in ca.symvar(sx)}


def stack(columns: Iterable[ca.SX]) -> ca.SX:
    """Vertical concatenation that keeps an empty result a column."""
    columns = list(columns)
    return ca.densify(ca.vertcat(*columns)) if columns else ca.SX(0, 1)
