"""Gravity."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from dalembert.elements.base import Element, ForceElement, Powers, Rate
from dalembert.symbolic.formulas.expression import Expression, stack


class Gravity(ForceElement):
    """Uniform field on every mass; the system adds it for its ``gravity``."""

    conservative = True

    def __init__(self, vector: Expression, elements: Sequence[Element]):
        self.name = "gravity"
        self.vector, self.elements = vector, elements

    def _weights(self) -> tuple[ca.SX, ca.SX]:
        """Coordinates of all masses, and the weight along each."""
        field, places, weights = self.vector.sx, [], []
        for place, mass in (pair for element in self.elements for pair in element.masses()):
            n = min(place.numel(), field.numel())
            places.append(place[:n])
            weights.append(mass * field[:n])
        return stack(places), stack(weights)

    def potential(self) -> ca.SX:
        return -ca.dot(*self._weights())

    def powers(self, rate: Rate) -> Powers:
        places, weights = self._weights()
        return [(rate(places), weights)]
