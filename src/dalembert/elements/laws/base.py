"""Motion laws: functions of time, their sums and products, polynomials and harmonics."""

from __future__ import annotations

import functools
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import casadi as ca

from dalembert.elements.base import Condition, Scalar, option, quantity
from dalembert.elements.component import Component
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t


@dataclass(eq=False)
class Law(Component):
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
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, table.center))
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


@dataclass(eq=False)
class Polynomial(Law):
    """``f = ½ α t² + ω t + φ0`` (1.28).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("run-up")
    >>> crank = system.add(planar.Bar("crank", length=0.2))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> law = da.Polynomial(velocity="30 rpm", acceleration=2.0)
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["crank.angular_velocity"].values.round(6)  # π and 2 more
    array([3.141593, 5.141593])
    """

    start: Scalar = quantity("m | rad", "value at t = 0", default=0.0)
    velocity: Scalar = quantity("m/s | rad/s", "velocity at t = 0", default=0.0)
    acceleration: Scalar = quantity("m/s^2 | rad/s^2", "constant acceleration", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.start.sx + self.velocity.sx * time + self.acceleration.sx * time**2 / 2


@dataclass(eq=False)
class Harmonic(Law):
    """``f = mean + amplitude · sin(frequency · t + phase)``, frequency in rad/s.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("shaker")
    >>> table = system.add(planar.Body("table", mass=2.0, inertia=0.1))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, table.center))
    >>> swing = da.Harmonic(amplitude=0.01, frequency=20.0, phase="90 deg")
    >>> drive = system.add(planar.CoordinateDriver("drive", table.center, swing))
    >>> motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.5)
    >>> round(motion["drive.effort"][0].item(), 6)  # -m ω² a
    -8.0
    """

    amplitude: Scalar = quantity("m | rad", "amplitude")
    frequency: Scalar = quantity("rad/s", "angular frequency")
    mean: Scalar = quantity("m | rad", "mean value", default=0.0)
    phase: Scalar = quantity("rad", "phase at t = 0", default=0.0)

    def value(self, time: ca.SX) -> ca.SX:
        return self.mean.sx + self.amplitude.sx * ca.sin(self.frequency.sx * time + self.phase.sx)
