"""Dead centres: folds of the solution curve of a driven mechanism.

At a dead centre the curve ``(y(s), t(s))`` of ``Φ(y, t) = 0`` turns back in time. Its point is a
regular root of the fold system ``Φ = 0, Φ_y n = 0, nᵀn = 1`` (Moore and Spence 1980).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np


@dataclass(frozen=True)
class Fold:
    """A dead centre: its time, position and the direction in which the mechanism still moves."""

    time: float
    y: np.ndarray
    direction: np.ndarray


def find_fold(driven: ca.Function, time: float, y: np.ndarray, p: np.ndarray) -> Fold | None:
    """Fold nearest to a position just before it, by Newton's method.

    Parameters
    ----------
    driven : ``(t, y, p) → Φ, Φ_y, Φ_t``
    time, y : last position reached
    """
    n = y.size
    jacobian = driven(time, y, p)[1].full()
    direction = np.linalg.svd(jacobian)[2][-1]
    z = np.concatenate([y, direction, [time]])
    system = _fold_system(driven, direction)
    norm = np.inf
    for _ in range(30):
        residual, derivative = (a.full() for a in system(z, p))
        norm = np.abs(residual).max()
        if not np.isfinite(norm):
            return None
        if norm < 1e-13:
            break
        try:
            z = z - np.linalg.solve(derivative, residual.ravel())
        except np.linalg.LinAlgError:
            return None
    near = abs(z[-1] - time) <= 1e-2 * max(1.0, abs(time))
    if norm > 1e-9 or not near or not _turns_back(driven, z[-1], z[:n], p):
        return None
    return Fold(float(z[-1]), z[:n], z[n : 2 * n])


def _turns_back(driven: ca.Function, time: float, y: np.ndarray, p: np.ndarray) -> bool:
    """At a fold ``Φ_t`` leaves the range of ``Φ_y``; at a branch point it stays in it."""
    _, phi_y, phi_t = (a.full() for a in driven(time, y, p))
    left = np.linalg.svd(phi_y.T)[2][-1]
    return bool(abs(left @ phi_t.ravel()) > 1e-6 * np.linalg.norm(phi_t))


def _fold_system(driven: ca.Function, direction: np.ndarray) -> ca.Function:
    n = direction.size
    z, p = ca.MX.sym("z", 2 * n + 1), ca.MX.sym("p", driven.size1_in(2))
    phi, phi_y, _ = driven(z[2 * n], z[:n], p)
    null = z[n : 2 * n]
    residual = ca.vertcat(phi, ca.mtimes(phi_y, null), ca.dot(ca.DM(direction), null) - 1)
    return ca.Function("fold", [z, p], [residual, ca.jacobian(residual, z)])
