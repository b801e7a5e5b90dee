"""Connections of two bodies: end points, reactions, constant distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint, Element, Look, Scalar, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.fem.nodal import NodeLike
from dalembert.elements.look import Mark, Rod
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, t


def need_point(value: Any, owner: str, field: str, dimension: int = 2) -> Point:
    """Check that an argument is a point of a body; a body or a node stands for its origin.

    Parameters
    ----------
    dimension : number of coordinates of the other point, if any
    """
    value = value.body if isinstance(value, NodeLike) else value
    if isinstance(value, BodyElement):
        refuse_floating_frame(value, owner, field)
        return Point(value, (0.0,) * max(value.dimension, dimension))
    if not isinstance(value, Point):
        raise ModelError(
            f"{field} must be a point of a body, e.g. crank.point(0.1, 0.0); got {value!r}", owner
        )
    return value


def need_body(value: Any, owner: str, field: str) -> Any:
    """Check that an argument is a body, or a node."""
    value = value.body if isinstance(value, NodeLike) else value
    if not isinstance(value, BodyElement):
        raise ModelError(f"{field} must be a body; got {value!r}", owner)
    refuse_floating_frame(value, owner, field)
    return value


def refuse_floating_frame(body: BodyElement, owner: str, field: str) -> None:
    """Refuse the floating frame of a flexible body with mean axes."""
    if not body.has_material_frame and body.owner is body:
        raise ModelError(
            f"{field} is the frame of {body.name}, which is not fixed to its material "
            f"(mean axes); take one of its sections, {body.name}.section(…), or give the body "
            "reference= an interface",
            owner,
        )


def refuse_same_body(body_i: BodyElement, body_j: BodyElement, owner: str) -> None:
    if body_i.owner is body_j.owner:
        raise ModelError(f"ties {body_i.name} to itself; connect two different bodies", owner)


def moment_of(arm: ca.SX, force: ca.SX) -> ca.SX:
    """``arm × force``, a scalar in the plane."""
    if force.numel() == 2:
        return arm[0] * force[1] - arm[1] * force[0]
    return ca.cross(arm, force)


@dataclass(eq=False)
class BetweenPoints(Element):
    """An element between two points.

    Parameters
    ----------
    point_i, point_j : points of the first and the second body
    """

    point_i: Point
    point_j: Point

    def __post_init__(self) -> None:
        space = max(getattr(end, "dimension", 2) for end in (self.point_i, self.point_j))
        self.point_i = need_point(self.point_i, self.name, "point_i", space)
        self.point_j = need_point(self.point_j, self.name, "point_j", space)
        refuse_same_body(self.point_i.body, self.point_j.body, self.name)
        self._check_dimension()
        super().__post_init__()

    def _check_dimension(self) -> None:
        i, j = self.point_i, self.point_j
        if i.dimension != j.dimension:
            planar = i if i.dimension == 2 else j
            raise ModelError(
                f"a point of {planar.body.name} lies in a plane and the other in space; give both "
                f"three coordinates, {planar.body.name}.point(x, y, z)",
                self.name,
            )

    def ends(self) -> tuple[Any, Any]:
        """First and second body."""
        return self.point_i.body, self.point_j.body

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    @property
    def end_points(self) -> tuple[Point, Point]:
        return self.point_i, self.point_j

    @property
    def between(self) -> ca.SX:
        """Vector from the first to the second point, inertial axes."""
        return self.point_j.position.sx - self.point_i.position.sx

    @property
    def distance(self) -> ca.SX:
        """Distance of the two points."""
        return ca.sqrt(ca.sumsqr(self.between))


class Pair:
    """Reaction of a two-body constraint from the virtual work of its equations.

    For a motion of its second body the joint has the power ``−λᵀ (Φ̇, Ψ)``: a generalised force by
    speeds, from which the force and the moment about the joint point follow.
    """

    equations: ca.SX
    slip: ca.SX
    multiplier: ca.SX

    def ends(self) -> tuple[Any, Any]:
        """First and second body."""
        raise NotImplementedError

    def place(self) -> ca.SX:
        """Position of the joint point, where the reaction is reported."""
        raise NotImplementedError

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def reaction(self) -> tuple[ca.SX, ca.SX]:
        """Force [N] and moment [N m] on the second body at the joint point."""
        first, second = self.ends()
        if first.dimension > second.dimension:  # the planar body carries the planar components only
            force, moment = self._action_on(first)
            return -force, -moment
        return self._action_on(second)

    def _action_on(self, body: Any) -> tuple[ca.SX, ca.SX]:
        rates = ca.vertcat(rate_of(self.equations, [body], t.sx), self.slip)
        power = -ca.dot(self.multiplier, rates)
        force, moment, origin = body.wrench(ca.gradient(power, body.twist))
        return force, moment - moment_of(self.place()[: origin.numel()] - origin, force)


@dataclass(eq=False)
class PointJoint(BetweenPoints, Pair, Constraint):
    """Constraint between a point of one body and a point of another."""

    def look(self) -> list[Look]:
        return [Mark(self.point_j, self.point_i)]

    def place(self) -> ca.SX:
        return self.point_j.position.sx


def initial_value(expression: ca.SX, bodies: Sequence[BodyElement]) -> Expression:
    """A position-level expression at the initial guesses of bodies, at the origin without one."""
    symbols, values = [], []
    for body in dict.fromkeys(b.owner for b in bodies):  # the carrier may be one of the ends
        expression = ca.substitute(expression, *body.followers)
        pose = ca.vertsplit(body.pose)[: len(body.rest)]
        for symbol, guess, rest in zip(pose, body.guesses()[0], body.rest, strict=True):
            symbols.append(symbol)
            values.append(ca.SX(rest) if guess is None else guess)
    return Expression(ca.substitute(expression, ca.vertcat(*symbols), ca.vertcat(*values)))


@dataclass(eq=False)
class ConstantDistance(PointJoint):
    """Constant distance between two points, ``Φ = |r_jP − r_iP| − length``.

    The multiplier is the force in the link [N], positive in tension.

    Parameters
    ----------
    length : distance of the points [m]
    """

    length: Scalar = quantity("m", "distance of the two points", above=0.0, keyword=True)

    def residual(self) -> ca.SX:
        distance, length = self.measured_and_target()
        return distance - length

    def look(self) -> list[Look]:
        return [Rod(self.point_i, self.point_j)]

    def measured_and_target(self) -> tuple[ca.SX, ca.SX]:
        return self.distance, self.length.sx
