"""Eigenpairs of symmetric matrices ``A φ = λ B φ``, and the singular systems about them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.structural.pencil import Pencil
from dalembert.sparse.eigenvalues import coinciding, residual
from dalembert.sparse.factorise import indefinite_factors
from dalembert.structures.evaluation.eigenpairs import Solve

VANISHES = 1e-13
"""An eigenvalue is zero where it is this share of what its terms would add up to, or less."""


@dataclass(eq=False)
class Spectrum:
    """Some eigenpairs.

    Attributes
    ----------
    pencil : Pencil
    matrices : its ``A`` and ``B``, of the free displacements (f)
    values : (m,) eigenvalues ``λ``
    vectors : (f, m) shapes, ``φᵀ B φ = 1``
    """

    pencil: Pencil
    matrices: tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]
    values: np.ndarray
    vectors: np.ndarray
    _factors: dict[tuple[int, ...], tuple[np.ndarray, Solve]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        size = np.einsum("fk,fk->k", abs(self.vectors), abs(self.matrices[0]) @ abs(self.vectors))
        self.values = np.where(np.abs(self.values) <= VANISHES * size, 0.0, self.values)

    @cached_property
    def shapes(self) -> np.ndarray:
        """(n, m) of all displacements."""
        found = np.zeros((self.pencil.model.assembly.size, self.values.size))
        found[self.pencil.free] = self.vectors
        return found

    @cached_property
    def groups(self) -> list[list[int]]:
        """Positions of eigenvalues, those together that coincide."""
        return coinciding(self.values, np.abs(self.values))

    def scaled(self, shapes: np.ndarray) -> np.ndarray:
        """(n, k) ``B φ`` of shapes (n, k), the free displacements only."""
        found = np.zeros_like(shapes)
        found[self.pencil.free] = self.matrices[1] @ shapes[self.pencil.free]
        return found

    def solve(self, group: list[int], rhs: np.ndarray) -> np.ndarray:
        """(n, k) solutions of ``(A − λ B) V = R`` for ``R`` (n, k) without a part along the group.

        As many entries as there are shapes in the group, where they differ most, are held at zero
        (Nelson, AIAA Journal 14, 1976); the factors are kept.
        """
        key = tuple(group)
        if key not in self._factors:
            self._factors[key] = self._held(group)
        kept, solve = self._factors[key]
        found = np.zeros_like(rhs)
        places = self.pencil.free[kept]
        if kept.size:
            found[places] = solve(rhs[places])
        return found

    def _held(self, group: list[int]) -> tuple[np.ndarray, Solve]:
        a, b = self.matrices
        held = scipy.linalg.qr(self.vectors[:, group].T, pivoting=True, mode="r")[1][: len(group)]
        kept = np.setdiff1d(np.arange(a.shape[0]), held)
        matrix = (a - self.values[group].mean() * b).tocsc()[kept][:, kept]
        if not kept.size:
            return kept, lambda rhs: rhs
        return kept, indefinite_factors(matrix).solve

    def align(self, earlier: np.ndarray) -> None:
        """Turn shapes so that they point to the side where earlier ones (n, m) do."""
        k = min(self.values.size, earlier.shape[1])
        sides = np.einsum(
            "fk,fk->k", earlier[self.pencil.free][:, :k], self.matrices[1] @ self.vectors[:, :k]
        )
        self.vectors[:, :k] *= np.where(sides < 0, -1.0, 1.0)

    @property
    def residual(self) -> float:
        """What is left of the equation of the pairs."""
        return residual(*self.matrices, self.values, self.vectors)
