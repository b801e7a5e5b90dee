"""Planar bodies: rigid body, bar, particle and ground, with their points.

A body's coordinates are the position of its mass centre and its angle, ``y = (x, y, φ)``; its
speeds are their rates. A point fixed in the body is at ``r_P = r + A(φ) s'`` (Ch. 1).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Scalar, Vector, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.point import components
from dalembert.elements.simple_bodies import PointMass, SlenderBar, unused
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.rotation import about_z


def rotation(angle: ca.SX) -> ca.SX:
    """``A(φ) = [[c, −s], [s, c]]``."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


def perpendicular(vector: ca.SX) -> ca.SX:
    """The vector rotated by +90°."""
    return ca.vertcat(-vector[1], vector[0])


def cross(a: Any, b: Any) -> Any:
    """Out-of-plane component of ``a × b``, of expressions or numbers."""
    return a[0] * b[1] - a[1] * b[0]


class PlanarFrame(BodyElement):
    """A planar frame with a position and an angle."""

    pose_position: ca.SX
    pose_angle: ca.SX

    def locate(self, local: ca.SX) -> ca.SX:
        position = self.pose_position
        return self.turned(local) + (position if local.numel() == 2 else ca.vertcat(position, 0))

    def turned(self, local: ca.SX) -> ca.SX:
        in_plane = ca.mtimes(self._axes, local[:2])
        return in_plane if local.numel() == 2 else ca.vertcat(in_plane, local[2])

    @cached_property
    def _axes(self) -> ca.SX:
        """``A(φ)``, one expression shared by all points and their derivatives."""
        return rotation(self.pose_angle)

    @property
    def orientation(self) -> ca.SX:
        return about_z(self.pose_angle)


def motion_measures(body: PlanarFrame) -> dict[str, tuple[ca.SX, str]]:
    """Measures of the pose ``(x, y, φ, …)`` of a body and of its rates."""
    columns = body.pose, body.twist, body.acceleration_symbols
    position, velocity, acceleration = (column[:2] for column in columns)
    angles = ((column[2] if body.rotates else ca.SX(0)) for column in columns)
    angle, angular_velocity, angular_acceleration = angles
    return {
        "position": (position, "m"),
        "velocity": (velocity, "m/s"),
        "acceleration": (acceleration, "m/s^2"),
        "angle": (angle, "rad"),
        "angular_velocity": (angular_velocity, "rad/s"),
        "angular_acceleration": (angular_acceleration, "rad/s^2"),
        **components("", position, "m"),
        **components("v", velocity, "m/s"),
        **components("a", acceleration, "m/s^2"),
    }


class MovingFrame(PlanarFrame):
    """A frame whose position and angle are the first coordinates of its pose.

    Attributes
    ----------
    initial : position, angle, velocity and angular velocity
    """

    initial_fields = ("position", "angle", "velocity", "angular_velocity")
    initial: tuple[Any, Any, Any, Any]

    @property
    def turning(self) -> ca.SX:
        return ca.vertcat(0, 0, self.twist[2] if self.rotates else 0)

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        moment = effort[2] if self.rotates else ca.SX(0)
        return effort[:2], moment, self.pose_position

    def guesses(self) -> tuple[list, list]:
        position, angle, velocity, angular_velocity = self.initial
        n = 3 if self.rotates else 2

        def entries(vector, scalar):
            first = [None, None] if vector is None else [vector.sx[0], vector.sx[1]]
            return [*first, None if scalar is None else scalar.sx][:n]

        return entries(position, angle), entries(velocity, angular_velocity)


@dataclass(eq=False)
class Body(MovingFrame):
    """Planar rigid body.

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
        A mass without inertia, an invalid name or number.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -9.81))
    >>> plate = system.add(planar.Body("plate", mass=2.0, inertia=0.1, velocity=(3, 4),
    ...     angular_velocity=5.0, points={"corner": (0.2, 0.1)}))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["plate.position"][-1].values.round(6)  # v t + g t²/2
    array([ 3.   , -0.905])
    >>> round(motion["plate.corner.speed"][0].item(), 6)  # |v + ω × s|
    5.59017
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
    not_drawn = "a plate over its points is drawn, or its mass centre"

    def __post_init__(self) -> None:
        super().__post_init__()
        points = self.named("points")
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
        self._declare(points)

    def _declare(self, points: dict) -> None:
        self.pose_position = self.mass_center = self.pose[:2]
        self.pose_angle = self.pose[2] if self.rotates else ca.SX(0)
        self.declare(motion_measures(self), points)

    def velocity_at(self, place: ca.SX) -> ca.SX:
        arm = place - ca.vertcat(self.pose_position, 0)
        return ca.vertcat(self.twist[:2], 0) + ca.cross(self.turning, arm)

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        entries = [self.mass.sx, self.mass.sx] + ([self.inertia.sx] if self.rotates else [])
        return ca.diag(ca.vertcat(*entries)), ca.SX(len(entries), 1)


class Ground(Body):
    """The inertial frame: a body whose pose is always zero.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("frame")
    >>> type(system.ground) is planar.Ground, system.ground.name
    (True, 'ground')
    >>> bearing = system.ground.point(0.6, 0.1)  # location of a joint
    >>> [float(x) for x in bearing.local.sx.elements()]
    [0.6, 0.1]
    """

    def __init__(self) -> None:
        super().__init__("ground")


@dataclass(eq=False)
class Bar(SlenderBar, Body):
    """Uniform slender bar along its x axis; the origin is its mass centre.

    ``inertia`` defaults to ``m l²/12``. Its ends are the points ``start`` and ``end``.

    Parameters
    ----------
    length : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> motion = da.solve_dynamics(system.build(), 0.01, step=0.01)  # released horizontally
    >>> round(motion["bob.angular_acceleration"][0].item(), 6)  # -3 g/(2 l)
    -9.81
    """

    length: Scalar = quantity("m", "length", above=0.0, keyword=True)

    def __post_init__(self) -> None:
        self.length = as_expression(self.length, f"{self.name}.length", "m")
        if self.mass is not None and self.inertia is None:
            mass = as_expression(self.mass, f"{self.name}.mass", "kg")
            self.inertia = Expression(self.slender_inertia(mass.sx))
        super().__post_init__()
        self.add_ends()


@dataclass(eq=False)
class Particle(PointMass, Body):
    """Point mass: two coordinates, no rotation.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -9.81))
    >>> stone = system.add(planar.Particle("stone", mass=0.2, velocity=(5, 9.81)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> motion["stone.position"][-1].values.round(6)  # back on the ground
    array([10.,  0.])
    """

    inertia: Any = unused()
    angle: Any = unused()
    angular_velocity: Any = unused()
