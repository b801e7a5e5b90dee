"""First-order optimality and what limits cost, from gradients at a design alone.

``∇f = Jᵀλ_l − Jᵀλ_u + μ_l − μ_u`` with λ, μ ≥ 0 at active sides only (Karush–Kuhn–Tucker), by
non-negative least squares (Lawson & Hanson 1974): what is left over proves or disproves an optimum,
whatever an optimiser says of itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.design.optimize.program import Point, Program

ACTIVE = 1e-5
"""Scaled distance within which a limit or bound counts as active."""
OPTIMAL = 1e-3
"""Residual, relative to the gradient or to the objective over the range, of an optimum."""


@dataclass
class Multipliers:
    """Multipliers of one design, scaled.

    Attributes
    ----------
    residual : (n,) what is left of the gradient
    stationarity : its largest entry, relative
    lower, upper : (m,) of the limits' sides
    bound_lower, bound_upper : (n,) of the bounds
    """

    residual: np.ndarray
    stationarity: float
    lower: np.ndarray
    upper: np.ndarray
    bound_lower: np.ndarray
    bound_upper: np.ndarray


def multipliers(program: Program, z: np.ndarray, point: Point) -> Multipliers:
    """The multipliers that leave least of the gradient."""
    from scipy.optimize import nnls

    found = np.zeros((2, program.m)), np.zeros((2, program.n))
    columns, places = [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        bound = (program.c_lower, program.c_upper)[side]
        for k in np.flatnonzero(abs(point.c - bound) <= ACTIVE):
            columns.append(sign * point.J[k])
            places.append((found[0], side, k))
        edge = (program.z_lower, program.z_upper)[side]
        for i in np.flatnonzero(abs(z - edge) <= ACTIVE):
            columns.append(sign * np.eye(program.n)[i])
            places.append((found[1], side, i))
    residual = point.g.copy()
    if columns:
        matrix = np.array(columns).T
        sizes = np.maximum(np.linalg.norm(matrix, axis=0), 1e-30)
        weights = nnls(matrix / sizes, point.g)[0] / sizes
        residual = point.g - matrix @ weights
        for (table, side, k), weight in zip(places, weights, strict=True):
            table[side, k] = weight
    size = max(1.0, float(np.max(abs(point.g), initial=0.0)))
    stationarity = float(np.max(abs(residual), initial=0.0)) / size
    return Multipliers(residual, stationarity, *found[0], *found[1])


def why_stuck(program: Program, z: np.ndarray, point: Point, residual: np.ndarray) -> str:
    """What holds a search at a design that its gradient would leave, by two short steps along it.

    The objective may not fall there (a kink or a jump), or the designs beyond may fail.
    """
    size = float(np.max(abs(residual), initial=0.0))
    for step in (1e-3, 1e-5):
        found = program.value(z - step * residual / size)
        if found is None:
            return f"; the designs beyond fail: {program.problem.failures[-1]}"
        if found[0] < point.f - 0.1 * step * float(residual @ residual) / size:
            return ""
    return ", and the objective does not follow it: it has a kink or a jump here; use smooth="
