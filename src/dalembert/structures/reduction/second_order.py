"""Displacements of second order that go with shapes, such as the shortening of a bent beam.

Shapes ``φ_k, φ_l`` strain the structure in the second order; static displacements ``Θ_kl`` relieve
it, ``K Θ_kl = −(∂K/∂u · φ_k) φ_l`` with the frame at rest (static modal derivatives: Jain, Tiso,
Rutzmoser and Rixen, A quadratic manifold for model order reduction of nonlinear structural
dynamics, Computers & Structures 188, 2017). Their inertia makes centrifugal stiffening, as in
Kane, Ryan and Banerjee (1987). With them the strain energy stays ``½ qᵀ K q`` to the third order,
where products with a softer shape move the stiffest shape of three only, shared among equals.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.interface import Interface

NONE = 1e-7
"""Share of the largest displacement of second order below which one is left out."""


class Relief:
    """Displacements of second order.

    Parameters
    ----------
    held : interface in which the frame is fixed
    shapes : (n, m) with the frame at rest, by rising stiffness where they were chosen
    stiffness : (m, m) of the shapes
    pairs : (k, 2) shapes; those whose products have such displacements where None is given

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
        every = np.array(list(combinations_with_replacement(range(count), 2)), dtype=int)
        self.pairs = every.reshape(-1, 2) if pairs is None else pairs
        self.strained = [reduced.assembly.geometric(shapes[:, k], reduced.p) for k in range(count)]
        self.loads = np.stack([self.strained[k] @ shapes[:, l] for k, l in self.pairs], axis=1)
        self.moving = self._moving()
        self.full, self.moves = self.relieved(-self.loads)
        self.third = shapes.T @ self.loads
        self.along = np.linalg.solve(stiffness, self.left * self.third)
        self.shapes = (self.full + shapes @ self.along) * self.halves
        if pairs is None:
            sizes = np.abs(self.shapes).max(axis=0)
            self._keep(sizes > NONE * sizes.max(initial=0.0))

    def _keep(self, kept: np.ndarray) -> None:
        self.pairs = self.pairs[kept]
        for name in ("loads", "full", "moves", "third", "along", "shapes"):
            setattr(self, name, getattr(self, name)[:, kept])

    @property
    def halves(self) -> np.ndarray:
        """(k,) one half for squares."""
        return np.where(self.pairs[:, 0] == self.pairs[:, 1], 0.5, 1.0)

    @property
    def left(self) -> np.ndarray:
        """(m, k) part of what the full relief moves along shape i that is taken back."""
        count = self.first.shape[1]
        return np.array([[1.0 - _share(i, k, l) for k, l in self.pairs] for i in range(count)])

    def _moving(self) -> np.ndarray:
        """Numbers of the coordinates of the interfaces that move."""
        size = np.arange(sum(i.motions.shape[1] for i in self.reduced.interfaces))
        return np.setdiff1d(size, size[self.reduced.columns[self.held.name]])

    def relieved(
        self, loads: np.ndarray, at_interfaces: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n, k) static displacements under loads, the held interface at rest, the others rigid.

        By the coordinates of the interfaces, which come along, and what the loads do between them,
        which do no work on each other.
        """
        inner, reduced = self.reduced.assembly, self.reduced
        found = np.zeros_like(loads)
        if reduced.factor is not None:
            found[inner.free] = reduced.factor.solve(loads[inner.free])
        modes = reduced.shapes[:, self.moving]
        efforts = modes.T @ loads
        if at_interfaces is not None:
            efforts += at_interfaces
        if not self.moving.size:
            return found, efforts
        stiffness = reduced.stiffness[np.ix_(self.moving, self.moving)]
        moves = np.linalg.solve(stiffness, efforts)
        return found + modes @ moves, moves


def _share(i: int, k: int, l: int) -> float:
    """Part of the relief of shapes k and l along shape i, by which is the stiffest of the three."""
    three = (i, k, l)
    return 1.0 / three.count(i) if i == max(three) else 0.0
