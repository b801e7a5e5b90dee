"""Spatial frames: position and Euler parameters, ``y = (r, e)``, with ``v = (ṙ, ω')``.

The angular velocity is in the axes of the frame (Ch. 2).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, rate_of, second_rate_of
from dalembert.elements.point import components
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.once import template


class Attitude(Coordinates):
    """A rotation by Euler parameters, ``ė = e ⊗ (0, ω') / 2``.

    Parameters
    ----------
    name : str
    """

    flat = False
    attitude = (0, 0)
    rest = rotation.IDENTITY
    coordinate_names, coordinate_units = rotation.EULER_PARAMETERS, ("1",) * 4
    speed_names, speed_units = rotation.SPIN, ("rad",) * 3

    def __init__(self, name: str):
        self.name = name
        self.pose = stack(ca.SX.sym(f"{name}.{n}") for n in self.coordinate_names)
        self._make_speeds()
        self.pose_rate = rotation.rate(self.pose, self.twist)

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return rotation.turned(pose, displacement)

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return rotation.turn(pose, other)

    def bounds(self, pose: ca.SX) -> ca.SX:
        return (ca.sumsqr(pose) - 1) / 2


@template(7, 6)
def _retract(pose: ca.SX, displacement: ca.SX) -> ca.SX:
    """``y ⊕ δ`` of a position and Euler parameters."""
    rotated = rotation.turned(pose[3:], displacement[3:])
    return ca.vertcat(pose[:3] + displacement[:3], rotated)


@template(7, 7)
def _displacement(pose: ca.SX, other: ca.SX) -> ca.SX:
    """``y' ⊖ y`` of positions and Euler parameters."""
    return ca.vertcat(other[:3] - pose[:3], rotation.turn(pose[3:], other[3:]))


class SpatialFrame(BodyElement):
    """A body with the coordinates of a spatial frame.

    Attributes
    ----------
    origin : SX symbols ``r``, the mass centre of a rigid body
    e, axes : SX, Euler parameters and the axes as columns
    spin : SX symbols ``ω'``
    initial : position, orientation, velocity and angular velocity of the body's origin
    """

    dimension = 3
    initial_fields = ("position", "rotation", "velocity", "angular_velocity")
    initial: tuple[Any, Any, Any, Any]

    def _make_coordinates(self, additional: tuple[str, ...] = ()) -> None:
        """Create pose and twist, followed by additional coordinates [m] with their rates."""
        position, attitude, flexible = Coordinates(), Coordinates(), Coordinates()
        if self.rotates:
            attitude = Attitude(self.name)
        else:
            attitude.make_symbols((), ())
        position.name = flexible.name = self.name
        position.make_symbols(("x", "y", "z"), ("m",) * 3)
        flexible.make_symbols(additional, ("m",) * len(additional))
        groups = self._groups = (position, attitude, flexible)
        for name in ("coordinate_names", "coordinate_units", "speed_names", "speed_units", "rest"):
            setattr(self, name, sum((getattr(group, name) for group in groups), ()))
        for name in ("pose", "twist", "acceleration_symbols", "pose_rate"):
            setattr(self, name, ca.vertcat(*(getattr(group, name) for group in groups)))
        self.origin, self.e, self.spin = position.pose, attitude.pose, attitude.twist
        self.axes = rotation.matrix(self.e) if self.rotates else ca.SX.eye(3)

    def motion_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Measures of the pose and its rates."""
        position = self.locate(ca.SX.zeros(3))
        velocity = rate_of(position, [self], t.sx)
        acceleration = second_rate_of(position, [self], t.sx)
        measures = {
            "position": (position, "m"),
            "velocity": (velocity, "m/s"),
            "acceleration": (acceleration, "m/s^2"),
            **components("", position, "m"),
            **components("v", velocity, "m/s"),
            **components("a", acceleration, "m/s^2"),
        }
        if self.rotates:
            angular = self.acceleration_symbols[3:6]
            measures |= {
                "euler_parameters": (self.e, "1"),
                "rotation": (ca.vec(self.axes.T), "1"),
                "bryant": (rotation.angles(self.axes, "xyz"), "rad"),
                "angular_velocity": (self.turning, "rad/s"),
                "angular_velocity_local": (self.spin, "rad/s"),
                "angular_acceleration": (ca.mtimes(self.axes, angular), "rad/s^2"),
            }
        return measures

    def euler(self, sequence: str) -> Expression:
        """(3,) angles of successive rotations about body axes, for a sequence such as ``"zxz"``.

        The second is in [−π/2, π/2], for ``zxz`` and similar in [0, π]. At the ends of that range,
        the singular attitude, the first and the third are undetermined, and change fast nearby.

        Raises
        ------
        ModelError
            Not three axes, or two equal ones in a row.
        """
        return Expression(rotation.angles(self.axes, sequence), f"{self.name}.{sequence}", "rad")

    # manifold ---------------------------------------------------------------------------------
    @property
    def attitude(self) -> tuple[int, int] | None:
        return (3, 3) if self.rotates else None

    @property
    def flat(self) -> bool:
        return not self.rotates

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        if self._rigid:
            return _retract(pose, displacement)
        parts = zip(
            self._groups, self._split_pose(pose), self._split_twist(displacement), strict=True
        )
        return ca.vertcat(*(group.retract(y, delta) for group, y, delta in parts))

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        if self._rigid:
            return _displacement(pose, other)
        parts = zip(self._groups, self._split_pose(pose), self._split_pose(other), strict=True)
        return ca.vertcat(*(group.displacement(y, z) for group, y, z in parts))

    def bounds(self, pose: ca.SX) -> ca.SX:
        if self._rigid:
            return self._groups[1].bounds(pose[3:])
        parts = zip(self._groups, self._split_pose(pose), strict=True)
        return ca.vertcat(*(group.bounds(y) for group, y in parts))

    @property
    def _rigid(self) -> bool:
        """Whether the pose is a position and Euler parameters only, for which templates exist."""
        return self.rotates and self.pose.numel() == 7

    def _split_pose(self, pose: ca.SX) -> list[ca.SX]:
        """The part of each group."""
        return ca.vertsplit(pose, np.cumsum([0, *(g.pose.numel() for g in self._groups)]).tolist())

    def _split_twist(self, twist: ca.SX) -> list[ca.SX]:
        """The part of each group."""
        return ca.vertsplit(
            twist, np.cumsum([0, *(g.twist.numel() for g in self._groups)]).tolist()
        )

    @contextmanager
    def enriched(self) -> Iterator[tuple[ca.SX, ca.SX]]:
        """Enrich by the axes, whose rates ``Ṙ = R ω̃'`` do not involve Euler parameters."""
        if not self.rotates:
            with super().enriched() as empty:
                yield empty
            return
        pose, rate, axes = self.pose, self.pose_rate, self.axes
        symbols = ca.SX.sym(f"{self.name}.R", 3, 3)
        turning = ca.mtimes(symbols, rotation.skew(self.spin))
        self.axes, self.followers = symbols, (ca.vec(symbols), ca.vec(axes))
        self.pose, self.pose_rate = (
            ca.vertcat(pose, ca.vec(symbols)),
            ca.vertcat(rate, ca.vec(turning)),
        )
        try:
            yield self.followers
        finally:
            self.pose, self.pose_rate, self.axes = pose, rate, axes
            del self.followers

    # mechanics --------------------------------------------------------------------------------
    @property
    def offset(self) -> ca.SX:
        """(3,) position of ``r`` in the body frame."""
        return ca.SX.zeros(3)

    def locate(self, local: ca.SX) -> ca.SX:
        return self.origin + self.turned(local - self.offset)

    def turned(self, local: ca.SX) -> ca.SX:
        return ca.mtimes(self.axes, local)

    @property
    def orientation(self) -> ca.SX:
        return self.e if self.rotates else ca.SX(list(rotation.IDENTITY))

    @property
    def turning(self) -> ca.SX:
        return self.turned(self.spin) if self.rotates else ca.SX.zeros(3)

    def velocity_at(self, place: ca.SX) -> ca.SX:
        return self.twist[:3] + ca.cross(self.turning, place - self.origin)

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        moment = self.turned(effort[3:6]) if self.rotates else ca.SX.zeros(3)
        return effort[:3], moment, self.origin

    # initial values ---------------------------------------------------------------------------
    def guesses(self) -> tuple[list, list]:
        position, orientation, velocity, spin = self.initial
        euler_parameters = ca.SX(list(rotation.IDENTITY)) if orientation is None else orientation.sx
        pose: list = [None] * 3
        twist: list = [None] * 3
        if position is not None:
            arm = ca.mtimes(rotation.matrix(euler_parameters), self.offset)
            pose = ca.vertsplit(position.sx + arm)
        if velocity is not None:
            turning = ca.SX.zeros(3) if spin is None else spin.sx
            twist = ca.vertsplit(velocity.sx + ca.cross(turning, self.turned(self.offset)))
        if self.rotates:
            pose += [None] * 4 if orientation is None else ca.vertsplit(euler_parameters)
            twist += [None] * 3 if spin is None else ca.vertsplit(ca.mtimes(self.axes.T, spin.sx))
        return pose, twist

    def specified(self) -> list[bool]:
        position, orientation, *_ = self.initial
        rotation = [orientation is not None] * 3 if self.rotates else []
        return [position is not None] * 3 + rotation

    def warnings(self) -> list[Condition]:
        return [] if self.initial[1] is None else self.initial[1].warnings

    def conditions(self) -> list[Condition]:
        rotation = [] if self.initial[1] is None else self.initial[1].conditions()
        return [*super().conditions(), *rotation]
