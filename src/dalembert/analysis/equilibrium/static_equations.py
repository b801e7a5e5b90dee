"""Equilibrium of a structure under a share of one load case, ``∂W/∂u = s (P − ∂V/∂u)``.

``V`` comprises the loads that depend on the displacements: hindered thermal expansion, moments
about fixed axes. Statics, load paths and their gradients use these equations.

The unbalanced forces are measured against the terms whose difference they are: inertia, internal
and external forces. A moment is compared with forces at the arm of an element, so that units do not
matter. The rounding error of a force does not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.model.assembled.evaluation.stiffness_solvers import factors_of
from dalembert.model.assembled.model import StructuralModel
from dalembert.sparse.solver import Factors, SparseSolver
from dalembert.symbolic.equations.newton import NewtonSettings, Residual

ROUNDING = 1e-13
"""Rounding error of a force, relative to the magnitudes of its terms, row by row."""


@dataclass(frozen=True)
class ForceResidual(Residual):
    """Unbalanced forces, with the stiffness (n, n) there."""

    rounding: np.ndarray
    stiffness: Any = field(kw_only=True)


class Balance:
    """Scales of the forces on a structure.

    Parameters
    ----------
    model : StructuralModel
    p : (np,) values of the parameters
    """

    def __init__(self, model: StructuralModel, p: np.ndarray):
        self.arms = np.where(model.degrees.rotations, model.assembly.arm(p), 1.0)

    def residual(
        self,
        terms: Sequence[np.ndarray],
        magnitudes: np.ndarray,
        rows: np.ndarray,
        stiffness: Any = None,
    ) -> ForceResidual:
        """Unbalanced forces with their scale.

        Parameters
        ----------
        terms : (n,) each, forces whose sum should vanish
        magnitudes : (n,) magnitudes of the numbers in the sum
        rows : numbers of the displacements whose forces balance
        stiffness : (n, n) stiffness for the next iteration, if any
        """
        largest = max((np.abs(term / self.arms).max(initial=0.0) for term in terms), default=0.0)
        total = sum(terms, np.zeros_like(self.arms))
        scale, rounding = largest * self.arms[rows], ROUNDING * magnitudes[rows]
        return ForceResidual(total[rows], scale, rounding, stiffness=stiffness)


def full_steps(strategy: Any) -> NewtonSettings:
    """Settings of Newton's method with full steps, from an analysis or integrator.

    Residuals of slender structures grow on the way to equilibrium; load steps or time steps that
    are too long are divided instead.
    """
    return NewtonSettings(
        tolerance=strategy.tolerance, max_iterations=strategy.max_iterations, halvings=0
    )


@dataclass(frozen=True)
class StaticsRecord:
    """Data for gradients: the stiffness, and a solver of its free part ``K_ff``."""

    factor: SparseSolver | None
    stiffness: Any

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of ``K_ff``; zero where factors do not count them."""
        return self.factor.negative if isinstance(self.factor, Factors) else 0


def free_factors(model: StructuralModel, matrix: Any) -> Factors | None:
    """Sparse factors of the stiffness of the free displacements; None if all are prescribed.

    Raises
    ------
    SingularityError
        It is singular; names the nodes that can move without strain.
    """
    return factors_of(matrix, model.degrees, model.assembly.free)


class StaticEquations:
    """Equilibrium equations of one load case at parameter values.

    Parameters
    ----------
    model : StructuralModel
    p : (np,) parameters
    case : load case
    time : at which loads and prescribed displacements are evaluated [s]

    Attributes
    ----------
    applied : (n,) ``P``
    prescribed : prescribed displacements, which grow with the load
    """

    def __init__(self, model: StructuralModel, p: np.ndarray, case: str, time: float = 0.0):
        self.model, self.p, self.case, self.assembly = model, p, case, model.assembly
        self.free, self.held = self.assembly.free, self.assembly.prescribed
        loads = model.loads[case]
        self.applied, self.moving = loads.values(p, time), loads.configuration
        self.prescribed, self.balance = model.prescribed.values(p, time), Balance(model, p)

    def internal_terms(
        self, u: np.ndarray, share: float, strain: np.ndarray | None = None
    ) -> list[np.ndarray]:
        """Internal forces (n,): of strain, and those of displacement-dependent loads."""
        forces = [self.assembly.internal_forces(u, self.p) if strain is None else strain]
        return [*forces, share * self.moving.forces(u, self.p)] if self.moving else forces

    def stiffness(self, u: np.ndarray, share: float) -> Any:
        """(n, n) derivative of the internal forces."""
        stiffness = self.assembly.stiffness(u, self.p)
        return stiffness + share * self.moving.stiffness(u, self.p) if self.moving else stiffness

    def unbalanced(
        self, u: np.ndarray, share: float, strain: np.ndarray | None = None
    ) -> np.ndarray:
        """(n,) unbalanced forces, negative reactions at supports; ``strain`` forces if known."""
        applied = share * self.applied
        return applied - sum(self.internal_terms(u, share, strain), np.zeros_like(applied))

    def residual(self, u: np.ndarray, share: float) -> ForceResidual:
        """Unbalanced forces on the free displacements, with their scale and the stiffness."""
        stiffness = self.stiffness(u, share)
        terms = [share * self.applied, *(-part for part in self.internal_terms(u, share))]
        magnitudes = abs(stiffness) @ np.abs(u)
        return self.balance.residual(terms, magnitudes, self.free, stiffness)

    def size(self, unbalanced: np.ndarray) -> float:
        """Largest unbalanced force on a free displacement, moments at the arm of an element [N]."""
        return float(np.abs(unbalanced / self.balance.arms)[self.free].max(initial=0.0))

    def factor(self, stiffness: Any) -> Factors | None:
        """Factors of the free part of the whole stiffness."""
        return free_factors(self.model, self.assembly.inner(stiffness))

    def forces(self, u: np.ndarray, share: float) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        return self.with_reactions(share, self.unbalanced(u, share))

    def with_reactions(self, share: float, unbalanced: np.ndarray) -> np.ndarray:
        """(n,) applied forces and reactions, from the unbalanced forces."""
        forces = share * self.applied
        forces[self.held] = 0.0 - unbalanced[self.held]  # no negative zeros
        return forces
