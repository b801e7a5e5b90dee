"""Planar drivers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import casadi as ca

from dalembert.elements.base import Constraint, Look, Vector, option, quantity
from dalembert.elements.driver import AlongDirection, Driver
from dalembert.elements.joint_forces import free_motion
from dalembert.elements.laws.base import GivenLaw
from dalembert.elements.look import Motor, Travel
from dalembert.elements.planar.body import Body, Ground
from dalembert.elements.planar.joint import BodyJoint, InPlane
from dalembert.elements.planar.prismatic import SlidingJoint
from dalembert.elements.point import Point
from dalembert.errors import ModelError


class JointDriver(Driver):
    """Prescribed free motion of a joint, or of two bodies or points without one.

    A joint may take the place of the first of the two ends; the law follows it.

    Raises
    ------
    ModelError
        A joint without such a motion, neither joint nor ends, or both; no law.
    """

    joint: Constraint

    def resolve(self, first: str, second: str, kind: str, unit: str) -> None:
        """Ends in place of a joint.

        Parameters
        ----------
        first, second : names of the fields of the ends
        kind, unit : name and unit of the prescribed motion
        """
        ends = [getattr(self, first), getattr(self, second)]
        if isinstance(ends[0], Constraint):  # (name, joint, law)
            self.joint, self.law = ends[0], ends[1] if self.law is None else self.law
            ends = [None, None]
        for end in (self.joint, ends[0]):
            if isinstance(end, str):
                text = f"{end!r} is a name; give the element itself, as system.add returns it"
                raise ModelError(text, self.name)
        if self.law is None:
            raise ModelError("has no law; give a law, a number or a formula in t", self.name)
        if self.joint is None:
            if None in ends:
                raise ModelError(
                    f"give a joint that leaves a {kind} free, or {first} and {second}", self.name
                )
            return
        if ends != [None, None]:
            raise ModelError(f"give the joint, or {first} and {second}, not both", self.name)
        joint = self.joint
        of_joint = isinstance(joint, Constraint)
        if of_joint and any(getattr(part, "dimension", 2) > 2 for part in joint.parts()):
            raise ModelError(
                f"joint {joint.name} is in space, and {type(self).__name__} is a planar element; "
                "use one of dalembert.spatial",
                self.name,
            )
        free = joint.freedoms() if of_joint else {}
        free_motion(joint, [n for n, (_, u) in free.items() if u == unit], None, self.name, kind)


@dataclass(eq=False)
class RotationalDriver(JointDriver, BodyJoint):
    """Prescribed rotation of a joint, ``Φ = φ_j − φ_i − f(t)`` (1.28).

    ``RotationalDriver(name, joint, law)``; ``RotationalDriver(name, body_i, body_j, law)``
    prescribes the angle of two bodies that no joint connects.

    Parameters
    ----------
    body_i, body_j : bodies, without a joint; with the ground as body i the angle is absolute
    law : Law, number or formula in t [rad]
    joint : joint with a free rotation, in place of the bodies

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank")
    >>> crank = system.add(planar.Bar("crank", length=0.1))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> motor = system.add(planar.RotationalDriver("motor", hinge, 10 * da.t))
    >>> motion = da.solve_kinematics(system.build(), "pi/20", step="pi/20")
    >>> motion["crank.end.speed"].values.round(6), motion["crank.end.y"].values.round(6)
    (array([1., 1.]), array([0. , 0.1]))
    """

    body_i: Body = None  # type: ignore[assignment]
    body_j: Body = None  # type: ignore[assignment]
    law: GivenLaw = option("motion law", default=None)
    joint: Constraint = option("joint with a free rotation, in place of `connect`", default=None)
    prescribes = "rad"

    if TYPE_CHECKING:

        @overload
        def __init__(self, name: str, joint: Constraint, law: GivenLaw) -> None: ...
        @overload
        def __init__(self, name: str, body_i: Body, body_j: Body, law: GivenLaw) -> None: ...
        def __init__(self, *arguments: Any, **keywords: Any) -> None: ...

    def __post_init__(self) -> None:
        self.resolve("body_i", "body_j", "turn", "rad")
        if self.joint is not None:
            self.body_i, self.body_j = self.joint.parts()  # type: ignore[assignment]
        super().__post_init__()

    @property
    def measured(self) -> str:
        is_absolute = isinstance(self.body_i, Ground)
        return f"{self.body_j.name}.angle" if is_absolute else super().measured

    def coordinate(self) -> ca.SX:
        return self.body_j.pose_angle - self.body_i.pose_angle

    def look(self) -> list[Look]:
        return [Motor(self.body_i, self.body_j)]


@dataclass(eq=False)
class TranslationalDriver(JointDriver, SlidingJoint):
    """Prescribed displacement of a joint, ``Φ = u_iᵀ(r_jP − r_iP) − f(t)``.

    ``TranslationalDriver(name, joint, law)``; ``TranslationalDriver(name, point_i, point_j,
    axis=…, law=…)`` prescribes the displacement of two points that no joint connects.

    Parameters
    ----------
    point_i, point_j : points of the two bodies, without a joint
    axis : (2,) direction in the frame of body i, without a joint
    law : Law, number or formula in t [m]
    joint : joint with a free displacement, in place of the points and the axis

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("table")
    >>> table = system.add(planar.Body("table", mass=3.0, inertia=0.1))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, table.center))
    >>> feed = system.add(planar.TranslationalDriver("feed", rail, da.t**2))
    >>> motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.5)
    >>> motion["feed.effort"].values.round(6)  # m a
    array([6., 6., 6.])
    """

    point_i: Point = None  # type: ignore[assignment]
    point_j: Point = None  # type: ignore[assignment]
    law: GivenLaw = option("motion law", default=None)
    joint: Constraint = option(
        "joint with a free displacement, in place of `connect` and `axis`", default=None
    )

    if TYPE_CHECKING:

        @overload
        def __init__(self, name: str, joint: Constraint, law: GivenLaw) -> None: ...
        @overload
        def __init__(
            self, name: str, point_i: Any, point_j: Any, axis: Vector = ..., *, law: GivenLaw
        ) -> None: ...
        def __init__(self, *arguments: Any, **keywords: Any) -> None: ...

    def __post_init__(self) -> None:
        self.resolve("point_i", "point_j", "displacement", "m")
        if isinstance(self.joint, SlidingJoint):
            if self.axis is not type(self).axis:
                raise ModelError("axis is that of its joint; leave it out", self.name)
            self.point_i, self.point_j = self.joint.end_points
            self.axis = self.joint.axis
        super().__post_init__()

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
