"""Planar bodies: rigid body, bar, particle and ground, with their points.

A body's coordinates are the position of its mass centre and its angle, ``y = (x, y, φ)``; its
speeds are their rates. A point fixed in the body is at ``r_P = r + A(φ) s'`` (Ch. 1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.attachment import BodyPoint, RigidBody
from dalembert.elements.base import (
    Coordinates,
    Element,
    Scalar,
    Vector,
    quantity,
    rate_of,
    second_rate_of,
)
from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression, as_expression, t


def rotation(angle: ca.SX) -> ca.SX:
    """``A(φ) = [[c, −s], [s, c]]``."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


def perpendicular(vector: ca.SX) -> ca.SX:
    """The vector turned by +90°."""
    return ca.vertcat(-vector[1], vector[0])


def cross(a: ca.SX, b: ca.SX) -> ca.SX:
    """Out-of-plane component of ``a × b``."""
    return a[0] * b[1] - a[1] * b[0]


def unit_vector(vector: ca.SX, entity: str) -> ca.SX:
    """The vector at length one.

    Raises
    ------
    ModelError
        Both components zero.
    """
    if vector.is_constant() and float(ca.norm_2(vector)) < 1e-12:
        raise ModelError("a direction needs a length; (0, 0) has none", entity)
    return vector / ca.sqrt(vector[0] ** 2 + vector[1] ** 2)


GUESSES = ("position", "angle", "velocity", "angular_velocity")


class Point(BodyPoint):
    """A point fixed in a body.

    Parameters
    ----------
    body : Body
    local : (2,) coordinates in the body frame [m]
    name : str, optional
    """

    body: Body

    def __init__(self, body: Body, local: Vector, name: str = ""):
        self.body = body
        self.name = f"{body.name}.{name}" if name else ""
        self.local = as_expression(local, self.name or f"point of {body.name}", "m", 2)

    def _named(self, sx: ca.SX, what: str, unit: str) -> Expression:
        return Expression(sx, f"{self.name}.{what}" if self.name else "", unit)

    @property
    def arm(self) -> ca.SX:
        """Vector from the mass centre to the point, inertial axes."""
        return ca.mtimes(rotation(self.body.pose_angle), self.local.sx)

    @property
    def position(self) -> Expression:
        return self._named(self.body.pose_position + self.arm, "position", "m")

    @property
    def velocity(self) -> Expression:
        rate = rate_of(self.position.sx, [self.body], t.sx)
        return self._named(rate, "velocity", "m/s")

    @property
    def acceleration(self) -> Expression:
        second = second_rate_of(self.position.sx, [self.body], t.sx)
        return self._named(second, "acceleration", "m/s^2")

    @property
    def x(self) -> Expression:
        return self._named(self.position.sx[0], "x", "m")

    @property
    def y(self) -> Expression:
        return self._named(self.position.sx[1], "y", "m")

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        position, velocity = self.position.sx, self.velocity.sx
        acceleration = self.acceleration.sx
        return {
            "position": (position, "m"),
            "velocity": (velocity, "m/s"),
            "acceleration": (acceleration, "m/s^2"),
            "x": (position[0], "m"),
            "y": (position[1], "m"),
            "vx": (velocity[0], "m/s"),
            "vy": (velocity[1], "m/s"),
            "ax": (acceleration[0], "m/s^2"),
            "ay": (acceleration[1], "m/s^2"),
            "speed": (ca.sqrt(ca.sumsqr(velocity)), "m/s"),
        }


