"""Cables, which carry tension only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca

from dalembert.elements.base import Look, Rate, Scalar, option, quantity
from dalembert.elements.contact.compliant import Compliant
from dalembert.elements.contact.laws import KelvinVoigt, NormalLaw
from dalembert.elements.contact.shapes import NO_LENGTH
from dalembert.elements.contact.unilateral import Gap
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Rod
from dalembert.elements.pair import need_point
from dalembert.elements.point import Point
from dalembert.errors import ModelError


@dataclass(eq=False)
class Cable(Compliant):
    """A cable that runs without friction through points, with tension beyond its free length.

    With the length ``s = Σ |r_{k+1} − r_k|`` of its path, ``F = k (s − l) + c ṡ ≥ 0`` for
    ``s > l``, else zero; the tension is the same in all segments.

    Parameters
    ----------
    points : of bodies, in order; it is attached to the first and the last
    length : l, without tension [m]
    stiffness : k of the whole cable [N/m]
    damping : c [N s/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pulley", gravity=(0, -10))
    >>> weight = system.add(planar.Particle("weight", mass=3.0, position=(0, -1.01)))
    >>> rail = planar.PinInSlot("rail", system.ground.center, weight.center, axis=(0, 1))
    >>> held = system.add(rail)
    >>> ends = system.ground.point(-0.75, 0), weight.center, system.ground.point(0.75, 0)
    >>> cable = system.add(planar.Cable("cable", ends, length=2.5, stiffness=1e6))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["cable.force"].item(), 2)  # m g/2 over the cosine 0.8 of both segments
    18.75
    """

    points: tuple[Point, ...] = option("points it runs through, in order")
    length: Scalar = quantity("m", "length without tension", minimum=0.0, keyword=True)
    stiffness: Scalar = quantity("N/m", "stiffness of the whole", above=0.0, keyword=True)
    damping: Scalar = quantity("N s/m", "damping", default=0.0, minimum=0.0)

    def __post_init__(self) -> None:
        points = self.points
        if not isinstance(points, Sequence) or isinstance(points, str) or len(points) < 2:
            message = f"points must be a list of at least two, got {_description(points)}"
            raise ModelError(message, self.name)
        space = max(getattr(point, "dimension", 2) for point in points)
        self.points = tuple(
            need_point(point, self.name, f"points[{k}]", space) for k, point in enumerate(points)
        )
        for point in self.points:
            if point.dimension != space:
                raise ModelError(
                    f"the point of {point.body.name} lies in a plane and others in space; give all "
                    "the same number of coordinates",
                    self.name,
                )
        for k, (i, j) in enumerate(pairwise(self.points)):
            if i is j:
                raise ModelError(
                    f"points[{k}] and points[{k + 1}] are the same point of {i.body.name}; give it "
                    "once",
                    self.name,
                )
        if len(set(map(id, self.parts()))) < 2:
            raise ModelError(f"all its points are on {self.points[0].body.name}", self.name)
        super().__post_init__()

    def parts(self) -> list[Coordinates]:
        return list(dict.fromkeys(point.body for point in self.points))

    @cached_property
    def path(self) -> ca.SX:
        """Length of the path [m]."""
        between = [j.position.sx - i.position.sx for i, j in pairwise(self.points)]
        return sum((ca.sqrt(ca.sumsqr(segment) + NO_LENGTH**2) for segment in between), ca.SX(0))

    def gaps(self, rate: Rate) -> list[Gap]:
        return [Gap(self.length.sx - self.path, ca.SX(0, 1))]

    def normal_law(self) -> NormalLaw:
        return KelvinVoigt(stiffness=self.stiffness, damping=self.damping)

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        (forces,) = self.contact_forces(rate)
        slack = ca.fmax(0, forces.gap.distance)
        return {"force": (forces.normal, "N"), "path": (self.path, "m"), "slack": (slack, "m")}

    def look(self) -> list[Look]:
        return [Rod(i, j) for i, j in pairwise(self.points)]


def _description(points: Any) -> str:
    """Number of points, or the value that is not a list."""
    is_list = isinstance(points, Sequence) and not isinstance(points, str)
    return f"{len(points)}" if is_list else repr(points)
