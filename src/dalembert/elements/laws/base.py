"""Motion laws: functions of time with quantities, their sums and products."""

from __future__ import annotations

import functools
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import casadi as ca

from dalembert.elements.base import Condition, Scalar, option, quantity
from dalembert.elements.ingredient import Ingredient
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t


@dataclass(eq=False)
class Law(Ingredient):
    """Prescribed value ``f(t)``; differentiable twice for velocities and accelerations.

    Examples
    --------
    >>> import casadi as ca
    >>> import dalembert as da
    >>> lift = 0.5 * da.Harmonic(0.2, 3.0) + 0.1  # sums and products are laws
    >>> isinstance(lift, da.laws.Law)
    True
    >>> float(lift.value(ca.SX(0.0)))
    0.1
    """

    def value(self, time: ca.SX) -> ca.SX:
        """``f(t)`` as an expression."""
        raise NotImplementedError

    def splines(self) -> tuple:
        """Splines of the tables that it evaluates."""
        return ()

    def __add__(self, other: Any) -> Law:
        return Sum((self, other))

    def __radd__(self, other) -> Law:
        return Sum((other, self))

    def __sub__(self, other) -> Law:
        return self + -1.0 * other

    def __rsub__(self, other) -> Law:
        return other + -self

    def __mul__(self, other) -> Law:
        return Product((self, other))

    def __rmul__(self, other) -> Law:
        return Product((other, self))

    def __neg__(self) -> Law:
        return -1.0 * self

    __array_ufunc__ = None  # NumPy numbers defer to these operators


GivenLaw = Annotated[Any, Law]
"""A law, or a number or formula in ``t`` that is converted to one."""


@dataclass(eq=False)
class Formula(Law):
    """``f(t)`` as a formula in ``t`` and parameters.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("shaker")
    >>> table = system.add(planar.Body("table", mass=1.0, inertia=0.1))
    >>> rail = system.add(planar.Translational("rail", system.ground.center, table.center))
    >>> beat = da.Formula(0.1 * da.sin(da.t) * da.exp(-da.t))  # or the formula alone
    >>> drive = system.add(planar.CoordinateDriver("drive", table.center, beat))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> round(motion["table.vx"][0].item(), 6)
    0.1
    """

    formula: Scalar = quantity("1 | m | rad", "formula in t and parameters")

    def value(self, time: ca.SX) -> ca.SX:
        return ca.substitute(self.formula.sx, t.sx, time)

    def splines(self) -> tuple:
        return tuple(self.formula.splines)


@dataclass(eq=False)
class Combination(Law):
    """Several laws combined by an operator of the subclass."""

    laws: tuple[Law, ...]
    operate: ClassVar

    def __post_init__(self) -> None:
        name = type(self).__name__
        if not isinstance(self.laws, (list, tuple)) or not self.laws:
            raise ModelError(f"laws must be a list of at least one, got {self.laws!r:.60}", name)
        self.laws = tuple(as_law(law, f"{name}.laws[{k}]") for k, law in enumerate(self.laws))

    def value(self, time: ca.SX) -> ca.SX:
        return functools.reduce(self.operate, [law.value(time) for law in self.laws])

    def splines(self) -> tuple:
        return tuple(spline for law in self.laws for spline in law.splines())

    def conditions(self) -> list[Condition]:
        return [condition for law in self.laws for condition in law.conditions()]

    def checked_quantities(self, owner: str) -> list[tuple[str, Expression, Mapping]]:
        return [
            quantity
            for k, law in enumerate(self.laws)
            for quantity in law.checked_quantities(f"{owner}.laws[{k}]")
        ]


@dataclass(eq=False)
class Sum(Combination):
    """``f = f₁ + f₂ + …``; in Python also ``law + law``.

    Examples
    --------
    >>> import casadi as ca
    >>> import dalembert as da
    >>> stroke = da.CycloidalRise(height=0.05, duration=1.0) + da.Harmonic(0.001, 100.0)
    >>> type(stroke) is da.laws.Sum
    True
    >>> round(float(stroke.value(ca.SX(0.5)) - 0.001 * ca.sin(50.0)), 9)  # half the height
    0.025
    """

    laws: tuple[Law, ...] = option("laws, numbers or formulas in t")
    operate = staticmethod(operator.add)


@dataclass(eq=False)
class Product(Combination):
    """``f = f₁ · f₂ · …``; in Python also ``law * law``, ``2 * law``.

    Examples
    --------
    >>> import casadi as ca
    >>> import dalembert as da
    >>> burst = da.Harmonic(1.0, 50.0, phase="90 deg") * da.Formula(da.exp(-da.t))
    >>> type(burst) is da.laws.Product
    True
    >>> float(burst.value(ca.SX(0.0)))
    1.0
    """

    laws: tuple[Law, ...] = option("laws, numbers or formulas in t")
    operate = staticmethod(operator.mul)


def as_law(value, entity: str, unit: str | None = None) -> Law:
    """A law, or the law of a number or formula in ``t`` with a ``unit``."""
    if isinstance(value, Law):
        return value
    return Formula(as_expression(value, entity, unit))
