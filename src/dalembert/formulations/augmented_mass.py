"""Augmented mass matrix ``M + CᵀαC`` and solvers with its factors (7.2).

The matrix is positive definite if every motion that the constraints permit has mass: also with
redundant constraints, in singular positions and with massless members.
"""

from __future__ import annotations

import casadi as ca

from dalembert.formulations.base import SaddleSolver
from dalembert.model.graph.inertia import Inertia
from dalembert.symbolic.equations.factor import LdlFactor

LEAST = 1e-6
"""Lower limit of ``C_i M⁻¹ C_iᵀ`` of an equation over their mean [-]: its row may vanish."""


def mean_effective_mass(mass: ca.SX, jacobian: ca.SX, massless: tuple[int, ...]) -> ca.SX:
    """Mean over the equations of ``1/(Σ_k C_ik² / M_kk)``, the effective mass of each alone.

    A weight of this size makes ``Cᵀ C`` comparable with ``M`` in any units and coordinates; a mean
    of the masses does not if speeds are angular and constraints are lengths.

    Parameters
    ----------
    mass, jacobian : ``M`` (n, n), ``C`` (m, n)
    massless : indices of speeds without mass, excluded
    """
    present = [k for k in range(mass.shape[0]) if k not in massless]
    diagonal = ca.densify(ca.diag(mass))[present]
    if not present:
        return ca.SX(1)
    if not jacobian[:, present].nnz():
        return ca.sum1(diagonal) / len(present)
    mobility = ca.mtimes(jacobian[:, present] ** 2, 1 / diagonal)
    rows = mobility.sparsity().row()
    mean = ca.sum1(mobility) / len(rows)
    mean = ca.if_else(mean > 0, mean, 1)
    return sum((1 / (mobility[i] + LEAST * mean) for i in rows), ca.SX(0)) / len(rows)


class AugmentedMass:
    """``M + CᵀαC``, factored once; ``α`` is ``factor`` times the mean effective mass.

    One ``α`` applies to all rows, so constraints should be written in metres or radians: a row
    multiplied by s has a penalty s² times as large.

    Parameters
    ----------
    inertia, jacobian : ``M`` (n, n), ``C`` (m, n)
    massless : indices of speeds without mass, excluded from the mean
    factor : ``α`` over the mean effective mass of the constraints [-]
    """

    def __init__(
        self,
        inertia: Inertia,
        jacobian: ca.SX,
        massless: tuple[int, ...],
        factor: ca.SX | float,
    ):
        mass = inertia.matrix
        self.inertia, self.jacobian = inertia, jacobian
        self.alpha = factor * mean_effective_mass(mass, jacobian, massless)
        self.factor = LdlFactor(mass + self.alpha * ca.mtimes(jacobian.T, jacobian))

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        """``M x + Cᵀ z = r1``, ``C x − z/α = r2``."""
        c = self.jacobian
        x = self.factor.solve(r1 + self.alpha * ca.mtimes(c.T, r2))
        return x, self.alpha * (ca.mtimes(c, x) - r2)

    def refined(
        self, r1: ca.SX, r2: ca.SX, iterations: int, softness: ca.SX | float = 0.0
    ) -> tuple[ca.SX, ca.SX]:
        """``M x + Cᵀ z = r1``, ``C x − ρ z = r2`` by iterating ``z`` (the ``λ*`` of (7.5)).

        Each iteration solves for the residual of the last one, evaluated with separate M and C, so
        that a large ``α`` causes no loss of digits.
        """
        c = self.jacobian
        x, z = self.solve(r1, r2)
        for _ in range(iterations - 1):
            residual1 = r1 - self.inertia.times(x) - ca.mtimes(c.T, z)
            residual2 = r2 - ca.mtimes(c, x) + softness * z
            dx, dz = self.solve(residual1, residual2)
            x, z = x + dx, z + dz
        return x, z


class AugmentedLagrangianSolver(SaddleSolver):
    """Iterated multipliers (7.5–7.6); the residual of ``C x = r2`` falls with the iterations.

    Every round after the first uses the constraint forces ``Cᵀ λ`` of the previous one as its load.
    A constraint of small relative stiffness ``ε = α σ²/m`` is enforced by the fraction
    ``(k ε)^rounds``: with two rounds, redundant constraints that are slightly independent in the
    intermediate states of a step do not interfere.
    """

    def __init__(self, augmented: AugmentedMass, iterations: int, rounds: int = 2):
        self.augmented, self.iterations, self.rounds = augmented, iterations, rounds
        self.speed_count = augmented.inertia.size

    @property
    def corrector(self) -> AugmentedLagrangianSolver:
        # one round suffices for states near the constraints
        return AugmentedLagrangianSolver(self.augmented, self.iterations, rounds=1)

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        x, z = self.augmented.refined(r1, r2, self.iterations)
        for _ in range(self.rounds - 1):
            load = ca.mtimes(self.augmented.jacobian.T, z)
            dx, z = self.augmented.refined(load, ca.SX.zeros(*r2.shape), self.iterations)
            x = x + dx
        return x, z
