"""Axes of the small rotations of spatial bodies in a linear system.

Speeds of bodies are angular velocities ``ω'`` in body axes, which turn with a spinning body. Small
rotations are ``δR = R θ̃'`` in body axes, or ``δR = θ̃ R`` in the axes of the reference frame: the
inertial frame, in joint coordinates the body that carries a joint. With these,

    δe = e ⊗ (0, θ')/2,      or  δe = (0, θ)/2 ⊗ e  and  δω' = Rᵀ θ̇.

Coordinates ``η`` of small motions, ``δx = S η``, turn with an orthogonal ``S(x)``, and follow

    η̇ = Sᵀ (J − Ω) S η,      Ω = Ṡ Sᵀ.

The linear system of a rotor that spins about an axis of symmetry is constant in time in the axes of
the reference frame, that of a free body that spins about any principal axis is in body axes.
"""

from __future__ import annotations

from enum import Enum

import casadi as ca

from dalembert.model.graph.equations import Equations
from dalembert.symbolic import rotation


class RotationAxes(Enum):
    """Axes of small rotations."""

    REFERENCE = "reference"
    BODY = "body"

    def speeds(self, e: Equations) -> ca.SX:
        """(n, n) orthogonal ``Q`` of ``δv = Q δ̇``, also of displacements, ``δ' = Q δ``."""
        turned = ca.SX.eye(e.speed_count)
        if self is RotationAxes.REFERENCE:
            for coordinate, speed in e.manifold.attitudes:
                rows = list(range(speed, speed + 3))
                turned[rows, rows] = rotation.matrix(e.y[coordinate : coordinate + 4]).T
        return turned

    def state(self, e: Equations) -> ca.SX:
        """(N, N) orthogonal ``S`` of changes of ``x = [y; v]``."""
        turned = ca.SX.eye(e.coordinate_count)
        for coordinate, _ in e.manifold.attitudes:
            rows = list(range(coordinate, coordinate + 4))
            attitude, unit = e.y[rows], ca.SX.sym("unit", 4)
            factors = (unit, attitude) if self is RotationAxes.REFERENCE else (attitude, unit)
            turned[rows, rows] = ca.jacobian(rotation.product(*factors), unit)
        return ca.diagcat(turned, self.speeds(e))

    def turning(self, e: Equations) -> ca.SX:
        """(N, N) ``Ω = Ṡ Sᵀ``."""
        turned = ca.sparsify(self.state(e))
        return ca.sparsify(ca.mtimes(rate_along_motion(e, turned), turned.T))


def rate_along_motion(e: Equations, matrix: ca.SX) -> ca.SX:
    """Rate of a matrix of the coordinates along the motion."""
    rate = ca.jtimes(ca.vec(ca.densify(matrix)), e.y, e.pose_rate)
    return ca.reshape(rate, matrix.shape)
