"""Positions opened after a step: joints closed and gaps open, along the shortest way by inertia."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import CLOSED, ContactStep
from dalembert.integrators.contact.friction_problem import FrictionProblem
from dalembert.symbolic.patterned import dense

ROUNDS = 10
"""Of Newton's method; each leaves the square of what was left."""


def corrected(
    step: ContactStep, t: float, y: np.ndarray, v: np.ndarray, open_gaps: bool
) -> np.ndarray:
    """The nearest position with ``Φ = 0`` and ``g ≥ 0``: ``δ = M⁻¹(Wᵀ P − Cᵀ λ)``, ``P ≥ 0``.

    Speeds are left alone, so that no impulse does work here; weights that are lifted keep what
    that takes.
    """
    smooth, model = step.smooth, step.model
    sizes = model.equations.scales.rows
    for _ in range(ROUNDS):
        gaps = step.closed(t, y) if open_gaps else None
        left = smooth.open_by(t, y, step.p)
        if np.all(np.abs(left) <= CLOSED * sizes) and (gaps is None or not gaps.count):
            break
        solve = smooth.at(t, y, step.p)[0]
        shift = solve(np.zeros(v.size), -left)[0]
        if gaps is not None and gaps.count:
            k = gaps.drift.shape[1]
            normals = gaps.directions[np.arange(gaps.count) * k]
            way = solve(dense(normals).T, None)[0]
            open_by = (gaps.distance + normals @ shift)[:, None]
            matrix = normals @ way
            scale = float(np.abs(open_by).max())
            problem = FrictionProblem(matrix, open_by, np.zeros(gaps.count), scale)
            shift = shift + way @ step.solver.solve(problem).impulses.ravel()
        y = model.equations.manifold.go(y, shift)
    return y


def consistent(step: ContactStep, t: float, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The nearest speeds, by kinetic energy, with ``C v = −Φ_t``."""
    solve, _, still, joints = step.smooth.at(t, y, step.p)
    return v + solve(np.zeros(v.size), -still - joints @ v)[0]
