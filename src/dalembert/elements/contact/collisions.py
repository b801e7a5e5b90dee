"""Collisions of many balls with each other and with walls."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Element, Look, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Disc, Rail
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


@dataclass(frozen=True, eq=False)
class Ball:
    """A disc in the plane, or a ball in space, about a point of a body."""

    center: Point
    radius: Expression


@dataclass(frozen=True, eq=False)
class Wall:
    """A half-plane or half-space; the normal, in axes of its body, points into the free space."""

    point: Point
    normal: ca.SX


@dataclass(eq=False)
class Collisions(Element):
    """Unilateral contacts ``g ≥ 0`` of all pairs of balls, and of each ball with each wall.

    Newton's restitution and Coulomb's friction, as in ``Impact``. The number of gaps is that of
    pairs, of which few are active; ``solve_nonsmooth`` detects these in every step.

    Parameters
    ----------
    balls : pairs (body or point of a body, radius [m]); discs in the plane
    walls : pairs (point of a body or of the ground, normal in axes of that body)
    restitution : ``e`` along the normal, 0 to 1
    tangential : restitution of the slip, 0 to 1
    friction : ``μ``

    Raises
    ------
    ModelError
        No balls, an invalid pair, or a zero normal.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cradle")
    >>> left = system.add(planar.Particle("left", mass=1.0, position=(0, 0), velocity=(2, 0)))
    >>> right = system.add(planar.Particle("right", mass=1.0, position=(0.3, 0)))
    >>> balls = [(left.center, 0.1), (right.center, 0.1)]
    >>> hits = system.add(planar.Collisions("hits", balls, restitution=1.0))
    >>> motion = da.solve_nonsmooth(system.build(), 0.2, step=0.01)
    >>> motion["left.vx"][-1].item(), motion["right.vx"][-1].item()  # the speeds are exchanged
    (0.0, 2.0)
    """

    balls: Sequence[Any] = option("pairs of a body, or point of one, and a radius")
    walls: Sequence[Any] = option("pairs of a point and a normal", default=())
    restitution: Scalar = quantity("", "restitution along the normal", default=0.0, minimum=0.0)
    tangential: Scalar = quantity("", "restitution of the slip", default=0.0, minimum=0.0)
    friction: Scalar = quantity("", "coefficient of friction", default=0.0, minimum=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.balls = tuple(self._ball(k, pair) for k, pair in enumerate(self.balls))
        if not self.balls:
            raise ModelError("there are no balls; give pairs of a body and a radius", self.name)
        self.dimension: int = max(ball.center.body.dimension for ball in self.balls)
        self.walls = tuple(self._wall(k, pair) for k, pair in enumerate(self.walls))

    def _ball(self, number: int, pair: Any) -> Ball:
        field = f"balls[{number}]"
        body, radius = _pair(pair, f"{self.name}.{field}", "(body, radius)")
        center = need_point(body, self.name, field)
        return Ball(center, as_expression(radius, f"{self.name}.{field}.radius", "m"))

    def _wall(self, number: int, pair: Any) -> Wall:
        field = f"walls[{number}]"
        body, normal = _pair(pair, f"{self.name}.{field}", "(point, normal)")
        point = need_point(body, self.name, field, self.dimension)
        entity = f"{self.name}.{field}.normal"
        direction = as_expression(normal, entity, "", self.dimension).sx
        if direction.is_constant() and not float(ca.norm_2(direction)) > 0:
            raise ModelError("a normal needs a length; all its components are zero", entity)
        return Wall(point, direction / ca.norm_2(direction))

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        limits = {"unit": "m", "minimum": -math.inf, "above": 0.0}
        radii = [
            (f"{self.name}.balls[{k}].radius", ball.radius, limits)
            for k, ball in enumerate(self.balls)
        ]
        return super().checked_quantities() + radii

    def conditions(self) -> list[Condition]:
        coefficients = {"restitution": self.restitution.sx, "tangential": self.tangential.sx}
        return [
            (1 - e, f"{name} is {{}}; it must not be above 1", e)
            for name, e in coefficients.items()
        ]

    def parts(self) -> list[Coordinates]:
        bodies: dict[int, BodyElement] = {
            id(point.body): point.body
            for point in (*(b.center for b in self.balls), *(w.point for w in self.walls))
        }
        return list(bodies.values())

    def look(self) -> list[Look]:
        discs: list[Look] = [Disc(b.center, b.radius.sx) for b in self.balls]
        return discs + [self._floor(wall) for wall in self.walls] if self.dimension == 2 else []

    def _floor(self, wall: Wall) -> Rail:
        """A wall whose length follows from the motion of the balls along it."""
        tangent = ca.vertcat(-wall.normal[1], wall.normal[0])
        inertial = wall.point.body.turned(tangent)
        positions = (b.center.position.sx - wall.point.position.sx for b in self.balls)
        return Rail(wall.point, tangent, ca.vertcat(*(ca.dot(inertial, p[:2]) for p in positions)))


def _pair(pair: Any, entity: str, form: str) -> tuple[Any, Any]:
    if not isinstance(pair, (tuple, list)) or len(pair) != 2:
        raise ModelError(f"is {pair!r:.60}; give a pair {form}", entity)
    return pair[0], pair[1]
