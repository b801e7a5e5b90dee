"""What planar joints share: the bodies they tie and the reaction between them."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates
from dalembert.elements.planar.body import Body, Point, cross
from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression


def need_point(value, owner: str, field: str) -> Point:
    """Check that a joint was given a point of a body."""
    if isinstance(value, Body):
        return value.center
    if not isinstance(value, Point):
        raise ModelError(
            f"{field} must be a point of a body, e.g. crank.point(0.1, 0.0); got {value!r}", owner
        )
    return value


def need_body(value, owner: str, field: str) -> Body:
    if not isinstance(value, Body):
        raise ModelError(f"{field} must be a body; got {value!r}", owner)
    return value


def refuse_same_body(body_i: Body, body_j: Body, owner: str) -> None:
    if body_i is body_j:
        raise ModelError(f"ties {body_i.name} to itself; connect two different bodies", owner)


class Pair:
    """Reaction of a two-body constraint, found by differentiating its equations.

    The joint exerts on its second body the generalised force ``−(∂Φ/∂y_j)ᵀ λ``: a force, and a
    moment that is moved from the mass centre to the joint point.
    """

    equations: ca.SX
    multiplier: ca.SX

    def ends(self) -> tuple[Body, Body]:
        """First and second body."""
        raise NotImplementedError

    def place(self) -> ca.SX:
        """Position of the joint point, where the reaction is reported."""
        raise NotImplementedError

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def reaction(self) -> tuple[ca.SX, ca.SX]:
        """Force (2,) [N] and moment [N m] on the second body at the joint point."""
        body = self.ends()[1]
        work = -ca.dot(self.multiplier, self.equations)
        wrench = ca.gradient(work, body.pose)
        force = wrench[:2]
        moment = wrench[2] if body.rotates else ca.SX(0)
        return force, moment - cross(self.place() - body.pose_position, force)


@dataclass(eq=False)
class PointJoint(Pair, Constraint):
    """Constraint between a point of one body and a point of another.

    Parameters
    ----------
    point_i, point_j : points of the first and the second body
    """

    point_i: Point
    point_j: Point

    def __post_init__(self) -> None:
        self.point_i = need_point(self.point_i, self.name, "point_i")
        self.point_j = need_point(self.point_j, self.name, "point_j")
        refuse_same_body(self.point_i.body, self.point_j.body, self.name)
        super().__post_init__()

    def ends(self) -> tuple[Body, Body]:
        return self.point_i.body, self.point_j.body

    def place(self) -> ca.SX:
        return self.point_j.position.sx

    @property
    def between(self) -> ca.SX:
        """Vector from the first to the second point, inertial axes."""
        return self.point_j.position.sx - self.point_i.position.sx

    @property
    def turning(self) -> dict[str, tuple[ca.SX, str]]:
        """The relative rotation as a free motion, where both bodies have one."""
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
class TreeJoint(PointJoint):
    """A joint that can carry a body: its constraint equations are known explicitly, too.

    With the joint coordinates q and the open-constraint coordinates z of its equations (7.7),

        φ_j = φ_i + turn,      r_jP = r_iP + opening(q, z, φ_i),      Φ(y(q, z)) = z.
    """

    def joint_coordinates(self) -> dict[str, tuple[ca.SX, str]]:
        """What it leaves free beside a turn: name → (expression of the poses, unit)."""
        return {}

    def fixed_turn(self, z: ca.SX) -> ca.SX | None:
        """``φ_j − φ_i`` where the joint prescribes it; None where the turn is free."""
        return None

    def opening(self, q: ca.SX, z: ca.SX, angle_i: ca.SX) -> ca.SX:
        """Vector from point_i to point_j, inertial axes."""
        raise NotImplementedError


@dataclass(eq=False)
class BodyJoint(Pair, Constraint):
    """Constraint between the angles of two bodies (the moment acts anywhere).

    Parameters
    ----------
    body_i, body_j : first and second body
    """

    body_i: Body
    body_j: Body

    def __post_init__(self) -> None:
        self.body_i = need_body(self.body_i, self.name, "body_i")
        self.body_j = need_body(self.body_j, self.name, "body_j")
        refuse_same_body(self.body_i, self.body_j, self.name)
        for body in (self.body_i, self.body_j):
            if not body.rotates:
                raise ModelError(f"{body.name} is a particle and has no angle", self.name)
        super().__post_init__()

    def ends(self) -> tuple[Body, Body]:
        return self.body_i, self.body_j

    def place(self) -> ca.SX:
        return self.body_j.pose_position

    def units(self) -> list[str]:
        return ["rad"]


def initial_value(expression: ca.SX, bodies: list[Body]) -> Expression:
    """A position-level expression at the bodies' given guesses (missing ones count as zero)."""
    symbols, values = [], []
    for body in dict.fromkeys(bodies):  # the carrier may be one of the ends
        guess, _ = body.guesses()
        for k in range(body.pose.numel()):
            symbols.append(body.pose[k])
            values.append(ca.SX(0) if guess[k] is None else guess[k])
    return Expression(ca.substitute(expression, ca.vertcat(*symbols), ca.vertcat(*values)))
