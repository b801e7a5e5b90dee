"""Small rotations of spatial bodies in inertial axes.

Speeds of bodies are angular velocities ``ω'`` in body axes, which turn with a spinning body. Of a
small rotation ``θ`` in inertial axes, ``δR = θ̃ R``, the changes are ``δω' = Rᵀ θ̇`` and
``δω̇' = Rᵀ θ̈ + Ṙᵀ θ̇``. The linear system of a rotor that spins about its axis of symmetry is
then constant in time.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.model.graph.model import Model


@dataclass(frozen=True, eq=False)
class InertialAxes:
    """Change of displacements and speeds, ``δ = Q δ_i``, ``δv = Q δ̇_i``.

    Attributes
    ----------
    turned : SX (n, n) ``Q``, orthogonal
    turning : SX (n, n) its rate along the motion
    """

    turned: ca.SX
    turning: ca.SX

    def accelerations(self, second: ca.SX, rates: ca.SX) -> ca.SX:
        """Changes of the accelerations of the model."""
        return ca.mtimes(self.turned, second) + ca.mtimes(self.turning, rates)


def inertial_axes(model: Model) -> InertialAxes | None:
    """Axes of the small rotations of a model; None if no body rotates in space."""
    e = model.equations
    place = {e.v[k].element_hash(): k for k in range(e.v.numel())}
    turned, rotating = ca.SX.eye(e.speed_count), False
    for body in model.bodies:
        spin = getattr(body, "spin", None)
        if spin is None or not getattr(body, "rotates", False):
            continue
        rows = [place[h] for k in range(3) if (h := spin[k].element_hash()) in place]
        if len(rows) == 3:
            rotating = True
            turned[rows, rows] = body.axes.T
    if not rotating:
        return None
    turning = ca.jtimes(ca.vec(ca.densify(turned)), e.y, e.pose_rate)
    return InertialAxes(turned, ca.reshape(turning, turned.shape))
