"""Contact of two shapes, and joints with clearance."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import (
    Condition,
    Constraint,
    Look,
    Rate,
    Scalar,
    option,
    quantity,
)
from dalembert.elements.body import BodyElement
from dalembert.elements.component import Component
from dalembert.elements.contact.beam_line import BeamLine
from dalembert.elements.contact.beam_surface import BeamSurface
from dalembert.elements.contact.compliant import Compliant
from dalembert.elements.contact.contact_point import ContactPoint
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.shapes import Hollow, Round, Shape, Vertex
from dalembert.elements.contact.unilateral import Gap, Impact
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.pair import BetweenPoints, need_point
from dalembert.elements.point import Point
from dalembert.elements.states import States
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


def contact_points(shape_i: Shape, shape_j: Shape, owner: str) -> list[ContactPoint]:
    """All potential contact points of two shapes.

    Raises
    ------
    ModelError
        The contact of these two shapes is not implemented.
    """
    points: list[ContactPoint] = []
    if isinstance(shape_j, shape_i.feels):
        points += shape_i.contact_points(shape_j, owner)
    if isinstance(shape_i, shape_j.feels) and (not points or shape_i.mutual):
        points += [point.reversed() for point in shape_j.contact_points(shape_i, owner)]
    if not points:
        i, j = (type(shape).__name__ for shape in (shape_i, shape_j))
        pairs = ", ".join(supported_pairs(shape_i.dimension))
        raise ModelError(f"no contact of {i} and {j} is available; there are {pairs}", owner)
    return points


def _passages(line: BeamLine, other: Shape) -> list[Condition]:
    """Condition that a round shape, or a beam in space, cannot pass between stations of a beam."""
    beam = line.beam
    if not isinstance(other, Round | BeamSurface):
        return []
    if isinstance(other, BeamSurface) and other.dimension == 2:
        return []
    spacing = beam.length.sx / (beam.elements * int(line.stations or 1))
    across = 2 * (line.radius.sx + other.radius.sx)
    text = (
        f"the stations of the BeamLine on {beam.name} are {{:.3g}} m apart, and the "
        f"{type(other).__name__} may pass between them, as both together are {{:.3g}} m across; "
        f"use more stations, a BeamSurface of {beam.name}, or Collisions"
    )
    return [(across - spacing, text, ca.vertcat(spacing, across))]


def supported_pairs(dimension: int) -> list[str]:
    """The pairs of shapes whose contact is implemented, planar or spatial."""
    kinds = [kind for kind in _final_classes(Shape) if kind.space in (0, dimension)]
    pairs = {
        frozenset((surface, other)): f"{surface.__name__}–{other.__name__}"
        for surface in kinds
        for other in kinds
        if issubclass(other, surface.feels)
    }
    return list(pairs.values())


def _final_classes(kind: type[Shape]) -> list[type[Shape]]:
    """The subclasses of a class that have no subclasses."""
    final = [last for subclass in kind.__subclasses__() for last in _final_classes(subclass)]
    return list(dict.fromkeys(final)) or [kind]


EXAMPLES = {"law": "contact.Hertz(stiffness=1e8)", "friction": "contact.Coulomb(0.3)"}


@dataclass(eq=False)
class ShapeContact(Compliant):
    """Contact of the two ``shapes`` of a subclass, with a normal force law and friction.

    Parameters
    ----------
    law : normal force law, or restitution
    friction : friction law; none by default
    """

    law: NormalLaw | Restitution = option("normal force law, or restitution", keyword=True)
    friction: Friction | None = option("friction law", default=None, keyword=True)

    def __post_init__(self) -> None:
        self._check("law", isinstance(self.law, (NormalLaw, Restitution)))
        self._check("friction", self.friction is None or isinstance(self.friction, Friction))
        super().__post_init__()
        i, j = self.shapes
        if [b.owner for b in i.bodies] == [b.owner for b in j.bodies]:
            raise ModelError(
                f"ties {i.carrier.name} to itself; connect two different bodies", self.name
            )
        if i.dimension != j.dimension:
            planar = i if i.dimension == 2 else j
            raise ModelError(
                f"the {type(planar).__name__} of {planar.carrier.name} lies in a plane and the "
                "other shape in space; give both the same number of coordinates",
                self.name,
            )
        self.contact_points: list[ContactPoint] = contact_points(i, j, self.name)
        self.bristles = self._bristles()

    def _bristles(self) -> list[States]:
        """States of the friction law, one group per gap; empty if the law has none."""
        return [group for k in range(len(self._gaps)) if (group := self._bristles_of(k))]

    def _bristles_of(self, k: int) -> States | None:
        """Deflections of the bristles of a gap."""
        gap, friction = self._gaps[k], self.friction
        count = gap.slip.numel()
        if friction is None or friction.state_rate(gap.slip, ca.SX.sym("z", count)) is None:
            return None

        def rates() -> ca.SX:
            rate = friction.state_rate(gap.slip, group.pose)
            return ca.SX(0, 1) if rate is None else rate

        names = ("z",) if count == 1 else [f"z{i + 1}" for i in range(count)]
        group = States(f"{self.name}.bristles{k + 1}", names, [""] * count, rates)
        return group

    def _check(self, field: str, valid: bool) -> None:
        if not valid:
            value, example = getattr(self, field), EXAMPLES[field]
            raise ModelError(f"{field} must be one such as {example}; got {value!r}", self.name)

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        """Shapes of the first and the second body."""
        raise NotImplementedError

    def parts(self) -> list[Coordinates]:
        feet = [c for foot in self.own_constraints() for c in foot.own_coordinates()]
        bodies = [body for shape in self.shapes for body in shape.bodies]
        return [*dict.fromkeys(bodies), *feet, *self.bristles]

    def own_coordinates(self) -> list[Coordinates]:
        return list(self.bristles)

    def states(self) -> Iterable[ca.SX]:
        return (group.pose for group in self.bristles) if self.bristles else super().states()

    def own_constraints(self) -> list[Constraint]:
        return [point.foot for point in self.contact_points if point.foot is not None]

    def components_by_field(self) -> dict[str, Component]:
        laws = {"law": self.law, "friction": self.friction}
        return {field: law for field, law in laws.items() if law is not None}

    def normal_law(self) -> NormalLaw | None:
        return self.law if isinstance(self.law, NormalLaw) else None

    def friction_law(self) -> Friction | None:
        return self.friction

    @cached_property
    def _gaps(self) -> list[Gap]:
        rigid = isinstance(self.law, Restitution)
        slips = [p.surface_slip if rigid else p.slip for p in self.contact_points]
        return [
            Gap(p.distance, slip, p.weight)
            for p, slip in zip(self.contact_points, slips, strict=True)
        ]

    def gaps(self, rate: Rate) -> list[Gap]:
        return self._gaps

    def impact(self) -> Impact | None:
        if not isinstance(self.law, Restitution):
            return None
        coefficient = ca.SX(0) if self.friction is None else self.friction.sliding_coefficient()
        return Impact(self.law.e.sx, self.law.tangential.sx, coefficient)

    def warnings(self) -> list[Condition]:
        pairs = self.shapes, self.shapes[::-1]
        lines = [(line, other) for line, other in pairs if isinstance(line, BeamLine)]
        return [condition for pair in lines for condition in _passages(*pair)]

    def look(self) -> list[Look]:
        places = ca.horzcat(*(point.place for point in self.contact_points))
        return [part for shape in self.shapes for part in shape.look(places)]


@dataclass(eq=False)
class Contact(ShapeContact):
    """Contact of two shapes with a normal force and friction, and no adhesion.

    At every contact point the law of the penetration and its rate gives ``N`` along the normal, and
    the friction law ``T`` along the surface, with opposite signs on the two bodies, halfway between
    the surfaces. With a ``Restitution`` the contact is rigid and has no force law.

    Parameters
    ----------
    shape_i, shape_j : shapes of two bodies; a point of a body is a ``Vertex``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ball on the floor", gravity=(0, -10))
    >>> ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, position=(0, 0.1)))
    >>> floor = planar.contact.HalfPlane(system.ground.center)
    >>> rim = planar.contact.Circle(ball.center, 0.1)
    >>> law = planar.contact.KelvinVoigt(stiffness=1e4, damping=100.0)
    >>> touch = system.add(planar.Contact("touch", floor, rim, law=law))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=1e-3)
    >>> round(motion["ball.y"][-1].item(), 6)  # radius minus m g/k
    0.099
    """

    shape_i: Shape = option("shape of the first body")
    shape_j: Shape = option("shape of the second body")

    def __post_init__(self) -> None:
        self.shape_i, self.shape_j = self._shape("shape_i"), self._shape("shape_j")
        super().__post_init__()

    def _shape(self, field: str) -> Shape:
        shape = getattr(self, field)
        if isinstance(shape, (Point, BodyElement)):
            return Vertex(need_point(shape, self.name, field, shape.dimension))
        if not isinstance(shape, Shape):
            raise ModelError(
                f"{field} must be a shape, e.g. contact.Circle(ball.center, 0.1), or a point; "
                f"got {shape!r}",
                self.name,
            )
        return shape

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        return self.shape_i, self.shape_j

    def components_by_field(self) -> dict[str, Component]:
        return {"shape_i": self.shape_i, "shape_j": self.shape_j, **super().components_by_field()}


@dataclass(eq=False)
class ClearanceJoint(ShapeContact, BetweenPoints):
    """A journal in a bearing, or a ball in a socket, with clearance: contact instead of a joint.

    The gap is ``g = clearance − |r_j − r_i|``; the bodies are free while it is positive.

    Parameters
    ----------
    point_i : centre of the hole in the first body
    point_j : centre of the journal or ball of the second body
    radius : of the journal or ball [m]
    clearance : radius of the hole minus that of the journal or ball [m]
    """

    radius: Scalar = quantity("m", "radius of journal or ball", above=0.0, keyword=True)
    clearance: Scalar = quantity("m", "radius of the hole minus that", minimum=0.0, keyword=True)
    hole: ClassVar[type[Hollow]]
    inside: ClassVar[type[Round]]

    @cached_property
    def _shapes(self) -> tuple[Shape, Shape]:
        hole_radius = Expression(self.radius.sx + self.clearance.sx)
        return self.hole(self.point_i, hole_radius), self.inside(self.point_j, self.radius)

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        return self._shapes

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        relative = {"eccentricity": (self.between, "m"), "distance": (self.distance, "m")}
        return {**super().measures(rate), **relative}
