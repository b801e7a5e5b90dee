"""Velocity partitioning, ``C = [U W]``: which speeds are independent (6.4).

Speeds are compared in units of ``√m_kk``, so that metres and radians count by the energy they
carry. The independent ones are those that no other speed exceeds: ``|W⁻¹U| ≤ 1`` in these units.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.model.equations import Equations
from dalembert.symbolic.equations.null_space import PartitionBasis

MASSLESS = 1e-6
"""Mass of a speed without mass, by its natural size: it is never independent where others can."""
BEST = 1.01
ALIKE = 1 + 1e-6
"""Coefficients that differ by less are as large."""
SINGULAR = 1e-6
"""Of rows that no others can be made of."""


def speed_weights(e: Equations) -> ca.SX:
    """``√m_kk`` (n,)."""
    mass, missing, natural = ca.densify(ca.diag(e.mass)), list(e.massless), e.scales
    mass[missing] = MASSLESS * natural.mass * (natural.length / natural.displacements[missing]) ** 2
    return ca.sqrt(mass)


def scaled_ratios(e: Equations, independent: tuple[int, ...]) -> ca.SX:
    """``W⁻¹U`` (m, n − m) in units of energy, of t, y, p."""
    basis, weight = PartitionBasis(e.jacobian, independent), speed_weights(e)
    scaled = ca.mtimes(ca.diag(weight[basis.dependent]), basis.ratio)
    return ca.mtimes(scaled, ca.diag(1 / weight[basis.independent]))


def largest_ratio(e: Equations, independent: tuple[int, ...]) -> ca.SX:
    """Largest entry of ``|W⁻¹U|`` in units of energy; one or less is best."""
    ratios = scaled_ratios(e, independent)
    return ca.norm_inf(ca.vec(ratios)) if ratios.numel() else ca.SX(0)


def best_partition(e: Equations, t: float, y: np.ndarray, p: np.ndarray) -> tuple[int, ...]:
    """Indices of the independent speeds at a position.

    Raises
    ------
    SingularityError
        Constraint equations without a value here.
    """
    n, m = e.speed_count, e.constraint_count
    if not 0 < m < n:
        return tuple(range(n)) if m == 0 else ()
    evaluate = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian), speed_weights(e)])
    jacobian, weight = (out.full() for out in evaluate(t, y, p))
    if not (np.all(np.isfinite(jacobian)) and np.all(weight > 0)):
        raise SingularityError(
            f"no independent speeds can be chosen at t = {t:.9g} s: the constraint equations or "
            "masses have no usable value there; use formulation=RangeSpace()"
        )
    rows = np.linalg.qr((jacobian / weight.T).T, mode="complete")[0][:, m:]
    return largest_volume(rows)


def largest_volume(basis: np.ndarray, first: tuple[int, ...] = ()) -> tuple[int, ...]:
    """Rows of a (n, k) matrix that give all others with coefficients of one at most.

    Among rows that are as good, those given first stay, and then those with the lowest numbers: a
    choice that rounding does not make.
    """
    k = basis.shape[1]
    chosen = np.array(first)
    if chosen.size != k or np.linalg.svd(basis[chosen], compute_uv=False)[-1] < SINGULAR:
        chosen = scipy.linalg.qr(basis.T, mode="economic", pivoting=True)[2][:k]
    for _ in range(100 * k):
        share = np.abs(np.linalg.solve(basis[chosen].T, basis.T).T)
        largest = share.max()
        if largest <= BEST:
            break
        rows, columns = np.nonzero(share > largest / ALIKE)
        pick = np.lexsort((rows, -chosen[columns]))[0]
        chosen[columns[pick]] = rows[pick]
    return tuple(int(index) for index in np.sort(chosen))
