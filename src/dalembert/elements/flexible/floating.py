"""Floating frame with shapes of deformation: inertia and elasticity.

``y = (frame, q)``. The kinetic energy is that of the finite elements, whose nodes move with the
frame and by the shapes (see ``shapes``); the strain energy is ``½ Σ k q²``.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import ForceElement, Powers, Rate
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.flexible.shape_numbers import ShapeNumbers, ShapeSymbols
from dalembert.elements.flexible.shapes import FloatingShapes


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


class FloatingFrame(BodyElement):
    """A body with a floating frame and shapes of deformation.

    Attributes
    ----------
    shapes : FloatingShapes at the nominal parameters
    graph : ShapeSymbols, their representation in equations
    numbers : ShapeNumbers if the structure depends on parameters of the mechanism, else None
    q : SX symbols ``q``
    sections : interface → Section
    """

    shapes: FloatingShapes
    graph: ShapeSymbols
    numbers: ShapeNumbers | None
    q: ca.SX
    sections: dict[str, Any]
    not_drawn = "the pieces and sections of its structure are drawn as they deform"

    @property
    def amplitudes(self) -> ca.SX:
        """``a(q)``: the coordinates followed by products of pairs."""
        products = [self.q[k] * self.q[l] for k, l in self.shapes.pairs]
        return ca.vertcat(self.q, *products)

    @property
    def frame_axes(self) -> ca.SX:
        """(d, d) axes of the frame as columns."""
        raise NotImplementedError

    @property
    def local_spin(self) -> ca.SX:
        """Angular velocity of the frame in its axes."""
        raise NotImplementedError

    def _centre(self) -> ca.SX:
        """(d,) mass centre in the frame, ``c + Σ c_k a_k``."""
        d, g, n = self.dimension, self.graph.inertia, self.shapes.rotations
        rotation = np.linalg.pinv(_turning(d).reshape(-1, d))
        first = ca.mtimes(ca.SX(ca.DM(rotation)), ca.vec(ca.densify(g[:d, d : d + n])))
        displacement = ca.mtimes(g[:d, d + n : d + n + self.amplitudes.numel()], self.amplitudes)
        return (first + displacement) / g[0, 0]

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        """``M`` and ``d`` by Lagrange's equations of ``T = ½ sᵀ (Wᵀ M W) s``.

        ``d = ṗ − Aᵀ ∂T/∂y`` with ``v̇ = 0``, and ``ω' × p_ω`` for speeds in a rotating frame
        (Hamel).
        """
        d, v, q = self.dimension, self.twist, self.q
        a, spin = self.amplitudes, self.local_spin
        amplitude_rates = ca.jtimes(a, q, v[-q.numel() :]) if q.numel() else ca.SX(0, 1)
        fields = ca.vertcat(spin, amplitude_rates, *(a * w for w in ca.vertsplit(spin)))
        g = self.graph.inertia
        mass, coupled, inner = g[0, 0], ca.mtimes(self.frame_axes, g[:d, d:]), g[d:, d:]
        slopes = ca.sparsify(ca.jacobian(fields, v[d:]))
        off_diagonal = ca.mtimes(coupled, slopes)
        lower_block = ca.mtimes([slopes.T, inner, slopes])
        matrix = ca.blockcat([[mass * ca.SX.eye(d), off_diagonal], [off_diagonal.T, lower_block]])
        momentum = ca.mtimes(matrix, v)
        energy = mass * ca.sumsqr(v[:d]) / 2 + ca.mtimes([v[:d].T, coupled, fields])
        energy += ca.mtimes([fields.T, inner, fields]) / 2
        bias = ca.jtimes(momentum, self.pose, self.pose_rate)
        bias -= ca.jtimes(self.pose_rate, v, ca.gradient(energy, self.pose), True)
        return matrix, bias + self._turning_momentum(momentum)

    def _turning_momentum(self, momentum: ca.SX) -> ca.SX:
        """Gyroscopic term of speeds in a rotating frame; zero if speeds are rates."""
        return ca.SX(momentum.numel(), 1)

    def own_forces(self) -> list[ForceElement]:
        return [Elasticity(self)] if self.shapes.count else []


def _turning(dimension: int) -> np.ndarray:
    """(rotations, d, d) ``e_j ×``."""
    if dimension == 2:
        return np.array([[[0.0, -1.0], [1.0, 0.0]]])
    return np.stack([np.cross(np.eye(3)[k], np.eye(3)).T for k in range(3)])
