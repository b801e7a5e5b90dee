"""Implicit elimination: direct solution of the saddle system (5.7), also with sliding friction.

Friction at sliding contacts depends on the multipliers. Its saddle system

    ⎡M  Cᵀ⎤ ⎡v̇⎤ − ⎡F⎤ λ = r,      F = ∂(Uᵀ T)/∂λ,  T = −μ N slip/|slip|
    ⎣C  0 ⎦ ⎣λ ⎦   ⎣0⎦

differs from the matrix ``K`` without friction by few columns ``F E``, where ``E`` selects the
normal forces. With ``Z = K⁻¹F`` its solution is ``z + Z (1 − E Z)⁻¹ E z`` for ``z = K⁻¹r``
(Woodbury). The determinant of ``1 − E Z`` vanishes at frictional jamming (Painlevé 1895).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.formulations.base import Formulation, SaddleSolver
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.model.graph.scales import Scales
from dalembert.symbolic.equations.factor import QrFactor


class KKTSolver(SaddleSolver):
    """Sparse Householder QR of the saddle matrix (5.7), scaled by natural sizes if given."""

    def __init__(self, inertia: Inertia, jacobian: ca.SX, scales: Scales | None = None):
        mass = inertia.matrix
        self.speed_count = mass.shape[0]
        m = jacobian.shape[0]
        matrix = ca.vertcat(ca.horzcat(mass, jacobian.T), ca.horzcat(jacobian, ca.SX(m, m)))
        rows = columns = None
        if scales is not None:  # sizes of accelerations and multipliers
            rows = np.concatenate([scales.efforts, scales.rows / scales.time**2])
            columns = np.concatenate([scales.speeds / scales.time, scales.multipliers])
        self.factor = QrFactor(matrix, rows, columns)

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        solution = self.factor.solve(ca.vertcat(r1, r2))
        return solution[: self.speed_count, :], solution[self.speed_count :, :]


@dataclass(frozen=True)
class KKT(Formulation):
    """Implicit elimination: ``[M Cᵀ; C 0] [v̇; λ] = [f − d; ξ]`` (5.7) solved directly.

    Supports massless bodies; costs more than ``RangeSpace``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("rod without mass", gravity=(0, -10))
    >>> rod = system.add(planar.Bar("rod", length=1.0))
    >>> bob = system.add(planar.Particle("bob", mass=2.0, position=(1, 0)))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, rod.start))
    >>> end = system.add(planar.Revolute("A", rod.end, bob.center))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1, formulation=da.KKT())
    >>> round(motion["bob.ay"][0].item(), 6)
    -10.0
    """

    @property
    def needs_mass(self) -> bool:
        return False

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> KKTSolver:
        return KKTSolver(inertia, jacobian)

    def saddle_at(self, e: Equations, inertia: Inertia, jacobian: ca.SX) -> KKTSolver:
        return KKTSolver(inertia, jacobian, e.scales)


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
