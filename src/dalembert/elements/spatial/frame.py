"""Frames in space: a place and Euler parameters, ``y = (r, e)``, with ``v = (ṙ, ω')``.

The angular velocity is that in axes of the frame (Ch. 2).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import rate_of, second_rate_of
from dalembert.elements.point import components
from dalembert.symbolic import rotation
from dalembert.symbolic.expression import Expression, stack, t

PLACE, SPIN = ("x", "y", "z"), ("turn_x", "turn_y", "turn_z")
EULER_PARAMETERS = ("e0", "e1", "e2", "e3")


class SpatialFrame(BodyElement):
    """What moves with a frame in space.

    Attributes
    ----------
    origin : SX symbols ``r``, of the mass centre of a rigid body
    e, axes : SX, Euler parameters and the axes as columns
    spin : SX symbols ``ω'``
    initial : position, orientation, velocity and angular velocity of the body's origin
    """

    dimension = 3
    initial_fields = ("position", "rotation", "velocity", "angular_velocity")
    initial: tuple[Any, Any, Any, Any]

    def _make_coordinates(self, others: tuple[str, ...] = ()) -> None:
        """Pose and twist; behind them other coordinates [m], whose rates are speeds."""
        turns, beside = 3 if self.rotates else 0, ("m",) * len(others)
        self.coordinate_names = PLACE + (EULER_PARAMETERS if turns else ()) + others
        self.coordinate_units = ("m",) * 3 + (("1",) * 4 if turns else ()) + beside
        self.speed_names = PLACE + SPIN[:turns] + others
        self.speed_units = ("m",) * 3 + ("rad",) * turns + beside
        self.rest = (0.0,) * 3 + (rotation.IDENTITY if turns else ()) + (0.0,) * len(others)
        self.pose = stack(ca.SX.sym(f"{self.name}.{n}") for n in self.coordinate_names)
        self._make_speeds()
        self.origin, self.e = self.pose[:3], self.pose[3 : 7 if turns else 3]
        self.spin = self.twist[3 : 3 + turns]
        self.axes = rotation.matrix(self.e) if turns else ca.SX.eye(3)
        turn = rotation.rate(self.e, self.spin) if turns else ca.SX(0, 1)
        self.pose_rate = ca.vertcat(self.twist[:3], turn, self.twist[3 + turns :])

    def motion_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Measures of the pose and its rates."""
        place = self.locate(ca.SX.zeros(3))
        velocity = rate_of(place, [self], t.sx)
        acceleration = second_rate_of(place, [self], t.sx)
        named = {
            "position": (place, "m"),
            "velocity": (velocity, "m/s"),
            "acceleration": (acceleration, "m/s^2"),
            **components("", place, "m"),
            **components("v", velocity, "m/s"),
            **components("a", acceleration, "m/s^2"),
        }
        if self.rotates:
            accelerated = self.acceleration_symbols[3:6]
            named |= {
                "euler_parameters": (self.e, "1"),
                "rotation": (ca.vec(self.axes.T), "1"),
                "bryant": (rotation.angles(self.axes, "xyz"), "rad"),
                "angular_velocity": (self.turning, "rad/s"),
                "angular_velocity_local": (self.spin, "rad/s"),
                "angular_acceleration": (ca.mtimes(self.axes, accelerated), "rad/s^2"),
            }
        return named

    def euler(self, sequence: str) -> Expression:
        """(3,) angles of turns about body axes that lead to its orientation, such as ``"zxz"``.

        The second is in [−π/2, π/2], of ``zxz`` and its like in [0, π]. At the ends of that range,
        the singular attitude, the first and the third are not determined and change fast nearby.

        Raises
        ------
        ModelError
            Other than three axes, or one twice in a row.
        """
        return Expression(rotation.angles(self.axes, sequence), f"{self.name}.{sequence}", "rad")

    # a manifold -------------------------------------------------------------------------------
    @property
    def flat(self) -> bool:
        return not self.rotates

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        moved = pose[:3] + displacement[:3]
        if not self.rotates:
            return moved
        turned = rotation.turned(pose[3:7], displacement[3:6])
        return ca.vertcat(moved, turned, pose[7:] + displacement[6:])

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        moved = other[:3] - pose[:3]
        if not self.rotates:
            return moved
        return ca.vertcat(moved, rotation.turn(pose[3:7], other[3:7]), other[7:] - pose[7:])

    def bounds(self, pose: ca.SX) -> ca.SX:
        return (ca.sumsqr(pose[3:7]) - 1) / 2 if self.rotates else ca.SX(0, 1)

    @contextmanager
    def enriched(self) -> Iterator[tuple[ca.SX, ca.SX]]:
        """By the axes, whose rates ``Ṙ = R ω̃'`` need no Euler parameters."""
        if not self.rotates:
            with super().enriched() as nothing:
                yield nothing
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
        """(3,) where ``r`` is in the body frame."""
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

    # the start --------------------------------------------------------------------------------
    def guesses(self) -> tuple[list, list]:
        position, orientation, velocity, angular_velocity = self.initial
        first = ca.SX(list(rotation.IDENTITY)) if orientation is None else orientation.sx
        arm = ca.mtimes(rotation.matrix(first), self.offset)
        spin = ca.SX.zeros(3) if angular_velocity is None else angular_velocity.sx
        swing = ca.cross(spin, self.turned(self.offset))
        pose = [None] * 3 if position is None else ca.vertsplit(position.sx + arm)
        twist = [None] * 3 if velocity is None else ca.vertsplit(velocity.sx + swing)
        if self.rotates:
            pose = [*pose, *([None] * 4 if orientation is None else ca.vertsplit(first))]
            local = ca.mtimes(self.axes.T, spin)
            twist = [*twist, *([None] * 3 if angular_velocity is None else ca.vertsplit(local))]
        return pose, twist

    def guessed(self) -> list[bool]:
        position, orientation, *_ = self.initial
        turns = [orientation is not None] * 3 if self.rotates else []
        return [position is not None] * 3 + turns

    def doubts(self) -> list[Condition]:
        return [] if self.initial[1] is None else self.initial[1].doubts

    def conditions(self) -> list[Condition]:
        turned = [] if self.initial[1] is None else self.initial[1].conditions()
        return [*super().conditions(), *turned]
