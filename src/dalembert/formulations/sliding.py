"""The saddle system with sliding friction, whose forces follow from multipliers.

    ⎡M  Cᵀ⎤ ⎡v̇⎤ − ⎡F⎤ λ = r,      F = ∂(Uᵀ T)/∂λ,  T = −μ N slip/|slip|
    ⎣C  0 ⎦ ⎣λ ⎦   ⎣0⎦

differs from the one without friction ``K`` by few columns ``F E``, ``E`` picking the normal forces.
With ``Z = K⁻¹F`` its solution is ``z + Z (1 − E Z)⁻¹ E z`` for ``z = K⁻¹r`` (Woodbury). The
determinant of ``1 − E Z`` is zero where friction jams (Painlevé 1895).
"""

from __future__ import annotations

import casadi as ca

from dalembert.formulations.base import SaddleSolver
from dalembert.model.equations import Equations


class SlidingSolver(SaddleSolver):
    """Solves the system, which is not symmetric, by the factors of the one without friction.

    Parameters
    ----------
    bare : solver without friction
    e : Equations with ``rubbing``
    """

    def __init__(self, bare: SaddleSolver, e: Equations):
        self.bare, self.speed_count = bare, e.speed_count
        slopes = ca.sparsify(ca.jacobian(e.rubbing, e.multiplier))
        picked = sorted(set(slopes.sparsity().get_triplet()[1]))
        size = e.speed_count + e.constraint_count
        rest = ca.SX.zeros(e.constraint_count, len(picked))
        self.columns = ca.vertcat(ca.densify(slopes[:, picked]), rest)
        self.pick = ca.SX.zeros(len(picked), size)
        for k, number in enumerate(picked):
            self.pick[k, e.speed_count + number] = 1

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        found = self._solve(ca.vertcat(r1, r2), self.columns, self.pick)
        return found[: self.speed_count, :], found[self.speed_count :, :]

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        return self._solve(rhs, self.pick.T, self.columns.T)

    def _solve(self, rhs: ca.SX, columns: ca.SX, rows: ca.SX) -> ca.SX:
        z, spread = self.bare.solve_stacked(rhs), self.bare.solve_stacked(columns)
        small = ca.SX.eye(rows.shape[0]) - ca.mtimes(rows, spread)
        return z + ca.mtimes(spread, ca.solve(ca.densify(small), ca.mtimes(rows, z)))
