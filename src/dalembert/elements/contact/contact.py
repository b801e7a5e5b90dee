"""Contact of two bodies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint, Look, Rate, option
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.bristle import Bristles
from dalembert.elements.contact.compliant import Compliant
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.meeting import Meeting
from dalembert.elements.contact.pairing import meetings
from dalembert.elements.contact.shapes import Shape, Vertex
from dalembert.elements.contact.unilateral import Gap, Impact
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.ingredient import Ingredient
from dalembert.elements.pair import need_point, refuse_same_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError

EXAMPLES = {"law": "contact.Hertz(stiffness=1e8)", "friction": "contact.Coulomb(0.3)"}


@dataclass(eq=False)
class Touching(Compliant):
    """Two shapes by a law and friction; which shapes, the subclass says in ``shapes``.

    Parameters
    ----------
    law : how they press, or bounce
    friction : how they rub; not at all by default
    """

    law: NormalLaw | Restitution = option("how they press, or bounce", keyword=True)
    friction: Friction | None = option("how they rub", default=None, keyword=True)

    def __post_init__(self) -> None:
        self._need("law", isinstance(self.law, (NormalLaw, Restitution)))
        self._need("friction", self.friction is None or isinstance(self.friction, Friction))
        super().__post_init__()
        refuse_same_body(*self.ends(), self.name)
        i, j = self.shapes
        if i.dimension != j.dimension:
            flat = i if i.dimension == 2 else j
            raise ModelError(
                f"the {type(flat).__name__} of {flat.carrier.name} lies in a plane and the other "
                "shape in space; give both as many coordinates",
                self.name,
            )
        self.meetings: list[Meeting] = meetings(i, j, self.name)
        self.bristles = self._bristles()

    def _bristles(self) -> list[Bristles]:
        """The states of friction that has some, one group by gap."""
        found: list[Bristles] = []
        if self.friction is None:
            return found
        for k, gap in enumerate(self._gaps):
            made = Bristles(f"{self.name}.bristles{k + 1}", gap.slip.numel())
            rate = self.friction.bending(gap.slip, made.pose)
            if rate is not None:
                made.pose_rate = rate
                found.append(made)
        return found

    def _need(self, field: str, given: bool) -> None:
        if not given:
            value, example = getattr(self, field), EXAMPLES[field]
            raise ModelError(f"{field} must be one such as {example}; got {value!r}", self.name)

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        """Of the first and of the second body."""
        raise NotImplementedError

    def ends(self) -> tuple[Any, Any]:
        """First and second body."""
        i, j = self.shapes
        return i.carrier, j.carrier

    def parts(self) -> list[Coordinates]:
        feet = [c for foot in self.own_constraints() for c in foot.own_coordinates()]
        return [*self.ends(), *feet, *self.bristles]

    def own_coordinates(self) -> list[Coordinates]:
        return list(self.bristles)

    def states(self) -> Iterable[ca.SX]:
        return (group.pose for group in self.bristles) if self.bristles else super().states()

    def own_constraints(self) -> list[Constraint]:
        return [meeting.foot for meeting in self.meetings if meeting.foot is not None]

    def ingredients(self) -> dict[str, Ingredient]:
        made = {"law": self.law, "friction": self.friction}
        return {field: given for field, given in made.items() if given is not None}

    def normal_law(self) -> NormalLaw | None:
        return self.law if isinstance(self.law, NormalLaw) else None

    def rubbing(self) -> Friction | None:
        return self.friction

    @cached_property
    def _gaps(self) -> list[Gap]:
        return [Gap(m.distance, m.slip(*self.ends())) for m in self.meetings]

    def gaps(self, rate: Rate) -> list[Gap]:
        return self._gaps

    def impact(self) -> Impact | None:
        if not isinstance(self.law, Restitution):
            return None
        rough = ca.SX(0) if self.friction is None else self.friction.sliding()
        return Impact(self.law.e.sx, self.law.tangential.sx, rough)

    def look(self) -> list[Look]:
        return [part for shape in self.shapes for part in shape.look(self.meetings[0].place)]


@dataclass(eq=False)
class Contact(Touching):
    """Two shapes that press and rub where they touch, and part without force.

    At every place where they may touch, ``N`` acts along the normal by the law of the depth and its
    rate, ``T`` along the surface by the friction, on either body in opposite senses halfway between
    the two surfaces. With a ``Restitution`` the contact is rigid and makes no forces.

    Parameters
    ----------
    shape_i, shape_j : of two bodies, or a point of a body that touches

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
    >>> round(motion["ball.y"][-1].item(), 6)  # radius less m g/k
    0.099
    """

    shape_i: Shape = option("shape of the first body")
    shape_j: Shape = option("shape of the second body")

    def __post_init__(self) -> None:
        self.shape_i, self.shape_j = self._shape("shape_i"), self._shape("shape_j")
        super().__post_init__()

    def _shape(self, field: str) -> Shape:
        given = getattr(self, field)
        if isinstance(given, (Point, BodyElement)):
            return Vertex(need_point(given, self.name, field, given.dimension))
        if not isinstance(given, Shape):
            raise ModelError(
                f"{field} must be a shape, e.g. contact.Circle(ball.center, 0.1), or a point; "
                f"got {given!r}",
                self.name,
            )
        return given

    @property
    def shapes(self) -> tuple[Shape, Shape]:
        return self.shape_i, self.shape_j

    def ingredients(self) -> dict[str, Ingredient]:
        return {"shape_i": self.shape_i, "shape_j": self.shape_j, **super().ingredients()}
