"""Second-order displacements of shapes, such as the shortening of a bent beam.

Shapes ``φ_k, φ_l`` strain the structure in the second order; static displacements ``Θ_kl`` relieve
the strain, ``K Θ_kl = −(∂K/∂u · φ_k) φ_l`` with the frame at rest (static modal derivatives: Jain,
Tiso, Rutzmoser and Rixen, A quadratic manifold for model order reduction of nonlinear structural
dynamics, Computers & Structures 188, 2017). Their inertia causes centrifugal stiffening, as in
Kane, Ryan and Banerjee (1987). With them the strain energy is ``½ qᵀ K q`` up to the third order,
if products with a softer shape move only the stiffest of three shapes, shared among equals.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.rigid import Interface

NONE = 1e-7
"""Threshold of a second-order displacement, relative to the largest, below which it is omitted."""


class Relief:
    """Second-order displacements.

    Parameters
    ----------
    held : interface to which the frame is fixed
    shapes : (n, m) with the frame at rest, by increasing stiffness where they were chosen
    stiffness : (m, m) of the shapes
    pairs : (k, 2) shapes; None selects the pairs with significant displacements

    Attributes
    ----------
    shapes : (n, k) displacements of ``q_k q_l``
    """

    def __init__(
        self,
        reduced: CraigBampton,
        held: Interface,
        shapes: np.ndarray,
        stiffness: np.ndarray,
        pairs: np.ndarray | None,
    ):
        self.reduced, self.held, self.first, self.stiffness = reduced, held, shapes, stiffness
        count = shapes.shape[1]
        all_pairs = np.array(list(combinations_with_replacement(range(count), 2)), dtype=int)
        self.pairs = all_pairs.reshape(-1, 2) if pairs is None else pairs
        self.strained = [reduced.assembly.geometric(shapes[:, k], reduced.p) for k in range(count)]
        self.loads = np.stack([self.strained[k] @ shapes[:, l] for k, l in self.pairs], axis=1)
        self.moving = self._moving()
        self.full, self.moves = self.relieved(-self.loads)
        self.third = shapes.T @ self.loads
        self.along = np.linalg.solve(stiffness, self.subtracted * self.third)
        self.shapes = (self.full + shapes @ self.along) * self.halves
        if pairs is None:
            sizes = np.abs(self.shapes).max(axis=0)
            self._select(sizes > NONE * sizes.max(initial=0.0))

    def _select(self, mask: np.ndarray) -> None:
        self.pairs = self.pairs[mask]
        for name in ("loads", "full", "moves", "third", "along", "shapes"):
            setattr(self, name, getattr(self, name)[:, mask])

    @property
    def halves(self) -> np.ndarray:
        """(k,) one half for squares, otherwise one."""
        return np.where(self.pairs[:, 0] == self.pairs[:, 1], 0.5, 1.0)

    @property
    def subtracted(self) -> np.ndarray:
        """(m, k) part of the full relief along shape i that is subtracted."""
        count = self.first.shape[1]
        return np.array([[1.0 - _share(i, k, l) for k, l in self.pairs] for i in range(count)])

    def _moving(self) -> np.ndarray:
        """Indices of the coordinates of the moving interfaces."""
        size = np.arange(sum(i.motions.shape[1] for i in self.reduced.interfaces))
        return np.setdiff1d(size, size[self.reduced.columns[self.held.name]])

    def relieved(
        self, loads: np.ndarray, at_interfaces: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n, k) static displacements under loads, with the held interface fixed, the others rigid.

        They are the sum of constraint modes, whose coordinates are also returned, and of
        displacements with fixed interfaces, which are orthogonal in energy.
        """
        inner, reduced = self.reduced.assembly, self.reduced
        displacements = np.zeros_like(loads)
        if reduced.factor is not None:
            displacements[inner.free] = reduced.factor.solve(loads[inner.free])
        modes = reduced.shapes[:, self.moving]
        efforts = modes.T @ loads
        if at_interfaces is not None:
            efforts += at_interfaces
        if not self.moving.size:
            return displacements, efforts
        stiffness = reduced.stiffness[np.ix_(self.moving, self.moving)]
        moves = np.linalg.solve(stiffness, efforts)
        return displacements + modes @ moves, moves


def _share(i: int, k: int, l: int) -> float:
    """Part of the relief of shapes k and l along shape i, by their order of stiffness."""
    three = (i, k, l)
    return 1.0 / three.count(i) if i == max(three) else 0.0
