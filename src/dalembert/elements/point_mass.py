"""What particles of the plane and of space share: a place and no more."""

from __future__ import annotations

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Ball
from dalembert.elements.point import Point
from dalembert.errors import ModelError


class PointMass(BodyElement):
    """A body that does not rotate, whose only point is itself."""

    rotates = False
    needless: tuple[str, ...]
    """Fields that it has no use for."""

    def __post_init__(self) -> None:
        for field in self.needless:
            if getattr(self, field) is not None:
                raise ModelError(f"a particle has no {field}; use a Body", self.name)
        super().__post_init__()

    def look(self) -> list[Look]:
        return [Ball(self.center)]

    def point(self, x, y=None, z=None) -> Point:
        """The particle itself: its only point is the origin.

        Raises
        ------
        ModelError
            Any other point.
        """
        made = super().point(x, y, z)
        if not made.local.sx.is_zero():
            origin = ", ".join("0" * self.dimension)
            raise ModelError(f"a particle has no point but ({origin}); use a Body", self.name)
        return made
