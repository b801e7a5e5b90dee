"""Scalar and vector expressions, accepted wherever a number is."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.budget import LARGEST
from dalembert.errors import ExpressionError

UFUNC_OPERATORS = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "true_divide": operator.truediv,
    "power": operator.pow,
    "less": operator.lt,
    "less_equal": operator.le,
    "greater": operator.gt,
    "greater_equal": operator.ge,
}
"""NumPy's name of an operator → operator."""
UFUNC_FUNCTIONS = {
    **{name: getattr(ca, name) for name in "sin cos tan sinh cosh tanh exp log sqrt".split()},
    **{f"arc{name}": getattr(ca, f"a{name}") for name in ("sin", "cos", "tan", "tan2")},
    "hypot": ca.hypot,
    "absolute": ca.fabs,
    "fabs": ca.fabs,
    "sign": ca.sign,
    "floor": ca.floor,
    "minimum": ca.fmin,
    "maximum": ca.fmax,
    "negative": operator.neg,
}
"""NumPy's name of a function → CasADi's function."""


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
    """Whether its unit is checked where a number of another dimension is expected."""

    def __init__(self, sx, name: str = "", unit: str = "", splines: tuple = ()):
        self.sx = sx if isinstance(sx, ca.SX) else ca.SX(sx)
        self.name = name
        self.unit = unit
        self.splines = splines

    def named(self, name: str, unit: str = "") -> Expression:
        """The same formula under a name and a unit."""
        return Expression(self.sx, name, unit, self.splines)

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        """One entry of an array of formulas; NumPy would split it into components."""
        entry = np.empty((), dtype=object)
        entry[()] = self
        return entry

    def __array_ufunc__(self, ufunc, method: str, *inputs, out=None, **options) -> Any:
        """NumPy's operators and functions, mapped to those of expressions and of CasADi."""
        operate = UFUNC_OPERATORS.get(ufunc.__name__)
        function = UFUNC_FUNCTIONS.get(ufunc.__name__)
        if method == "__call__" and not options:
            if operate is not None:
                return _binary(inputs[0], inputs[1], operate)
            if function is not None:
                return Expression(function(*(as_sx(value) for value in inputs)))
        supported = ", ".join(UFUNC_FUNCTIONS)
        raise ExpressionError(
            f"np.{ufunc.__name__} does not accept formulas; supported functions: {supported}",
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
            "a formula has no truth value before it is evaluated; use where(condition, a, b)",
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
    """A formula in text with units, from which its own unit follows."""

    __slots__ = ()
    is_parameter = True


def _binary(a, b, operate) -> Any:
    try:
        return Expression(operate(as_sx(a), as_sx(b)), splines=splines_of(a, b))
    except TypeError:  # the other operand, such as a law, may define the operation
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


def splines_of(*values: Any) -> tuple:
    """The splines of the tables that formulas evaluate."""
    return tuple(s for v in values if isinstance(v, Expression) for s in v.splines)


def check_magnitude(number: float, entity: str) -> None:
    """Check that a number is finite and that products and quotients do not overflow.

    Raises
    ------
    ExpressionError
        NaN, infinity, or a number outside the usable range; names the entity and the number.
    """
    if not math.isfinite(number):
        raise ExpressionError(f"{number} is not a finite number", entity)
    if number and not 1 / LARGEST <= abs(number) <= LARGEST:
        limits = f"{1 / LARGEST:g} to {LARGEST:g}"
        raise ExpressionError(
            f"{number:g} is out of range: products or quotients would overflow; numbers are 0 or "
            f"{limits} in size: check its unit",
            entity,
        )


t = Expression(ca.SX.sym("t"), "t", "s")
"""Time, usable in laws, forces and user constraints."""


def free_symbols(sx: ca.SX) -> set[str]:
    """Names of the symbols an expression depends on."""
    return set() if sx.is_constant() else {symbol.name() for symbol in ca.symvar(sx)}


def stack(columns: Iterable[ca.SX]) -> ca.SX:
    """Vertical concatenation; an empty result is a column, too."""
    columns = list(columns)
    return ca.densify(ca.vertcat(*columns)) if columns else ca.SX(0, 1)
