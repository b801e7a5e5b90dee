"""The matrix ``M + CᵀαC`` of the augmented methods, and what is solved with it (7.2).

It is positive definite wherever no motion without mass is free: with redundant constraints, in
singular positions and with massless members too.
"""

from __future__ import annotations

import casadi as ca

from dalembert.formulations.base import SaddleSolver
from dalembert.formulations.effective_mass import mean_effective_mass
from dalembert.model.inertia import Inertia
from dalembert.symbolic.equations.factor import LdlFactor


class AugmentedMass:
    """``M + CᵀαC``, factored once; ``α`` is ``factor`` times the masses that C sees.

    One ``α`` serves all rows, so constraints should be written in metres or radians: a row that is
    multiplied by s is held s² times harder.

    Parameters
    ----------
    inertia, jacobian : ``M`` (n, n), ``C`` (m, n)
    massless : speeds without mass, left out of the mean
    factor : ``α`` over the mean of the masses that the constraints see
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

        Each iteration works on what the last one left over, with M and C kept apart, so the large
        ``α`` costs no digits.
        """
        c = self.jacobian
        x, z = self.solve(r1, r2)
        for _ in range(iterations - 1):
            left1 = r1 - self.inertia.times(x) - ca.mtimes(c.T, z)
            left2 = r2 - ca.mtimes(c, x) + softness * z
            more_x, more_z = self.solve(left1, left2)
            x, z = x + more_x, z + more_z
        return x, z


class AugmentedLagrangianSolver(SaddleSolver):
    """Iterated multipliers (7.5–7.6), ``C x = r2`` as closely as wanted.

    Every round but the first takes the constraint forces ``Cᵀ λ`` of the one before for its load. A
    constraint of relative stiffness ``ε = α σ²/m`` is so held by the share ``(k ε)^rounds`` where
    ``ε`` is small: with two rounds, redundant constraints that are a little independent in the
    intermediate states of a step do not interfere.
    """

    def __init__(self, augmented: AugmentedMass, iterations: int, rounds: int = 2):
        self.augmented, self.iterations, self.rounds = augmented, iterations, rounds
        self.speed_count = augmented.inertia.size

    @property
    def corrector(self) -> AugmentedLagrangianSolver:
        # states to be corrected are nearly right, where one round is as good
        return AugmentedLagrangianSolver(self.augmented, self.iterations, rounds=1)

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        x, z = self.augmented.refined(r1, r2, self.iterations)
        for _ in range(self.rounds - 1):
            load = ca.mtimes(self.augmented.jacobian.T, z)
            more, z = self.augmented.refined(load, ca.SX.zeros(*r2.shape), self.iterations)
            x = x + more
        return x, z
