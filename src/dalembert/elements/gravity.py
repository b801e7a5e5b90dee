"""Gravity."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from dalembert.elements.base import ForceElement, Rate
from dalembert.elements.body import BodyElement
from dalembert.symbolic.expression import Expression


class Gravity(ForceElement):
    """Uniform field on every body; the system adds it for its ``gravity``."""

    conservative = True

    def __init__(self, vector: Expression, bodies: Sequence[BodyElement]):
        self.name = "gravity"
        self.vector, self.bodies = vector, bodies

    def _weights(self) -> list[tuple[ca.SX, ca.SX]]:
        """Coordinates of all mass centres with the weight along them."""
        field = self.vector.sx
        return [
            (body.mass_center[k], body.mass.sx * field[k])
            for body in self.bodies
            for k in range(min(body.mass_center.numel(), field.numel()))
        ]

    def potential(self) -> ca.SX:
        return -sum((weight * place for place, weight in self._weights()), ca.SX(0))

    def works(self, rate: Rate) -> list[tuple[ca.SX, ca.SX]]:
        return self._weights()
