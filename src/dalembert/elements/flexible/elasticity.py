"""Elastic and damping forces of a flexible body."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.base import ForceElement, Powers, Rate
from dalembert.elements.coordinates import Coordinates


class Elasticity(ForceElement):
    """``Q = −K q − C q̇`` on the shapes of a body, with ``C = α M + β K + 2 ζ M (M⁻¹ K)^½``."""

    internal = True

    def __init__(self, body: Any):
        self.name, self.body = f"{body.name}_elasticity", body

    def parts(self) -> list[Coordinates]:
        return [self.body]

    @property
    def _damping(self) -> ca.SX:
        """(m, m) ``C``."""
        body, graph = self.body, self.body.graph
        by_mass, by_stiffness = ca.vertsplit(body.rayleigh.sx)
        rayleigh = by_mass * graph.mass + by_stiffness * graph.stiffness
        return rayleigh + body.damping_ratio.sx * graph.critical

    def _damped(self, rate: Rate) -> ca.SX:
        return -ca.mtimes(self._damping, rate(self.body.q))

    def powers(self, rate: Rate) -> Powers:
        q = self.body.q
        return [(rate(q), -ca.mtimes(self.body.graph.stiffness, q) + self._damped(rate))]

    def potential(self) -> ca.SX:
        q = self.body.q
        return ca.dot(q, ca.mtimes(self.body.graph.stiffness, q)) / 2

    def dissipation(self, rate: Rate) -> Powers:
        return [(rate(self.body.q), self._damped(rate))]