@dataclass(eq=False)
class Body(Element, Coordinates, RigidBody):
    """Rigid body in the plane.

    Poses and speeds are guesses that assembly corrects; after construction the attributes
    ``angle``, ``velocity``, ``angular_velocity`` … are the body's measures.

    Parameters
    ----------
    mass : [kg]
    inertia : about the mass centre [kg m²]
    position : (2,) initial position of the mass centre [m]
    angle : initial angle [rad]
    velocity, angular_velocity : initial speeds [m/s], [rad/s]
    points : name → (2,) coordinates in the body frame [m]

    Raises
    ------
    ModelError
        A mass without inertia, a bad name or number.
    """

    mass: Scalar = quantity("kg", "mass", default=None, minimum=0.0)
    inertia: Scalar = quantity(
        "kg m^2", "moment of inertia about the mass centre", default=None, minimum=0.0
    )
    position: Vector = quantity("m", "initial position of the mass centre", default=None, size=2)
    angle: Scalar = quantity("rad", "initial angle", default=None)
    velocity: Vector = quantity("m/s", "initial velocity", default=None, size=2)
    angular_velocity: Scalar = quantity("rad/s", "initial angular velocity", default=None)
    points: dict[str, Vector] = None  # type: ignore[assignment]

    rotates = True

    def __post_init__(self) -> None:
        Element.__post_init__(self)
        given = dict(self.points or {})
        self.initial = (self.position, self.angle, self.velocity, self.angular_velocity)
        if self.rotates and self.mass is not None and self.inertia is None:
            raise ModelError(
                "mass is given but inertia is missing; give inertia= about the mass centre "
                "(0 is allowed where the rotation is constrained), or use a Particle",
                self.name,
            )
        self.mass = self.mass if self.mass is not None else Expression(0)
        self.inertia = self.inertia if self.inertia is not None else Expression(0)
        names, units = ("x", "y", "angle"), ("m", "m", "rad")
        n = 3 if self.rotates else 2
        self.make_symbols(names[:n], units[:n])
        self._make_measures()
        self.points = {}
        for name, local in given.items():
            self.add_point(name, local)

    def _make_measures(self) -> None:
        zero = ca.SX(0)
        self.pose_position = self.pose[:2]
        self.pose_angle = self.pose[2] if self.rotates else zero
        angle, speed, acceleration = (
            (column[2] if self.rotates else zero)
            for column in (self.pose, self.twist, self.acceleration_symbols)
        )
        named = {
            "position": (self.pose[:2], "m"),
            "velocity": (self.twist[:2], "m/s"),
            "acceleration": (self.acceleration_symbols[:2], "m/s^2"),
            "angle": (angle, "rad"),
            "angular_velocity": (speed, "rad/s"),
            "angular_acceleration": (acceleration, "rad/s^2"),
            "x": (self.pose[0], "m"),
            "y": (self.pose[1], "m"),
            "vx": (self.twist[0], "m/s"),
            "vy": (self.twist[1], "m/s"),
            "ax": (self.acceleration_symbols[0], "m/s^2"),
            "ay": (self.acceleration_symbols[1], "m/s^2"),
        }
        self._measures = named
        for name, (sx, unit) in named.items():
            setattr(self, name, Expression(sx, f"{self.name}.{name}", unit))

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        twist, (mass, _) = self.twist, self.inertia_by_speeds()
        kinetic = ca.mtimes([twist.T, mass, twist]) / 2
        return {**self._measures, "kinetic_energy": (kinetic, "J")}

    def add_point(self, name: str, local: Vector) -> Point:
        """Name a point of the body, so that results list it."""
        if not isinstance(name, str) or not name.isidentifier():
            raise ModelError(f"point name {name!r} is not an identifier", self.name)
        if name in self._measures or name in self.points:
            raise ModelError(f"point name {name!r} is taken; choose another", self.name)
        self.points[name] = Point(self, local, name)
        return self.points[name]

    def point(self, x, y=None) -> Point:
        """Point at body coordinates ``(x, y)`` [m], or the named point ``point("P")``."""
        if y is None:
            if x not in self.points:
                known = ", ".join(self.points) or "none"
                raise ModelError(f"no point {x!r} (known: {known})", self.name)
            return self.points[x]
        return Point(self, (x, y))

    @property
    def center(self) -> Point:
        """The mass centre."""
        return Point(self, (0.0, 0.0))

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        entries = [self.mass.sx, self.mass.sx] + ([self.inertia.sx] if self.rotates else [])
        return ca.diag(ca.vertcat(*entries)), ca.SX(len(entries), 1)

    def guesses(self) -> tuple[list, list]:
        position, angle, velocity, angular_velocity = self.initial
        n = self.pose.numel()

        def entries(vector, scalar):
            first = [None, None] if vector is None else [vector.sx[0], vector.sx[1]]
            return [*first, None if scalar is None else scalar.sx][:n]

        return entries(position, angle), entries(velocity, angular_velocity)

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        given = dict(zip(GUESSES, self.initial, strict=True))
        found = []
        for field, meta in self.quantities():
            value = given[field] if field in given else getattr(self, field)
            if isinstance(value, Expression):
                found.append((f"{self.name}.{field}", value, meta))
        where = {"unit": "m", "minimum": -math.inf, "above": -math.inf}
        return found + [(p.name, p.local, where) for p in self.points.values()]

    def parts(self) -> list[Coordinates]:
        return [self]


class Ground(Body):
    """The inertial frame: a body whose pose is always zero."""

    def __init__(self) -> None:
        super().__init__("ground")


@dataclass(eq=False)
class Bar(Body):
    """Uniform slender bar along its x axis, mass centre at the middle.

    ``inertia`` defaults to ``m l²/12``. Its ends are the points ``start`` and ``end``.

    Parameters
    ----------
    length : [m]
    """

    length: Scalar = quantity("m", "length", above=0.0, keyword=True)

    def __post_init__(self) -> None:
        length = as_expression(self.length, f"{self.name}.length", "m")
        if self.mass is not None and self.inertia is None:
            self.inertia = as_expression(self.mass, f"{self.name}.mass") * length**2 / 12
        super().__post_init__()
        half = length / 2  # one node, so that both ends share their trigonometry
        self.start = self.add_point("start", (-half, 0.0))
        self.end = self.add_point("end", (half, 0.0))


@dataclass(eq=False)
class Particle(Body):
    """Point mass: two coordinates, no rotation."""

    rotates = False

    def __post_init__(self) -> None:
        for field in ("inertia", "angle", "angular_velocity"):
            if getattr(self, field) is not None:
                raise ModelError(f"a particle has no {field}; use a Body", self.name)
        super().__post_init__()

    def point(self, x, y=None) -> Point:
        """The particle itself: its only point is (0, 0).

        Raises
        ------
        ModelError
            Any other point.
        """
        made = super().point(x, y)
        if not made.local.sx.is_zero():
            raise ModelError("a particle has no point but (0, 0); use a Body", self.name)
        return made
