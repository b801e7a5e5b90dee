"""Springs, dampers and actuators between two points, and elastic bearings."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import (
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    Vector,
    option,
    quantity,
)
from dalembert.elements.look import Coil, Cylinder, Dashpot
from dalembert.elements.pair import BetweenPoints
from dalembert.errors import DalembertError, ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

SMALLEST_LENGTH = 1e-30
"""Regularisation of a length at zero [m]."""
ForceLaw = Callable[[Expression, Expression], Any]
"""Force as a function of the extension and its rate."""


def call_law(law: ForceLaw, entity: str, extension: Expression, rate: Expression) -> Any:
    """The return value of a law of the user.

    Raises
    ------
    ModelError
        The law is not a function of two arguments, or fails.
    """
    if not callable(law):
        raise ModelError(f"expected a function of extension and rate, got {law!r:.60}", entity)
    try:
        inspect.signature(law).bind(extension, rate)
    except TypeError as error:
        message = f"must take two arguments, extension and rate: {error}"
        raise ModelError(message, entity) from None
    except ValueError:  # compiled functions may have no signature
        pass
    try:
        return law(extension, rate)
    except DalembertError:
        raise
    except Exception as error:
        message = f"the law fails for extension and rate: {type(error).__name__}: {error!s:.200}"
        raise ModelError(message, entity) from error


class SpringDamper(ForceElement):
    """Spring and damper along one coordinate ``s``, translational or rotational.

    ``F = k (s − s0) + c ṡ``, plus ``law(s − s0, ṡ)``; it acts against the coordinate, so that
    a positive force pulls (tension).
    """

    name: str
    coordinate_name = "length"
    coordinate_unit = "m"
    force_name = "force"
    force_unit = "N"

    stiffness: Scalar
    damping: Scalar
    law: ForceLaw | None

    def free_value(self) -> ca.SX:
        raise NotImplementedError

    def elastic(self) -> ca.SX:
        """Force of the spring alone."""
        return self.stiffness.sx * (self.coordinate() - self.free_value())

    def force(self, rate: Rate) -> ca.SX:
        s = self.coordinate()
        linear = self.elastic() + self.damping.sx * rate(s)
        if self.law is None:
            return linear
        extension = Expression(s - self.free_value(), "extension", self.coordinate_unit)
        value = call_law(self.law, f"{self.name}.law", extension, Expression(rate(s), "rate"))
        return linear + as_expression(value, f"{self.name}.law", self.force_unit).sx

    def primitives(self, spring: type[Look], damper: type[Look], *ends: Any) -> list[Look]:
        """Primitives for a nonzero damping and a nonzero stiffness or law."""
        elastic = not self.stiffness.sx.is_zero() or self.law is not None
        dampers = [] if self.damping.sx.is_zero() else [damper]
        return [kind(*ends) for kind in (*dampers, *([spring] if elastic else []))]

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.coordinate()), -self.force(rate))]

    def potential(self) -> ca.SX:
        return self.stiffness.sx * (self.coordinate() - self.free_value()) ** 2 / 2

    def dissipation(self, rate: Rate) -> Powers:
        speed = rate(self.coordinate())
        return [(speed, -self.damping.sx * speed)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        s = self.coordinate()
        return {
            self.coordinate_name: (s, self.coordinate_unit),
            "rate": (rate(s), f"{self.coordinate_unit}/s"),
            self.force_name: (self.force(rate), self.force_unit),
        }


@dataclass(eq=False)
class AngularSpring(SpringDamper):
    """A spring and damper along an angle."""

    stiffness: Scalar = quantity("N m/rad", "stiffness", default=0.0)
    damping: Scalar = quantity("N m s/rad", "damping", default=0.0)
    free_angle: Scalar = quantity("rad", "angle without moment", default=0.0)
    law: ForceLaw | None = option("additional moment, formula of extension and rate", default=None)
    coordinate_name = "angle"
    coordinate_unit = "rad"
    force_name = "moment"
    force_unit = "N m"

    def free_value(self) -> ca.SX:
        return self.free_angle.sx


@dataclass(eq=False)
class PointPair(BetweenPoints, ForceElement):
    """Force element between two points; its coordinate is their distance."""

    def coordinate(self) -> ca.SX:
        return self.distance


@dataclass(eq=False)
class Spring(SpringDamper, PointPair):
    """Spring and damper in parallel between two points (1.56–1.64).

    Parameters
    ----------
    stiffness : [N/m]
    damping : [N s/m]
    free_length : [m]
    law : function (extension, rate) → additional force [N], positive in tension

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> pan = system.add(planar.Particle("pan", mass=2.0, position=(0, -0.3)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, pan.center, axis=(0, 1)))
    >>> spring = system.add(planar.Spring("spring", system.ground.center, pan.center,
    ...     stiffness=100.0, free_length=0.3))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["spring.length"].item(), 6), round(rest["spring.force"].item(), 6)  # by m g/k
    (0.5, 20.0)
    """

    stiffness: Scalar = quantity("N/m", "stiffness", default=0.0)
    damping: Scalar = quantity("N s/m", "damping", default=0.0)
    free_length: Scalar = quantity("m", "free length", default=0.0, minimum=0.0)
    law: ForceLaw | None = option("additional force, formula of extension and rate", default=None)

    def coordinate(self) -> ca.SX:
        if self.free_length.sx.is_zero():  # the force has a limit at length zero
            return ca.sqrt(ca.sumsqr(self.between) + SMALLEST_LENGTH**2)
        return super().coordinate()

    def free_value(self) -> ca.SX:
        return self.free_length.sx

    def look(self) -> list[Look]:
        return self.primitives(Coil, Dashpot, self.point_i, self.point_j)


@dataclass(eq=False)
class Actuator(PointPair):
    """Force along the line of two points; positive pushes them apart.

    Parameters
    ----------
    force : [N]; formula of t, parameters and measures

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ram", gravity=(0, -9.81))
    >>> load = system.add(planar.Particle("load", mass=100.0, position=(0, 0.5)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, load.center, axis=(0, 1)))
    >>> ram = system.add(planar.Actuator("ram", system.ground.center, load.center, force=1181.0))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    >>> round(motion["load.ay"][0].item(), 6)  # F/m - g
    2.0
    """

    force: Scalar = quantity("N", "force, positive pushes apart")

    def look(self) -> list[Look]:
        return [Cylinder(self.point_i, self.point_j)]

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.coordinate()), self.force.sx)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        s = self.coordinate()
        return {
            "length": (s, "m"),
            "rate": (rate(s), "m/s"),
            "force": (self.force.sx, "N"),
            "power": (self.force.sx * rate(s), "W"),
        }


class ElasticBearing(ForceElement):
    """``Q = −(k s + c ṡ)`` along every entry of a deformation ``s``: displacements, then rotations.

    A new bearing implements ``deformation``.
    """

    stiffness: Vector
    damping: Vector
    rotational_stiffness: Scalar
    rotational_damping: Scalar

    def deformation(self) -> ca.SX:
        """Displacements [m], one per entry of ``stiffness``, and rotations [rad]."""
        raise NotImplementedError

    def _stiffness(self) -> ca.SX:
        return ca.vertcat(self.stiffness.sx, self.rotational_stiffness.sx)

    def _damping(self) -> ca.SX:
        return ca.vertcat(self.damping.sx, self.rotational_damping.sx)

    def _efforts(self, rate: Rate) -> ca.SX:
        s = self.deformation()
        return self._stiffness() * s + self._damping() * rate(s)

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.deformation()), -self._efforts(rate))]

    def potential(self) -> ca.SX:
        return ca.dot(self._stiffness(), self.deformation() ** 2) / 2

    def dissipation(self, rate: Rate) -> Powers:
        speed = rate(self.deformation())
        return [(speed, -self._damping() * speed)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        n = self.stiffness.sx.numel()
        s, efforts = self.deformation(), self._efforts(rate)
        return {
            "deflection": (s[:n], "m"),
            "turn": (s[n:], "rad"),
            "force": (efforts[:n], "N"),
            "moment": (efforts[n:], "N m"),
        }
