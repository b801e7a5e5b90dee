"""Gyroscopic forces of free bodies, which do no work over a step."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.mobility import Coupling
from dalembert.model.graph.equations import Equations

PROBES, ROUNDING = 3, 1e-12
"""Number of random speeds, and ratio of forces or their power to their terms that counts as zero
[-]."""


@dataclass(frozen=True, eq=False)
class MeanForces:
    """``F = f − d`` and ``D`` of a step by the θ-method, ``F + D θ (v⁺ − v)``.

    Gyroscopic forces ``b(v)`` of free bodies are ``S(v̄) v`` with the skew matrix

        S(v) = (b_v − b_vᵀ)/3,      S(v) v = b(v),      v̄ = v + θ (v⁺ − v)

    so that with ``θ = ½`` they do no work, ``(v⁺ + v)ᵀ S (v⁺ + v) = 0``, and a tumbling body keeps
    its kinetic energy, with or without impulses, and with any approximation of ``v̄``. For
    quadratic ``b`` with ``vᵀ b = 0``, differentiation yields ``b_vᵀ v = −b`` and ``b_v v = 2 b``.

    Attributes
    ----------
    driving, damping : ``F``, and ``D = ∂F/∂v`` of the other forces with ``S(v̄)``
    rows : (k,) numbers of the speeds with gyroscopic forces
    mean : (k,) symbol of ``v̄`` of these
    predicted : (k,) ``v + θ h M⁻¹ F(v)``, without impulses
    """

    driving: ca.SX
    damping: ca.SX
    rows: np.ndarray
    mean: ca.SX
    predicted: ca.SX


def mean_forces(e: Equations, lead: ca.SX) -> MeanForces:
    """Forces of a model.

    Parameters
    ----------
    e : equations of the model
    lead : symbol of ``θ h``
    """
    driving = ca.densify(e.force - e.bias)
    damping, numbers = ca.jacobian(driving, e.v), gyroscopic_speeds(e)
    mean = ca.SX.sym("mean", numbers.size)
    if not numbers.size:
        return MeanForces(driving, damping, numbers, mean, mean)
    rows, speeds = numbers.tolist(), e.v[numbers.tolist()]
    bias = e.bias[rows]
    mass = ca.sparsify(e.mass[rows, rows])
    slope = ca.jacobian(bias, speeds)
    predicted = speeds + lead * ca.solve(mass, driving[rows])
    skew = ca.substitute((slope - slope.T) / 3, speeds, mean)
    gyroscopic = ca.SX(e.speed_count, e.speed_count)
    gyroscopic[rows, rows] = slope - skew
    damping = ca.sparsify(damping + gyroscopic)
    driving[rows] += bias - ca.mtimes(skew, speeds)
    return MeanForces(driving, damping, numbers, mean, ca.densify(predicted))


def gyroscopic_speeds(e: Equations) -> np.ndarray:
    """Numbers of the speeds of free bodies with constant inertia and quadratic forces that do no
    work; those of bodies with equal moments of inertia are zero."""
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
    acts = np.zeros_like(idle)
    inertia = ca.densify(ca.diag(mass))
    bias = ca.Function("bias", [e.t, e.y, e.v, e.p], [ca.densify(e.bias), inertia])
    for _ in range(PROBES):
        t, y, v, p = (rng.uniform(0.5, 1.5, x.numel()) for x in (e.t, e.y, e.v, e.p))
        once, diagonal = (np.asarray(part).ravel() for part in bias(t, y, v, p))
        twice = np.asarray(bias(t, y, 2 * v, p)[0]).ravel()
        power, terms = v * once, np.abs(v * once) + ROUNDING**2
        for number, size in enumerate(groups.sizes):
            own = groups.members[number, :size]
            quadratic = np.allclose(twice[own], 4 * once[own], rtol=ROUNDING, atol=0)
            idle[number] &= quadratic and abs(power[own].sum()) <= ROUNDING * terms[own].sum()
            least = ROUNDING * diagonal[own].max() * np.abs(v[own]).max() ** 2
            acts[number] |= np.abs(once[own]).max() > least
    for number, size in enumerate(groups.sizes):
        own = groups.members[number, :size]
        idle[number] &= acts[number] and used[own].any() and not varies[own].any()
    chosen = groups.group >= 0
    chosen[chosen] = idle[groups.group[chosen]]
    return np.flatnonzero(chosen)


def turn_error(speeds: np.ndarray, assumed: np.ndarray, sizes: np.ndarray) -> float:
    """Estimated error of the turn of a step by gyroscopic forces of ``assumed`` mean speeds (k,)
    instead of ``speeds`` [-]; ``sizes`` are the natural displacements per step."""
    difference = np.abs((speeds - assumed) / sizes).max(initial=0.0)
    return float(difference * np.abs(speeds / sizes).max(initial=0.0))
