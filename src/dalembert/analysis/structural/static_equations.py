"""Equilibrium of a structure under a share of one load case, ``∂W/∂u = s (P − ∂V/∂u)``.

``V`` holds what depends on where the structure is: hindered expansion, moments about fixed axes.
Statics at large displacements, load paths and their gradients see a structure by these equations.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.structural.balance import Balance, Balanced
from dalembert.analysis.structural.statics import factorised
from dalembert.sparse.solver import Factors
from dalembert.structures.model import StructuralModel


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

    def holding(self, u: np.ndarray, share: float) -> list[np.ndarray]:
        """Forces (n,) that hold the displaced elements: of strain, and of what grows with them."""
        forces = [self.assembly.internal_forces(u, self.p)]
        return [*forces, share * self.moving.forces(u, self.p)] if self.moving else forces

    def stiffness(self, u: np.ndarray, share: float) -> Any:
        """(n, n) their derivative."""
        found = self.assembly.stiffness(u, self.p)
        return found + share * self.moving.stiffness(u, self.p) if self.moving else found

    def residual(self, u: np.ndarray, share: float) -> Balanced:
        """Forces left over on the free displacements, with their scale and the stiffness."""
        stiffness = self.stiffness(u, share)
        terms = [share * self.applied, *(-part for part in self.holding(u, share))]
        made_of = abs(stiffness) @ np.abs(u)
        return self.balance.residual(terms, made_of, self.free, stiffness)

    def factor(self, stiffness: Any) -> Factors | None:
        """Factors of the stiffness of the free displacements; None where there are none.

        Raises
        ------
        SingularityError
            The structure can move without straining.
        """
        return factorised(self.model, self.assembly.inner(stiffness))

    def forces(self, u: np.ndarray, share: float) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        found = share * self.applied
        internal = sum(self.holding(u, share), np.zeros_like(found))
        found[self.held] = (internal - found)[self.held]
        return found
