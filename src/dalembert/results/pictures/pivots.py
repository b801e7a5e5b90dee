"""Positions of symbols of elements that act on bodies rather than points."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import Element
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Limit, Pin, SlotPin
from dalembert.elements.planar.body import Body, perpendicular, rotation
from dalembert.elements.point import Point

WALL_POSITION = 0.6
"""Relative position of the wall of a limited angle, from the axis to the far end of the body."""


class Pivots:
    """Centres of rotation of bodies, from the pins of a mechanism.

    Parameters
    ----------
    elements : constraints and forces
    """

    def __init__(self, elements: list[Element]):
        self.ends: dict[tuple[str, str], Point] = {}
        looks = [look for element in elements for look in element.look()]
        for look in looks:
            if isinstance(look, Pin | SlotPin) and isinstance(look.base, Point):
                for pin_point, base_point in ((look.point, look.base), (look.base, look.point)):
                    self.ends.setdefault((base_point.body.name, pin_point.body.name), pin_point)

    def between(self, body_i: BodyElement | None, body_j: BodyElement) -> Point:
        """The pin of two bodies, else that of one of them on the ground, else its mass centre."""
        base = body_i.name if body_i is not None else "ground"
        pairs = [(base, body_j.name), ("ground", body_j.name), ("ground", base)]
        pin = next((self.ends[pair] for pair in pairs if pair in self.ends), None)
        if pin is not None:
            return pin
        return body_i.center if body_j.name == "ground" and body_i is not None else body_j.center

    def wall(self, look: Limit, bodies: list[Body], reach: dict[str, float]) -> ca.SX | None:
        """Position (2,) of the wall that limits a coordinate, and its normal (2,) to the free side.

        The wall is where the last of the bodies that move the coordinate would touch it, at
        ``reach`` (by name) from the mass centre. None if no body moves the coordinate.
        """
        moving = [b for b in bodies if ca.jacobian(look.coordinate, b.pose).nnz()]
        if not moving:
            return None
        body, distance = moving[-1], look.value - look.coordinate
        sign = -1 if look.above else 1
        wall = straight_wall(look, body, reach.get(body.name, 0.0))
        if wall is not None or body.dimension == 3:
            return wall
        pivot = self.between(moving[0] if len(moving) > 1 else None, body).position.sx
        angle = distance / ca.jacobian(look.coordinate, body.pose_angle)
        arm = ca.mtimes(rotation(angle), self.far_point(body).position.sx - pivot)
        normal = sign * ca.jacobian(look.coordinate, body.pose_angle) * perpendicular(arm)
        return ca.vertcat(pivot + WALL_POSITION * arm, normal / ca.sqrt(ca.sumsqr(normal)))

    def far_point(self, body: Body) -> Point:
        """The point of a body that shows its rotation best."""
        points = list(body.points.values())
        pins = [p for (_, name), p in self.ends.items() if name == body.name]
        distant = [p for p in points if all(_differ(p, q) for q in pins)]
        return (distant or points or [body.center])[-1]


def straight_wall(look: Limit, body: Body, reach: float) -> ca.SX | None:
    """Position and normal (2d,) of the wall of a straight path; None for a rotation."""
    origin = body.pose_position if body.dimension == 2 else getattr(body, "origin", body.pose[:3])
    slope = ca.jacobian(look.coordinate, origin).T
    if not slope.nnz():
        return None
    size = ca.sumsqr(slope)
    normal = (-1 if look.above else 1) * slope / ca.sqrt(size)
    distance = look.value - look.coordinate
    arm = contact_arm(look, body, slope, -reach * normal)
    return ca.vertcat(origin + arm + slope * (distance / size), normal)


def contact_arm(look: Limit, body: Body, slope: ca.SX, otherwise: ca.SX) -> ca.SX:
    """Position of the contact point relative to the origin of a planar body.

    The moment of the normal force is the slope of the coordinate by the angle; that of the friction
    force, the slope of the slip by the angular velocity, determines the position along the normal.

    Parameters
    ----------
    slope : (2,) of the coordinate by the position of the body
    otherwise : position of a contact without moments; along the normal where there is no slip
    """
    if body.dimension == 3 or not body.rotates:
        return otherwise
    size, aside = ca.sumsqr(slope), perpendicular(slope)
    arm = otherwise - ca.jacobian(look.coordinate, body.pose_angle) / size * aside
    if look.slip is None:
        return arm
    along, turning = (ca.jacobian(look.slip, s) for s in (body.twist[:2], body.twist[2]))
    share = ca.mtimes(along, aside)
    if share.is_zero():
        return arm
    height = turning / share  # over the length of the slope
    return arm - ca.dot(otherwise, slope) / size * slope + height * slope


def _differ(p: Point, q: Point) -> bool:
    difference = p.local.sx - q.local.sx
    return not difference.is_constant() or float(ca.norm_2(difference)) > 0
