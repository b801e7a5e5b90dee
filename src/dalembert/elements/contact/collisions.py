"""Contacts among many shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Element, Look, Scalar, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.component import Component
from dalembert.elements.contact.hull import Boundary, Solid
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.pairs import (
    COEFFICIENTS,
    RETURNS,
    Pair,
    check_law,
    checked_pairs,
    force_laws,
    law_numbers,
    returns,
)
from dalembert.elements.contact.shapes import Flat, Round, Shape, Vertex
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Rail
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

EXAMPLE = "contact.Circle(ball.center, 0.1), contact.HalfPlane(ground)"
EXAMPLES = {3: "contact.Sphere(ball.center, 0.1), contact.HalfSpace(ground.frame())"}


@dataclass(eq=False)
class Collisions(Element):
    """Contacts among all shapes of different bodies, with Coulomb's friction.

    Without a law, contacts are rigid: ``g ≥ 0``, with restitution. With one, they have its force
    ``N(δ, δ̇)`` at the penetration ``δ = −g``, each contact point the whole force. Two shapes touch
    at one point, or at several where edges or faces are parallel. ``solve_nonsmooth`` detects near
    pairs in every step.

    Parameters
    ----------
    shapes : shapes of ``contact``, points of bodies; or lists of these by the names of groups
    restitution : ``e`` along the normal, 0 to 1
    tangential : restitution of the slip, 0 to 1
    friction : ``μ``
    static_friction : ``μ_s ≥ μ`` of contacts without slip; ``friction`` by default
    rolling : coefficient ``c`` of rolling friction, a moment up to ``c N`` across the normal
    spinning : the same about the normal, in space
    impact_law : meaning of ``restitution``: a ratio of speeds, "newton"; of impulses, "poisson"; or
        its square of work, "energetic"
    law : normal force law such as ``contact.HuntCrossley``, instead of ``restitution`` and
        ``tangential``; None for rigid contacts
    pairs : other coefficients and laws between two groups, or groups that do not touch:
        ``contact.Pair``

    Raises
    ------
    ModelError
        No shape, a shape that is not available, an unknown group, spinning in the plane, or a law
        beside restitution.

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
    >>> [round(motion[f"{name}.vx"][-1].item(), 9) for name in ("left", "right")]  # exchanged
    [0.0, 2.0]
    """

    shapes: tuple[Shape, ...] | dict[str, tuple[Shape, ...]] = option(
        "shapes, or lists of shapes by the names of groups"
    )
    restitution: Scalar = quantity("", "restitution along the normal", default=0.0, minimum=0.0)
    tangential: Scalar = quantity("", "restitution of the slip", default=0.0, minimum=0.0)
    friction: Scalar = quantity("", "coefficient of friction", default=0.0, minimum=0.0)
    rolling: Scalar = quantity("m", "coefficient of rolling friction", default=0.0, minimum=0.0)
    spinning: Scalar = quantity("m", "coefficient of spinning friction", default=0.0, minimum=0.0)
    static_friction: Scalar = quantity(
        "", "coefficient of friction without slip", default=None, minimum=0.0
    )
    impact_law: str = option("`newton`, `poisson` or `energetic`", default="newton")
    law: NormalLaw | Restitution | None = option(
        "normal force law, or restitution of rigid contacts", default=None
    )
    pairs: tuple[Pair, ...] = option("laws between two groups", default=())

    def __post_init__(self) -> None:
        super().__post_init__()
        grouped = self.shapes if isinstance(self.shapes, Mapping) else {"": self.shapes}
        self.groups: dict[str, tuple[Shape, ...]] = {
            group: self._shapes(self._label(group), shapes) for group, shapes in grouped.items()
        }
        self._check_shapes()
        self.dimension: int = self.members[0].dimension
        self.pairs = checked_pairs(self.pairs, list(self.groups), self.name)
        self._check_laws()

    def _label(self, group: str) -> str:
        return f"{self.name}.shapes.{group}" if group else f"{self.name}.shapes"

    def _shapes(self, label: str, shapes: Shape | tuple[Shape, ...]) -> tuple[Shape, ...]:
        listed = shapes if isinstance(shapes, (list, tuple)) else (shapes,)
        return tuple(self._shape(f"{label}[{k}]", shape) for k, shape in enumerate(listed))

    def _shape(self, entity: str, shape: Shape | Point | BodyElement) -> Shape:
        if isinstance(shape, (Point, BodyElement)):
            shape = Vertex(need_point(shape, entity, "point"))
        if not isinstance(shape, Shape):
            raise ModelError(f"is {shape!r:.60}; give shapes such as {EXAMPLE}", entity)
        if isinstance(shape, Flat):
            try:
                _ = shape.outward
            except ModelError as error:  # a zero normal
                raise ModelError(error.message, f"{entity}.normal") from None
        elif not takes(type(shape)):
            raise ModelError(
                f"a {type(shape).__name__} is not available here; give shapes such as "
                f"{EXAMPLES.get(shape.dimension, EXAMPLE)}, or use Contact",
                entity,
            )
        return shape

    def _check_shapes(self) -> None:
        for group, shapes in (self.groups or {"": ()}).items():
            if not shapes:
                raise ModelError(f"there are no shapes; give {EXAMPLE}", self._label(group))
        first, bodies = self.members[0], {shape.carrier.name for shape in self.members}
        if not self.hulls and not self.boundaries and len(bodies) != 1:
            example = EXAMPLES.get(first.dimension, EXAMPLE)
            raise ModelError(f"there is no ball nor another shape; give {example}", self.name)
        for shape in self.members:
            if shape.dimension != first.dimension:
                planar, other = sorted((first, shape), key=lambda s: s.dimension)
                raise ModelError(
                    f"the {type(planar).__name__} of {planar.carrier.name} lies in a plane and the "
                    f"{type(other).__name__} of {other.carrier.name} in space; give both the same "
                    "number of coordinates",
                    self.name,
                )

    def _check_laws(self) -> None:
        names = [law.value for law in ImpactLaw]
        for place, law in self._completed_laws.items():
            entity = f"{self.name}.{place}" if place else self.name
            if law["impact_law"] not in names:
                text = unknown("law", law["impact_law"], names)
                raise ModelError(text, f"{entity}.impact_law")
            if self.dimension == 2 and not law["spinning"].sx.is_zero():
                text = "nothing spins about a normal in the plane; leave out spinning="
                raise ModelError(text, f"{entity}.spinning")
            impact = ImpactLaw(law["impact_law"])
            if impact is not ImpactLaw.NEWTON and not law["tangential"].sx.is_zero():
                raise ModelError(
                    f"the {impact.value} law of impact has no restitution of the slip; leave "
                    "out tangential=, or impact_law=",
                    f"{entity}.tangential",
                )
        rigid = [name for name in RETURNS if not getattr(self, name).sx.is_zero()]
        check_law(self.name, self.law, rigid)
        other = [law.value for law in self.impact_laws if law is not ImpactLaw.NEWTON]
        if any(self.force_laws) and other:
            text = f"is {other[0]!r}, and a force law has no impacts; leave it out"
            raise ModelError(text, f"{self.name}.impact_law")

    @property
    def impact_laws(self) -> list[ImpactLaw]:
        """Law of impact of each law number."""
        return [ImpactLaw(law["impact_law"]) for law in self._completed_laws.values()]

    @cached_property
    def force_laws(self) -> tuple[NormalLaw | None, ...]:
        """Force law of each law number; None for rigid contacts."""
        return force_laws(self.law, self.pairs, self.name)

    @cached_property
    def members(self) -> tuple[Shape, ...]:
        """Shapes of all groups."""
        return tuple(shape for shapes in self.groups.values() for shape in shapes)

    @cached_property
    def hulls(self) -> list[tuple[Shape, Solid]]:
        """Shapes, and their convex parts."""
        return [(shape, solid) for shape in self.members for solid in shape.solids()]

    @cached_property
    def boundaries(self) -> list[tuple[Shape, Boundary]]:
        """Shapes that may be concave, and their boundaries."""
        boundaries = ((shape, shape.boundary()) for shape in self.members)
        return [(shape, boundary) for shape, boundary in boundaries if boundary is not None]

    @property
    def balls(self) -> list[Round]:
        """Circles or spheres."""
        return [shape for shape in self.members if isinstance(shape, Round)]

    @property
    def walls(self) -> list[Flat]:
        """Half-planes or half-spaces."""
        return [shape for shape in self.members if isinstance(shape, Flat)]

    @property
    def coefficients(self) -> ca.SX:
        """(c, n) ``COEFFICIENTS`` of each law."""
        laws = [
            law | {"impact_law": Expression(ca.SX(ImpactLaw(law["impact_law"]).number))}
            for law in self._completed_laws.values()
        ]
        return ca.horzcat(*(ca.vertcat(*(law[c].sx for c in COEFFICIENTS)) for law in laws))

    @property
    def _completed_laws(self) -> dict[str, dict[str, Any]]:
        """Place of each law in the element → its coefficients by their names."""
        own = {name: getattr(self, name) for name in COEFFICIENTS} | returns(self.law)
        if self.static_friction is None:
            own["static_friction"] = self.friction
        pairs = {f"pairs[{k}]": pair.completed(own) for k, pair in enumerate(self.pairs)}
        return {"": own, **pairs}

    @cached_property
    def friction_groups(self) -> tuple[int, ...]:
        """Widths of tangential components: slip; with friction of rotations, rolling, spinning."""
        slip, turns = self.dimension - 1, not self.coefficients[5:, :].is_zero()
        rotations = (slip, 1)[:slip]
        return (slip, *rotations) if turns else (slip,)

    @cached_property
    def laws(self) -> np.ndarray:
        """(groups, groups) number of the law, ``APART`` for groups that do not touch."""
        return law_numbers(list(self.groups), self.pairs)

    def group_of(self, shapes: list) -> np.ndarray:
        """(n,) numbers of the groups of some of its shapes."""
        group = {id(s): k for k, shapes in enumerate(self.groups.values()) for s in shapes}
        return np.array([group[id(shape)] for shape in shapes], dtype=int)

    @property
    def components(self) -> dict[str, Component]:
        """Place of each shape, pair and law → the component."""
        shapes: dict[str, Component] = {
            f"{self._label(group)}[{k}]": shape
            for group, shapes in self.groups.items()
            for k, shape in enumerate(shapes)
        }
        pairs = {f"{self.name}.pairs[{k}]": pair for k, pair in enumerate(self.pairs)}
        laws = {self.name: self.law, **{place: pair.law for place, pair in pairs.items()}}
        return shapes | pairs | {f"{at}.law": law for at, law in laws.items() if law is not None}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        quantities = [
            quantity
            for entity, part in self.components.items()
            for quantity in part.checked_quantities(entity)
        ]
        return [*super().checked_quantities(), *quantities]

    def conditions(self) -> list[Condition]:
        coefficients = {"restitution": self.restitution.sx, "tangential": self.tangential.sx}
        conditions: list[Condition] = [
            (1 - e, f"{name} is {{}}; it must not be above 1", e)
            for name, e in coefficients.items()
        ]
        for place, law in self._completed_laws.items():
            static, sliding = law["static_friction"].sx, law["friction"].sx
            text = "static_friction is {}; it must not be below friction"
            conditions.append((static - sliding, f"{place}: {text}" if place else text, static))
        for entity, part in self.components.items():
            place = entity.removeprefix(f"{self.name}.")
            conditions += [_placed(condition, place) for condition in part.conditions()]
        return conditions

    def parts(self) -> list[Coordinates]:
        return list(dict.fromkeys(body for shape in self.members for body in shape.bodies))

    def look(self) -> list[Look]:
        places = [s.carrier.locate(corner) for _, s in self.hulls for corner in s.hull.corners]
        places += [shape.carrier.locate(ca.SX.zeros(2)) for shape, _ in self.boundaries]
        shapes = [shape for shape in self.members if not isinstance(shape, Flat)]
        parts = [part for shape in shapes for part in shape.look(places[0])]
        if self.dimension == 2:
            return parts + [self._floor(wall, places) for wall in self.walls]
        near = ca.horzcat(*(s.carrier.locate(s.hull.corners[0]) for _, s in self.hulls))
        return parts + [part for wall in self.walls for part in wall.look(near)]

    def _floor(self, wall: Flat, places: list[ca.SX]) -> Rail:
        """A wall whose length follows from the motion of the shapes along it."""
        (tangent,) = wall.along
        inertial, origin = wall.carrier.turned(tangent), wall.point.position.sx
        travels = [ca.dot(inertial, (place - origin)[:2]) for place in places]
        return Rail(wall.point, tangent, ca.vertcat(*travels))


def takes(kind: type[Shape]) -> bool:
    """Whether shapes of a class take part in collisions."""
    solid = kind.hull is not Shape.hull or kind.solids is not Shape.solids
    return solid or kind.boundary is not Shape.boundary or issubclass(kind, Flat)


def _placed(condition: Condition, place: str) -> Condition:
    """The condition with a place in its message, which is a format where values follow."""
    if len(condition) == 2:
        return condition[0], f"{place}: {condition[1]}"
    escaped = place.replace("{", "{{").replace("}", "}}")
    return condition[0], f"{escaped}: {condition[1]}", condition[2]
