"""First-order optimality conditions and Lagrange multipliers at a design.

``∇f = Jᵀλ_l − Jᵀλ_u + μ_l − μ_u`` with λ, μ ≥ 0 at active sides only (Karush–Kuhn–Tucker), by
non-negative least squares (Lawson & Hanson 1974). The residual verifies an optimum independently of
the status that the optimiser reports.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.optimize.program import Point, Program

ACTIVE = 1e-5
"""Scaled distance below which a limit or bound is active [-]."""
OPTIMAL = 1e-3
"""Upper limit of the relative stationarity residual of an optimum [-]."""


@dataclass
class Multipliers:
    """Multipliers of one design, scaled.

    Attributes
    ----------
    residual : (n,) gradient of the Lagrangian
    stationarity : its largest entry, relative to the gradient
    lower, upper : (m,) of the limits
    bound_lower, bound_upper : (n,) of the bounds
    """

    residual: np.ndarray
    stationarity: float
    lower: np.ndarray
    upper: np.ndarray
    bound_lower: np.ndarray
    bound_upper: np.ndarray


def multipliers(program: Program, z: np.ndarray, point: Point) -> Multipliers:
    """Non-negative multipliers of the active set that minimise the Lagrangian gradient."""
    from scipy.optimize import nnls

    tables = np.zeros((2, program.m)), np.zeros((2, program.n))
    columns, targets = [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        bound = (program.c_lower, program.c_upper)[side]
        for k in np.flatnonzero(abs(point.c - bound) <= ACTIVE):
            columns.append(sign * point.J[k])
            targets.append((tables[0], side, k))
        edge = (program.z_lower, program.z_upper)[side]
        for i in np.flatnonzero(abs(z - edge) <= ACTIVE):
            columns.append(sign * np.eye(program.n)[i])
            targets.append((tables[1], side, i))
    residual = point.g.copy()
    if columns:
        matrix = np.array(columns).T
        sizes = np.maximum(np.linalg.norm(matrix, axis=0), 1e-30)
        weights = nnls(matrix / sizes, point.g)[0] / sizes
        residual = point.g - matrix @ weights
        for (table, side, k), weight in zip(targets, weights, strict=True):
            table[side, k] = weight
    size = max(1.0, float(np.max(abs(point.g), initial=0.0)))
    stationarity = float(np.max(abs(residual), initial=0.0)) / size
    return Multipliers(residual, stationarity, *tables[0], *tables[1])


def why_stuck(program: Program, z: np.ndarray, point: Point, residual: np.ndarray) -> str:
    """Why a search stopped at a non-stationary design, from two short steepest-descent steps.

    The objective may not decrease there (a kink or a jump), or the trial designs may fail. Empty if
    the objective decreases.
    """
    size = float(np.max(abs(residual), initial=0.0))
    for step in (1e-3, 1e-5):
        trial = program.value(z - step * residual / size)
        if trial is None:
            return f"; the designs along it fail: {program.problem.failures[-1]}"
        if trial[0] < point.f - 0.1 * step * float(residual @ residual) / size:
            return ""
    return (
        ", but the objective does not decrease along it: it has a kink or a jump here; use smooth="
    )
