"""Elastic and damping forces within a flexible body."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.base import ForceElement, Powers, Rate
from dalembert.elements.coordinates import Coordinates


class Elasticity(ForceElement):
    """``Q = −k q − c q̇`` on every shape of a body, with ``c = α m + β k + 2 ζ √(k m)``.

    The body brings it along.
    """

    internal = True

    def __init__(self, body: Any):
        self.name, self.body = f"{body.name}_elasticity", body

    def parts(self) -> list[Coordinates]:
        return [self.body]

    @property
    def _damping(self) -> ca.SX:
        """(m,) ``c``."""
        body, shapes = self.body, self.body.shapes
        mass, stiffness = ca.SX(shapes.mass), ca.SX(shapes.stiffness)
        by_mass, by_stiffness = ca.vertsplit(body.rayleigh.sx)
        ratio = 2 * body.damping_ratio.sx * ca.sqrt(mass * stiffness)
        return by_mass * mass + by_stiffness * stiffness + ratio

    def _damped(self, rate: Rate) -> ca.SX:
        return -self._damping * rate(self.body.q)

    def powers(self, rate: Rate) -> Powers:
        q = self.body.q
        return [(rate(q), -ca.SX(self.body.shapes.stiffness) * q + self._damped(rate))]

    def potential(self) -> ca.SX:
        return ca.dot(ca.SX(self.body.shapes.stiffness), self.body.q**2) / 2

    def dissipation(self, rate: Rate) -> Powers:
        return [(rate(self.body.q), self._damped(rate))]
