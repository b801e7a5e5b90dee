"""Backward differences of equal spacing and the BDF coefficients."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

KAPPA = np.array([0, -0.1850, -1 / 9, -0.0823, -0.0415, 0, 0])
"""κ_k by order: numerical differentiation formulas (Klopfenstein 1971)."""
GAMMA = np.append(0, np.cumsum(1 / np.arange(1, 7)))
ALPHA = (1 - KAPPA) * GAMMA
ERROR = KAPPA * GAMMA + 1 / np.arange(1, 8)
"""By order k: the error of a step is ``ERROR[k] ∇^{k+1}x`` to first order."""


def by_order(k: ca.SX, values: Sequence[float]) -> ca.SX:
    """``values[k]`` for a symbolic order k."""
    return sum(((k == j) * float(v) for j, v in enumerate(values) if j), ca.SX(0))


def rescaling(order: int, factor: ca.SX) -> ca.SX:
    """(order, order) matrix that rescales rows ``[D₁ … D_k]`` to spacing ``factor``.

    It is ``R(θ) R(1)`` with ``R_ij = Π_{m≤i} (m − 1 − θ j)/m`` (Shampine and Reichelt 1997).
    """

    def ladder(ratio) -> list[list]:
        rows: list[list] = [[1] * (order + 1)]
        for i in range(1, order + 1):
            rows.append([rows[-1][j] * (i - 1 - ratio * j) / i for j in range(order + 1)])
        return rows

    left, right = ladder(factor), ladder(1)
    out = ca.SX.zeros(order, order)
    for i in range(1, order + 1):
        for j in range(1, i + 1):  # differences vanish on polynomials of lower degree
            out[i - 1, j - 1] = sum(left[i][m] * right[m][j] for m in range(1, j + 1))
    return out
