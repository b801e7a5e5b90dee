"""What a formulation costs on a mechanism, and how accurate it is where that starts."""

from __future__ import annotations

import warnings

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.formulations.base import Performance, state_symbols
from dalembert.model.equations import Equations


def merits_of(kernel: DynamicsKernel) -> Performance:
    """Operations of a step, and the error of its accelerations at the start.

    Accelerations are compared with those by a pivoting factorisation of (5.7), with equations and
    unknowns in natural units; a saddle matrix that is singular, as redundant equations make it,
    has no such solution, and with friction that follows from multipliers (5.7) is not all: then
    nothing is said against the formulation.
    """
    variant, x = kernel.beginning
    e, p, start = variant.equations, kernel.model.nominal, 0.0
    expected = None if e.rubbing.nnz() else _accelerations(e, start, x, p)
    found = variant.rate.function(start, x, p).full().ravel()
    n = e.coordinate_count
    found = found[n : n + e.speed_count] / (e.scales.speeds / e.scales.time)
    if expected is None:
        error = 0.0 if np.isfinite(found).all() else np.inf
    else:
        error = np.max(np.abs(found - expected), initial=0.0)
        error /= max(1.0, np.max(np.abs(expected), initial=0.0))
    return Performance(kernel.operations, float(error) if error == error else np.inf)


def _accelerations(e: Equations, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray | None:
    """``v̇`` in natural units by sparse LU, refined once; None where there is no one solution."""
    s, inputs = e.scales, [e.t, state_symbols(e), e.p]
    right = ca.vertcat(e.force - e.bias, e.constraint_acceleration)
    empty = ca.SX(e.constraint_count, e.constraint_count)
    matrix = ca.blockcat([[e.mass, e.jacobian.T], [e.jacobian, empty]])
    evaluate = ca.Function("saddle", inputs, [matrix, ca.densify(right)])
    found, b = evaluate(t, x, p)
    rows = np.concatenate([s.efforts, s.rows / s.time**2])
    columns = np.concatenate([s.speeds / s.time, s.multipliers])
    scaled = scipy.sparse.csc_array(found.sparse())
    scaled = scipy.sparse.csc_array(scaled.multiply(1 / rows[:, None]).multiply(columns[None, :]))
    b = b.full().ravel() / rows
    if not np.isfinite(scaled.data).all() or not np.isfinite(b).all():
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", scipy.sparse.linalg.MatrixRankWarning)
        try:
            factor = scipy.sparse.linalg.splu(scaled)
        except RuntimeError:  # exactly singular
            return None
        z = factor.solve(b)
        z += factor.solve(b - scaled @ z)
    good = np.isfinite(z).all() and np.linalg.norm(b - scaled @ z) <= 1e-10 * (
        np.linalg.norm(b) + np.linalg.norm(abs(scaled) @ np.abs(z))
    )
    return z[: e.speed_count] if good else None
