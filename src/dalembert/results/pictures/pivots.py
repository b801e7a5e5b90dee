"""Where things are drawn that elements tie to bodies and not to points."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.look import Limit, Pin, SlotPin
from dalembert.elements.planar.body import Body, perpendicular, rotation
from dalembert.elements.point import Point

ALONG_ARM = 0.6
"""Where the wall of a limited angle stands between the axis and the far end of the body."""


class Pivots:
    """The points on which bodies turn, from the pins of a mechanism.

    Parameters
    ----------
    elements : constraints and forces
    """

    def __init__(self, elements: list[Any]):
        self.ends: dict[tuple[str, str], Any] = {}
        looks = [look for element in elements for look in element.look()]
        for look in looks:
            if isinstance(look, Pin | SlotPin) and isinstance(look.base, Point):
                for one, other in ((look.point, look.base), (look.base, look.point)):
                    self.ends.setdefault((other.body.name, one.body.name), one)

    def between(self, body_i: Any, body_j: Any) -> Point:
        """The pin of two bodies; else that of one of them on the ground; else its mass centre."""
        base = body_i.name if body_i is not None else "ground"
        pairs = [(base, body_j.name), ("ground", body_j.name), ("ground", base)]
        found = next((self.ends[pair] for pair in pairs if pair in self.ends), None)
        if found is not None:
            return found
        return body_i.center if body_j.name == "ground" and body_i is not None else body_j.center

    def wall(self, look: Limit, bodies: list[Body], reach: dict[str, float]) -> ca.SX | None:
        """Place (2,) of the wall at which a coordinate ends, and its normal (2,) to the free side.

        It stands where the last of the bodies that move the coordinate would meet it, at its
        ``reach`` from the mass centre by name. None if none moves it.
        """
        moving = [b for b in bodies if ca.jacobian(look.coordinate, b.pose).nnz()]
        if not moving:
            return None
        body, short = moving[-1], look.value - look.coordinate
        sense = -1 if look.above else 1
        met = straight(look, body, reach.get(body.name, 0.0))
        if met is not None or body.dimension == 3:
            return met
        pivot = self.between(moving[0] if len(moving) > 1 else None, body).position.sx
        turn = short / ca.jacobian(look.coordinate, body.pose_angle)
        arm = ca.mtimes(rotation(turn), self.far(body).position.sx - pivot)
        normal = sense * ca.jacobian(look.coordinate, body.pose_angle) * perpendicular(arm)
        return ca.vertcat(pivot + ALONG_ARM * arm, normal / ca.sqrt(ca.sumsqr(normal)))

    def far(self, body: Body) -> Point:
        """The point of a body that shows best how it turns."""
        named = list(body.points.values())
        own = [p for (_, name), p in self.ends.items() if name == body.name]
        away = [p for p in named if all(_apart(p, q) for q in own)]
        return (away or named or [body.center])[-1]


def straight(look: Limit, body: Any, reach: float) -> ca.SX | None:
    """Place and normal (2d,) of the wall that a body meets on a straight way; None if it turns."""
    origin = body.pose_position if body.dimension == 2 else getattr(body, "origin", body.pose[:3])
    slope = ca.jacobian(look.coordinate, origin).T
    if not slope.nnz():
        return None
    size = ca.sumsqr(slope)
    normal = (-1 if look.above else 1) * slope / ca.sqrt(size)
    short = look.value - look.coordinate
    return ca.vertcat(origin + slope * (short / size) - reach * normal, normal)


def _apart(p: Point, q: Point) -> bool:
    difference = p.local.sx - q.local.sx
    return not difference.is_constant() or float(ca.norm_2(difference)) > 0
