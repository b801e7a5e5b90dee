"""Means of joints and forces over the path of a step.

    C̄ = ∫ C(y ⊕ s δ) R ds,      F̄ = ∫ R F(y ⊕ s δ, R v̄) ds,      δ = h v̄,      0 ≤ s ≤ 1

``R`` are the shares of the displacement per ``s`` in ``δ``. Along the path ``C̄ δ + h ∫ Φ_t ds`` is
the change of ``Φ`` and ``F̄ᵀ δ`` the work of the forces. With ``M (v⁺ − v) = h F̄ − C̄ᵀ Λ`` and
``v̄ = (v⁺ + v)/2``, closed joints therefore do no work, conservative forces that of their potential
energy, and gyroscopic forces none (discrete gradient: Gonzalez, Comput. Methods Appl. Mech. Eng.
174, 1999; averaged vector field: Quispel & McLaren, J. Phys. A 41, 2008).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.integrators.contact.mean_force import NODES, WEIGHTS
from dalembert.model.graph.equations import Equations


@dataclass(frozen=True, eq=False)
class PathForces:
    """Means over the path from ``y`` with the mean speeds ``v̄``.

    Attributes
    ----------
    joints, still : ``C̄`` (m, n) SX, and the mean of ``Φ_t`` (m,)
    force : ``F̄`` (n,), with ``F = f − d``
    """

    joints: ca.SX
    still: ca.SX
    force: ca.SX


def path_forces(e: Equations, h: ca.SX, speeds: ca.SX) -> PathForces:
    """Means by Gauss's rule with four points, exact for polynomials of degree 7.

    Parameters
    ----------
    e : equations of the model
    h : symbol of the step
    speeds : (n,) ``v̄``
    """
    share, moved, shares = e.manifold.path
    path = ca.Function("path", [e.manifold.y, e.manifold.delta, share], [moved, shares])
    still = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
    outputs = [e.jacobian, ca.densify(still), ca.densify(e.force - e.bias)]
    at = ca.Function("at", [e.t, e.y, e.v, e.p], outputs)
    joints, still, force = ca.SX(*e.jacobian.shape), ca.SX(*still.shape), ca.SX(e.speed_count, 1)
    for s, weight in zip(NODES, WEIGHTS, strict=True):
        y, part = path(e.y, h * speeds, s)
        own, own_still, own_force = at(e.t + s * h, y, part * speeds, e.p)
        joints += weight * ca.mtimes(own, ca.diag(part))
        still += weight * own_still
        force += weight * part * own_force
    return PathForces(ca.sparsify(joints), still, force)
