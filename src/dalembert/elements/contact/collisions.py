"""Unilateral contacts of many balls with each other and with walls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Element, Look, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.shapes import Flat, Round, Shape
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Rail
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Collisions(Element):
    """Unilateral contacts ``g ≥ 0`` of all pairs of balls, and of each ball with each wall.

    Newton's restitution and Coulomb's friction, as in ``Impact``. The number of gaps is that of
    pairs, of which few are active; ``solve_nonsmooth`` detects these in every step.

    Parameters
    ----------
    shapes : shapes of ``contact``: circles and half-planes, or spheres and half-spaces
    restitution : ``e`` along the normal, 0 to 1
    tangential : restitution of the slip, 0 to 1
    friction : ``μ``

    Raises
    ------
    ModelError
        No circle or sphere, or another shape.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cradle")
    >>> left = system.add(planar.Particle("left", mass=1.0, position=(0, 0), velocity=(2, 0)))
    >>> right = system.add(planar.Particle("right", mass=1.0, position=(0.3, 0)))
    >>> balls = [planar.contact.Circle(ball.center, 0.1) for ball in (left, right)]
    >>> hits = system.add(planar.Collisions("hits", balls, restitution=1.0))
    >>> motion = da.solve_nonsmooth(system.build(), 0.2, step=0.01)
    >>> motion["left.vx"][-1].item(), motion["right.vx"][-1].item()  # the speeds are exchanged
    (0.0, 2.0)
    """

    shapes: tuple[Shape, ...] = option("circles and half-planes, or spheres and half-spaces")
    restitution: Scalar = quantity("", "restitution along the normal", default=0.0, minimum=0.0)
    tangential: Scalar = quantity("", "restitution of the slip", default=0.0, minimum=0.0)
    friction: Scalar = quantity("", "coefficient of friction", default=0.0, minimum=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.shapes, Shape):
            self.shapes = (self.shapes,)
        self.shapes = tuple(self._shape(k, shape) for k, shape in enumerate(self.shapes))
        if not self.balls:
            raise ModelError(
                "there is no ball; give shapes such as contact.Circle(ball.center, 0.1)", self.name
            )
        self.dimension: int = max(ball.dimension for ball in self.balls)

    def _shape(self, number: int, shape: Shape) -> Shape:
        if not isinstance(shape, (Round, Flat)):
            raise ModelError(
                f"is {shape!r:.60}; give shapes such as contact.Circle(ball.center, 0.1) and "
                "contact.HalfPlane(ground.center)",
                f"{self.name}.shapes[{number}]",
            )
        if isinstance(shape, Flat):
            try:
                _ = shape.outward
            except ModelError as error:  # a zero normal
                entity = f"{self.name}.shapes[{number}].normal"
                raise ModelError(error.message, entity) from None
        return shape

    @property
    def balls(self) -> list[Round]:
        """Circles or spheres."""
        return [shape for shape in self.shapes if isinstance(shape, Round)]

    @property
    def walls(self) -> list[Flat]:
        """Half-planes or half-spaces."""
        return [shape for shape in self.shapes if isinstance(shape, Flat)]

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        quantities = [
            quantity
            for k, shape in enumerate(self.shapes)
            for quantity in shape.checked_quantities(f"{self.name}.shapes[{k}]")
        ]
        return [*super().checked_quantities(), *quantities]

    def conditions(self) -> list[Condition]:
        coefficients = {"restitution": self.restitution.sx, "tangential": self.tangential.sx}
        own: list[Condition] = [
            (1 - e, f"{name} is {{}}; it must not be above 1", e)
            for name, e in coefficients.items()
        ]
        return own + [condition for shape in self.shapes for condition in shape.conditions()]

    def parts(self) -> list[Coordinates]:
        bodies: dict[int, BodyElement] = {id(s.carrier): s.carrier for s in self.shapes}
        return list(bodies.values())

    def look(self) -> list[Look]:
        first = self.balls[0].point.position.sx
        balls = [part for ball in self.balls for part in ball.look(first)]
        if self.dimension == 2:
            return balls + [self._floor(wall) for wall in self.walls]
        return balls + [part for wall in self.walls for part in wall.look(first)]

    def _floor(self, wall: Flat) -> Rail:
        """A wall whose length follows from the motion of the balls along it."""
        (tangent,) = wall.along
        inertial = wall.carrier.turned(tangent)
        positions = (b.point.position.sx - wall.point.position.sx for b in self.balls)
        return Rail(wall.point, tangent, ca.vertcat(*(ca.dot(inertial, p[:2]) for p in positions)))
