"""When forces on a structure balance.

What is left over is measured against the terms it is the difference of: inertia, internal and
external forces. A moment is compared with forces at the arm of an element, so that units do not
matter. What rounding alone leaves of a force counts as nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.structures.model import StructuralModel
from dalembert.symbolic.equations.newton import NewtonSettings, Residual

ROUNDING = 1e-13
"""Part of the numbers a force is made of, row by row, that counts as rounding."""


@dataclass(frozen=True)
class Balanced(Residual):
    """Forces left over, with the stiffness (n, n) there."""

    rounding: np.ndarray
    stiffness: Any = field(kw_only=True)


class Balance:
    """Measures of forces on a structure.

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
        made_of: np.ndarray,
        where: np.ndarray,
        stiffness: Any = None,
    ) -> Balanced:
        """What is left over, with its scale.

        Parameters
        ----------
        terms : (n,) each, forces whose sum should vanish
        made_of : (n,) size of the numbers they are made of
        where : numbers of the displacements whose forces balance
        stiffness : (n, n) that a step goes on with, if any
        """
        whole = max((np.abs(term / self.arms).max(initial=0.0) for term in terms), default=0.0)
        rest = sum(terms, np.zeros_like(self.arms))
        scale, noise = whole * self.arms[where], ROUNDING * made_of[where]
        return Balanced(rest[where], scale, noise, stiffness=stiffness)


def full_steps(strategy: Any) -> NewtonSettings:
    """Newton's method of an analysis with tolerance and iterations: steps that are not shortened.

    Residuals of slender structures grow on the way to equilibrium; a load or a step in time that
    is too long is divided instead.
    """
    return NewtonSettings(
        tolerance=strategy.tolerance, max_iterations=strategy.max_iterations, halvings=0
    )
