"""Equations of motion by the methods of Gibbs–Appell and Kane, book section 6.4.

Both start from the motion written explicitly in independent speeds, ``v = D u`` (a
``Transformation``), and lead to

    Dᵀ M D u̇ + Dᵀ (M γ + d) − Dᵀ f = 0,

the projective scheme (6.9), which ``Transformation.apply`` writes directly. The first method
differentiates a scalar, the second one velocities.
"""

from __future__ import annotations

import casadi as ca

from dalembert.model.graph.equations import Equations
from dalembert.model.graph.transformation import Transformation


def appell_function(equations: Equations, motion: Transformation) -> ca.SX:
    """Gibbs–Appell function ``S = v̇ᵀ M v̇ / 2 + v̇ᵀ d`` with ``v̇ = D u̇ + γ`` (6.12).

    Terms without ``u̇`` contribute nothing and are left out.
    """
    e, a = equations, motion.old_a
    return ca.dot(a, ca.mtimes(motion.seen(e, e.mass), a) / 2 + motion.seen(e, e.bias))


def gibbs_appell(equations: Equations, motion: Transformation) -> ca.SX:
    """``∂S/∂u̇ − f' = 0`` (6.13): left-hand side (k,), zero along the motion.

    The generalised forces are derivatives by accelerations, too: ``f' = ∂(fᵀ v̇)/∂u̇``.

    Parameters
    ----------
    equations : of the system without its constraints
    motion : its speeds by independent ones, ``v = D u``
    """
    e = equations
    forces = ca.dot(motion.seen(e, e.force), motion.old_a)
    return ca.gradient(appell_function(e, motion) - forces, motion.a)


def partial_velocities(motion: Transformation) -> ca.SX:
    """``∂v/∂u`` (n, k), Kane's name for the columns of ``D``."""
    return ca.jacobian(motion.old_v, motion.v)


def kane(equations: Equations, motion: Transformation) -> ca.SX:
    """``−(K + K*) = 0`` (6.15): left-hand side (k,), zero along the motion.

    ``K`` are the applied forces f and ``K*`` the inertia forces ``−(M v̇ + d)`` (6.14), each
    multiplied by the partial velocities.

    Parameters
    ----------
    equations : of the system without its constraints
    motion : its speeds by independent ones, ``v = D u``
    """
    e = equations
    applied = motion.seen(e, e.force)
    inertial = -(ca.mtimes(motion.seen(e, e.mass), motion.old_a) + motion.seen(e, e.bias))
    return -ca.mtimes(partial_velocities(motion).T, applied + inertial)
