"""Gyroscopic forces of free bodies, which do no work over a step."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.mobility import Coupling
from dalembert.model.graph.equations import Equations

PROBES, ROUNDING = 3, 1e-12
"""Number of random speeds, and power relative to its terms, at which forces do no work [-]."""


def smooth_forces(e: Equations, lead: ca.SX) -> tuple[ca.SX, ca.SX]:
    """``F = f − d`` and ``D = ∂F/∂v`` of a step by the θ-method, ``F + D θ (v⁺ − v)``.

    Gyroscopic forces ``b(v)`` of free bodies are ``S(ṽ) v`` with the skew matrix

        S(v) = (b_v − b_vᵀ)/3,      S(v) v = b(v),      ṽ = v + θ h M⁻¹ F(v)

    so that with ``θ = ½`` they do no work, ``(v⁺ + v)ᵀ S (v⁺ + v) = 0``, and a tumbling body keeps
    its kinetic energy, with or without impulses. For quadratic ``b`` with ``vᵀ b = 0``,
    differentiation yields ``b_vᵀ v = −b`` and ``b_v v = 2 b``.

    Parameters
    ----------
    e : equations of the model
    lead : symbol of ``θ h``
    """
    driving = ca.densify(e.force - e.bias)
    damping, turning = ca.jacobian(driving, e.v), gyroscopic_speeds(e)
    if not turning.size:
        return driving, damping
    rows, speeds = turning.tolist(), e.v[turning.tolist()]
    bias = e.bias[rows]
    mass = ca.sparsify(e.mass[rows, rows])
    slope = ca.jacobian(bias, speeds)
    ahead = speeds + lead * ca.solve(mass, driving[rows])
    skew = ca.substitute((slope - slope.T) / 3, speeds, ahead)
    gyroscopic = ca.SX(e.speed_count, e.speed_count)
    gyroscopic[rows, rows] = slope - skew
    damping = ca.sparsify(damping + gyroscopic)
    driving[rows] += bias - ca.mtimes(skew, speeds)
    return driving, damping


def gyroscopic_speeds(e: Equations) -> np.ndarray:
    """Numbers of the speeds of free bodies with constant inertia whose quadratic forces do no
    work."""
    slopes = ca.sparsify(ca.jacobian(e.bias, e.v))
    if not slopes.nnz():
        return np.zeros(0, dtype=int)
    pattern = slopes.sparsity() + slopes.T.sparsity() + ca.sparsify(e.mass).sparsity()
    groups = Coupling.of(pattern, e.jacobian.sparsity())
    used = np.zeros(e.speed_count, dtype=bool)
    used[np.array(slopes.row(), dtype=int)] = True
    mass = ca.sparsify(e.mass)
    by_position = ca.jacobian(mass.nz[:], ca.vertcat(e.y, e.t))
    changing = np.array(mass.row(), dtype=int)[np.array(by_position.sparsity().row(), dtype=int)]
    varies = np.isin(np.arange(e.speed_count), changing)
    rng, idle = np.random.default_rng(0), np.ones(groups.members.shape[0], dtype=bool)
    bias = ca.Function("bias", [e.t, e.y, e.v, e.p], [ca.densify(e.bias)])
    for _ in range(PROBES):
        t, y, v, p = (rng.uniform(0.5, 1.5, x.numel()) for x in (e.t, e.y, e.v, e.p))
        once, twice = (np.asarray(bias(t, y, factor * v, p)).ravel() for factor in (1.0, 2.0))
        power, terms = v * once, np.abs(v * once) + ROUNDING**2
        for number, size in enumerate(groups.sizes):
            own = groups.members[number, :size]
            quadratic = np.allclose(twice[own], 4 * once[own], rtol=ROUNDING, atol=0)
            idle[number] &= quadratic and abs(power[own].sum()) <= ROUNDING * terms[own].sum()
    for number, size in enumerate(groups.sizes):
        own = groups.members[number, :size]
        idle[number] &= used[own].any() and not varies[own].any()
    chosen = groups.group >= 0
    chosen[chosen] = idle[groups.group[chosen]]
    return np.flatnonzero(chosen)
