"""Equilibrium of a structure under a share of one load case, ``∂W/∂u = s (P − ∂V/∂u)``.

``V`` holds what depends on where the structure is: hindered expansion, moments about fixed axes.
Statics, load paths and their gradients see a structure by these equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.structural.balance import Balance, Balanced
from dalembert.sparse.solver import Factors, SparseSolver
from dalembert.structures.evaluation.factors import factors_of
from dalembert.structures.model import StructuralModel


@dataclass(frozen=True)
class StaticsRecord:
    """What a gradient needs: the stiffness, and what solves with its free part ``K_ff``."""

    factor: SparseSolver | None
    stiffness: Any


def factorised(model: StructuralModel, matrix: Any) -> Factors | None:
    """Sparse factors of the stiffness of the free displacements; None where there are none.

    Raises
    ------
    SingularityError
        It is singular: names the nodes that can move without straining anything.
    """
    return factors_of(matrix, model.degrees, model.assembly.free)


class StaticEquations:
    """Forces of one load case at parameter values.

    Parameters
    ----------
    model : StructuralModel
    p : (np,) parameters
    case : load case

    Attributes
    ----------
    applied : (n,) ``P``
    given : prescribed displacements, which grow with the load
    """

    def __init__(self, model: StructuralModel, p: np.ndarray, case: str):
        self.model, self.p, self.case, self.assembly = model, p, case, model.assembly
        self.free, self.held = self.assembly.free, self.assembly.prescribed
        self.applied, self.moving = model.loads[case].values(p), model.loads[case].configuration
        self.given, self.balance = model.prescribed.values(p), Balance(model, p)

    def holding(
        self, u: np.ndarray, share: float, strain: np.ndarray | None = None
    ) -> list[np.ndarray]:
        """Forces (n,) that hold the displaced elements: of strain, and of what grows with them."""
        forces = [self.assembly.internal_forces(u, self.p) if strain is None else strain]
        return [*forces, share * self.moving.forces(u, self.p)] if self.moving else forces

    def stiffness(self, u: np.ndarray, share: float) -> Any:
        """(n, n) their derivative."""
        found = self.assembly.stiffness(u, self.p)
        return found + share * self.moving.stiffness(u, self.p) if self.moving else found

    def left(self, u: np.ndarray, share: float, strain: np.ndarray | None = None) -> np.ndarray:
        """(n,) forces left over, at prescribed displacements by supports; of strain if known."""
        applied = share * self.applied
        return applied - sum(self.holding(u, share, strain), np.zeros_like(applied))

    def residual(self, u: np.ndarray, share: float) -> Balanced:
        """Forces left over on the free displacements, with their scale and the stiffness."""
        stiffness = self.stiffness(u, share)
        terms = [share * self.applied, *(-part for part in self.holding(u, share))]
        made_of = abs(stiffness) @ np.abs(u)
        return self.balance.residual(terms, made_of, self.free, stiffness)

    def factor(self, stiffness: Any) -> Factors | None:
        """Factors of the part of the whole stiffness that belongs to the free displacements."""
        return factorised(self.model, self.assembly.inner(stiffness))

    def forces(self, u: np.ndarray, share: float) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        return self.supported(share, self.left(u, share))

    def supported(self, share: float, left: np.ndarray) -> np.ndarray:
        """The same of what is left over."""
        found = share * self.applied
        found[self.held] = 0.0 - left[self.held]  # no negative zeros
        return found
