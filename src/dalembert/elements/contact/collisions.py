"""Many balls that do not pass through each other, nor through walls."""

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
    """A half-plane or half-space; the normal, in axes of its body, points to where things are."""

    point: Point
    normal: ca.SX


@dataclass(eq=False)
class Collisions(Element):
    """Every two of many balls, and each of them and every wall, keep apart: ``g ≥ 0``.

    Newton's restitution and Coulomb's friction, as in ``Impact``. There are as many gaps as pairs,
    of which few matter at a time; ``solve_nonsmooth`` looks for these in every step.

    Parameters
    ----------
    balls : pairs (body or point of a body, radius [m]); discs in the plane
    walls : pairs (point of a body or of the ground, normal in axes of that body)
    restitution : ``e`` along the normal, 0 to 1
    tangential : of the slip, 0 to 1
    friction : ``μ``

    Raises
    ------
    ModelError
        No ball, a wrong pair, or a normal without length.

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
    >>> motion["left.vx"][-1].item(), motion["right.vx"][-1].item()  # they swap speeds
    (0.0, 2.0)
    """

    balls: Sequence[Any] = option("pairs of a body, or point of one, and a radius")
    walls: Sequence[Any] = option("pairs of a point and a normal", default=())
    restitution: Scalar = quantity("", "restitution along the normal", default=0.0, minimum=0.0)
    tangential: Scalar = quantity("", "restitution of the slip", default=0.0, minimum=0.0)
    friction: Scalar = quantity("", "coefficient of friction", default=0.0, minimum=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.balls = tuple(self._ball(k, given) for k, given in enumerate(self.balls))
        if not self.balls:
            raise ModelError("there are no balls; give pairs of a body and a radius", self.name)
        self.dimension: int = max(ball.center.body.dimension for ball in self.balls)
        self.walls = tuple(self._wall(k, given) for k, given in enumerate(self.walls))

    def _ball(self, number: int, given: Any) -> Ball:
        field = f"balls[{number}]"
        holder, radius = _pair(given, f"{self.name}.{field}", "(body, radius)")
        center = need_point(holder, self.name, field)
        return Ball(center, as_expression(radius, f"{self.name}.{field}.radius", "m"))

    def _wall(self, number: int, given: Any) -> Wall:
        field = f"walls[{number}]"
        holder, normal = _pair(given, f"{self.name}.{field}", "(point, normal)")
        point = need_point(holder, self.name, field, self.dimension)
        spoken = f"{self.name}.{field}.normal"
        way = as_expression(normal, spoken, "", self.dimension).sx
        if way.is_constant() and not float(ca.norm_2(way)) > 0:
            raise ModelError("a normal needs a length; all its components are zero", spoken)
        return Wall(point, way / ca.norm_2(way))

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        of_radii = {"unit": "m", "minimum": -math.inf, "above": 0.0}
        radii = [
            (f"{self.name}.balls[{k}].radius", ball.radius, of_radii)
            for k, ball in enumerate(self.balls)
        ]
        return super().checked_quantities() + radii

    def conditions(self) -> list[Condition]:
        shares = {"restitution": self.restitution.sx, "tangential": self.tangential.sx}
        return [(1 - e, f"{name} is {{}}; it must not be above 1", e) for name, e in shares.items()]

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
        """A wall as long as the balls go along it."""
        along = ca.vertcat(-wall.normal[1], wall.normal[0])
        inertial = wall.point.body.turned(along)
        places = (b.center.position.sx - wall.point.position.sx for b in self.balls)
        return Rail(wall.point, along, ca.vertcat(*(ca.dot(inertial, p[:2]) for p in places)))


def _pair(given: Any, spoken: str, wanted: str) -> tuple[Any, Any]:
    if not isinstance(given, (tuple, list)) or len(given) != 2:
        raise ModelError(f"is {given!r:.60}; give a pair {wanted}", spoken)
    return given[0], given[1]
