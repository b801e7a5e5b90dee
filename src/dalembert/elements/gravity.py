"""Gravity."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from dalembert.elements.base import ForceElement, Powers, Rate
from dalembert.elements.body import BodyElement
from dalembert.symbolic.expression import Expression, stack


class Gravity(ForceElement):
    """Uniform field on every body; the system adds it for its ``gravity``."""

    conservative = True

    def __init__(self, vector: Expression, bodies: Sequence[BodyElement]):
        self.name = "gravity"
        self.vector, self.bodies = vector, bodies

    def _weights(self) -> tuple[ca.SX, ca.SX]:
        """Coordinates of all mass centres, and the weight along each."""
        field, places, weights = self.vector.sx, [], []
        for body in self.bodies:
            n = min(body.mass_center.numel(), field.numel())
            places.append(body.mass_center[:n])
            weights.append(body.mass.sx * field[:n])
        return stack(places), stack(weights)

    def potential(self) -> ca.SX:
        return -ca.dot(*self._weights())

    def powers(self, rate: Rate) -> Powers:
        places, weights = self._weights()
        return [(rate(places), weights)]
