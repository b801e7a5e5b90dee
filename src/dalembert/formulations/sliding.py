"""Saddle system with sliding friction, whose forces depend on the multipliers.

    ⎡M  Cᵀ⎤ ⎡v̇⎤ − ⎡F⎤ λ = r,      F = ∂(Uᵀ T)/∂λ,  T = −μ N slip/|slip|
    ⎣C  0 ⎦ ⎣λ ⎦   ⎣0⎦

differs from the matrix ``K`` without friction by few columns ``F E``, where ``E`` selects the
normal forces. With ``Z = K⁻¹F`` its solution is ``z + Z (1 − E Z)⁻¹ E z`` for ``z = K⁻¹r``
(Woodbury). The determinant of ``1 − E Z`` vanishes at frictional jamming (Painlevé 1895).
"""

from __future__ import annotations

import casadi as ca

from dalembert.formulations.base import SaddleSolver
from dalembert.model.graph.equations import Equations


class SlidingSolver(SaddleSolver):
    """Solver of the unsymmetric system by the factors of the frictionless one.

    Parameters
    ----------
    frictionless : solver without friction
    e : Equations with ``rubbing``
    """

    def __init__(self, frictionless: SaddleSolver, e: Equations):
        self.frictionless, self.speed_count = frictionless, e.speed_count
        slopes = ca.sparsify(ca.jacobian(e.rubbing, e.multiplier))
        normal_forces = sorted(set(slopes.sparsity().get_triplet()[1]))
        size = e.speed_count + e.constraint_count
        zeros = ca.SX.zeros(e.constraint_count, len(normal_forces))
        self.columns = ca.vertcat(ca.densify(slopes[:, normal_forces]), zeros)
        self.pick = ca.SX.zeros(len(normal_forces), size)
        for k, number in enumerate(normal_forces):
            self.pick[k, e.speed_count + number] = 1

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        solution = self._solve(ca.vertcat(r1, r2), self.columns, self.pick)
        return solution[: self.speed_count, :], solution[self.speed_count :, :]

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        return self._solve(rhs, self.pick.T, self.columns.T)

    def _solve(self, rhs: ca.SX, columns: ca.SX, rows: ca.SX) -> ca.SX:
        solve = self.frictionless.solve_stacked
        z, z_columns = solve(rhs), solve(columns)
        small = ca.SX.eye(rows.shape[0]) - ca.mtimes(rows, z_columns)
        return z + ca.mtimes(z_columns, ca.solve(ca.densify(small), ca.mtimes(rows, z)))
