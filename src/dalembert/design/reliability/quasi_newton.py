"""Quadratic programming steps towards a design point: ``min |u|²/2`` subject to ``G(u) = 0``.

The step ``d`` and the multiplier ``λ`` solve ``B d + λ∇G = −u``, ``∇Gᵀd = −G``. With ``B = I`` this
is the step of Rackwitz and Fiessler, which converges only where the surface bends less than the
sphere about the origin, ``|βκ| < 1``. ``B`` follows the Hessian of ``|u|²/2 + λG`` by damped BFGS
updates (Powell 1978; Liu and Der Kiureghian, Structural Safety 9, 1991), so that the steps converge
at strongly curved surfaces as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

DAMPING = 0.2
"""Smallest ratio of the measured to the predicted curvature of an undamped update."""


CONDITION = 1e-10
"""Ratio of the smallest to the largest eigenvalue below which ``B`` begins anew."""


@dataclass
class LagrangianHessian:
    """``B``, positive definite, of n variables.

    Parameters
    ----------
    size : n
    """

    size: int
    matrix: np.ndarray = field(init=False)
    new: bool = field(init=False)

    def __post_init__(self) -> None:
        self.matrix, self.new = np.eye(self.size), True

    def step(self, u: np.ndarray, g: float, slope: np.ndarray) -> tuple[np.ndarray, float]:
        """(n,) ``d`` and ``λ``."""
        towards = np.linalg.solve(self.matrix, np.column_stack([u, slope]))
        multiplier = (g - slope @ towards[:, 0]) / (slope @ towards[:, 1])
        return -towards @ np.array([1.0, multiplier]), float(multiplier)

    def update(self, moved: np.ndarray, change: np.ndarray) -> None:
        """One BFGS update.

        Parameters
        ----------
        moved : (n,) difference of two points
        change : (n,) difference of the gradients of the Lagrangian there
        """
        ahead = self.matrix @ moved
        predicted, self.new = float(moved @ ahead), False
        if not predicted > 1e-30:
            return
        measured = float(moved @ change)
        if measured < DAMPING * predicted:
            share = (1 - DAMPING) * predicted / (predicted - measured)
            change = share * change + (1 - share) * ahead
            measured = float(moved @ change)
        self.matrix = (
            self.matrix - np.outer(ahead, ahead) / predicted + np.outer(change, change) / measured
        )
        sizes = np.linalg.eigvalsh(self.matrix)
        if not sizes[0] > CONDITION * sizes[-1]:
            self.__post_init__()
