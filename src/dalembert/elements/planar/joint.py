"""Base classes of planar joints."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint
from dalembert.elements.body import BodyElement
from dalembert.elements.pair import Pair, PointJoint, need_body, refuse_same_body
from dalembert.elements.planar.body import Body
from dalembert.errors import ModelError


class InPlane:
    """Mixin of planar elements, placed before their other bases.

    Raises
    ------
    ModelError
        A body or a point is spatial.
    """

    def __post_init__(self) -> None:
        me: Any = self
        for field in dataclasses.fields(me):
            value = getattr(me, field.name)
            if getattr(value, "dimension", 2) > 2:
                body = getattr(value, "body", value)
                raise ModelError(
                    f"{field.name} ({body.name}) is in space, and {type(self).__name__} is a "
                    "planar element; use one of dalembert.spatial",
                    me.name,
                )
        super().__post_init__()  # type: ignore[misc]


@dataclasses.dataclass(eq=False)
class BetweenAngles(InPlane):
    """Mixin of elements between the angles of two bodies, placed before their other bases.

    Parameters
    ----------
    body_i, body_j : first and second body
    """

    body_i: Body
    body_j: Body

    def __post_init__(self) -> None:
        me: Any = self
        self.body_i = need_body(self.body_i, me.name, "body_i")
        self.body_j = need_body(self.body_j, me.name, "body_j")
        refuse_same_body(self.body_i, self.body_j, me.name)
        for body in self.ends():
            if not body.rotates:
                raise ModelError(f"{body.name} is a particle and has no angle", me.name)
        super().__post_init__()

    def ends(self) -> tuple[Body, Body]:
        """First and second body."""
        return self.body_i, self.body_j


@dataclass(eq=False)
class PinJoint(InPlane, PointJoint):
    """Constraint between points of two bodies, which may rotate relative to each other."""

    @property
    def turning(self) -> dict[str, tuple[ca.SX, str]]:
        """The relative rotation as a free motion, if both bodies rotate."""
        rotates = all(body.rotates for body in self.ends())
        return {"angle": (self.turn, "rad")} if rotates else {}

    @property
    def turn(self) -> ca.SX:
        """Angle of the second body relative to the first.

        Raises
        ------
        ModelError
            One of them is a particle.
        """
        for body in self.ends():
            if not body.rotates:
                raise ModelError(
                    f"{body.name} is a particle and has no angle; use a Body here", self.name
                )
        return self.point_j.body.pose_angle - self.point_i.body.pose_angle


@dataclass(eq=False)
class TreeJoint(PinJoint):
    """A joint that can carry a body: its constraint equations are also known explicitly.

    With the joint coordinates q and the open-constraint coordinates z of its equations (7.7),

        φ_j = φ_i + turn,      r_jP = r_iP + opening(q, z, φ_i),      Φ(y(q, z)) = z.
    """

    def carries(self, child: BodyElement) -> bool:
        """Whether it can carry a body; planar joints carry all planar bodies."""
        return isinstance(child, Body)

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        """Free coordinates except the rotation: name → (expression of the poses, unit)."""
        return {}

    def fixed_turn(self, z: ca.SX) -> ca.SX | None:
        """``φ_j − φ_i`` if the joint prescribes it; None if the rotation is free."""
        return None

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        """Vector from point_i to point_j, inertial axes."""
        raise NotImplementedError


@dataclass(eq=False)
class BodyJoint(BetweenAngles, Pair, Constraint):
    """Constraint between the angles of two bodies; its reaction is a couple."""

    def place(self) -> ca.SX:
        return self.body_j.pose_position

    def units(self) -> list[str]:
        return ["rad"]
