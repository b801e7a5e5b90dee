"""Planar drivers."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Vector, option, quantity
from dalembert.elements.driver import AlongDirection, Driver
from dalembert.elements.laws.base import GivenLaw
from dalembert.elements.look import Motor, Travel
from dalembert.elements.planar.body import Ground
from dalembert.elements.planar.joint import BodyJoint, InPlane
from dalembert.elements.planar.prismatic import SlidingJoint
from dalembert.elements.point import Point


@dataclass(eq=False)
class RotationalDriver(Driver, BodyJoint):
    """Prescribed angle of body j relative to body i, ``Φ = φ_j − φ_i − f(t)`` (1.28).

    Parameters
    ----------
    body_i, body_j : bodies; with the ground as body i the angle is absolute
    law : Law, number or formula in t [rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank")
    >>> crank = system.add(planar.Bar("crank", length=0.1))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, 10 * da.t))
    >>> motion = da.solve_kinematics(system.build(), "pi/20", step="pi/20")
    >>> motion["crank.end.speed"].values.round(6), motion["crank.end.y"].values.round(6)
    (array([1., 1.]), array([0. , 0.1]))
    """

    law: GivenLaw = option("motion law")
    prescribes = "rad"

    @property
    def measured(self) -> str:
        is_absolute = isinstance(self.body_i, Ground)
        return f"{self.body_j.name}.angle" if is_absolute else super().measured

    def coordinate(self) -> ca.SX:
        return self.body_j.pose_angle - self.body_i.pose_angle

    def look(self) -> list[Look]:
        return [Motor(self.body_i, self.body_j)]


@dataclass(eq=False)
class TranslationalDriver(Driver, SlidingJoint):
    """Prescribed displacement of point_j along an axis of body i, ``Φ = u_iᵀ(r_jP − r_iP) − f(t)``.

    Parameters
    ----------
    axis : (2,) direction in the frame of body i
    law : Law, number or formula in t [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("table")
    >>> table = system.add(planar.Body("table", mass=3.0, inertia=0.1))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, table.center))
    >>> ends = system.ground.center, table.center
    >>> feed = system.add(planar.TranslationalDriver("feed", *ends, law=da.t**2))
    >>> motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.5)
    >>> motion["feed.effort"].values.round(6)  # m a
    array([6., 6., 6.])
    """

    law: GivenLaw = option("motion law", default=None)

    def coordinate(self) -> ca.SX:
        return self.displacement

    def look(self) -> list[Look]:
        return [Travel(self.point_j, self.point_i.body, self.axis.sx)]


@dataclass(eq=False)
class CoordinateDriver(InPlane, AlongDirection):
    """Prescribed coordinate of a point, ``Φ = uᵀ r_P − f(t)``.

    Parameters
    ----------
    point : point of a body
    law : Law, number or formula in t [m]
    direction : (2,) direction in inertial axes

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ladder")
    >>> ladder = system.add(planar.Bar("ladder", length=5.0, angle=-0.9))
    >>> wall = system.add(planar.PinInSlot("wall", system.ground.center, ladder.start, axis=(0, 1)))
    >>> floor = system.add(planar.PinInSlot("floor", system.ground.center, ladder.end))
    >>> foot = system.add(planar.CoordinateDriver("foot", ladder.end, 3 + da.t))
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=1.0)
    >>> motion["ladder.start.y"].values.round(6)  # 3-4-5 and 4-3-5
    array([4., 3.])
    """

    point: Point
    law: GivenLaw = option("motion law")
    direction: Vector = quantity("", "direction in inertial axes", default=(1.0, 0.0), size=2)
