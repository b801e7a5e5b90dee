"""Implicit elimination: the saddle system (5.7) solved as it stands."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.formulations.base import Formulation, SaddleSolver
from dalembert.model.inertia import Inertia
from dalembert.symbolic.factor import QrFactor


class KktSolver(SaddleSolver):
    """Sparse Householder QR of the whole saddle matrix (5.7)."""

    def __init__(self, inertia: Inertia, jacobian: ca.SX):
        mass = inertia.matrix
        self.speed_count = mass.shape[0]
        m = jacobian.shape[0]
        matrix = ca.vertcat(ca.horzcat(mass, jacobian.T), ca.horzcat(jacobian, ca.SX(m, m)))
        self.factor = QrFactor(matrix)

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        solution = self.factor.solve(ca.vertcat(r1, r2))
        return solution[: self.speed_count, :], solution[self.speed_count :, :]


@dataclass(frozen=True)
class Kkt(Formulation):
    """Implicit elimination: ``[M Cᵀ; C 0] [v̇; λ] = [f − d; ξ]`` (5.7) solved as it stands.

    Takes massless bodies; costs more than ``RangeSpace``.
    """

    @property
    def needs_mass(self) -> bool:
        return False

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> KktSolver:
        return KktSolver(inertia, jacobian)
