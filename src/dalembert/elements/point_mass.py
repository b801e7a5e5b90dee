"""What particles of the plane and of space share: a place and no more."""

from __future__ import annotations

import dataclasses
from typing import Any

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Ball
from dalembert.elements.point import Point
from dalembert.errors import ModelError


def nothing() -> Any:
    """A field of bodies that a particle does not take."""
    return dataclasses.field(init=False, default=None)


class PointMass(BodyElement):
    """A body that does not rotate, whose only point is itself."""

    rotates = False

    def frame(self, *place: Any, **axes: Any) -> Any:
        """Refused: what does not turn has no axes.

        Raises
        ------
        ModelError
        """
        raise ModelError("a particle has no frame; use a Body", self.name)

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
