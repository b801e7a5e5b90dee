"""Eigenpairs of symmetric matrices ``A φ = λ B φ``, and the singular systems of derivatives."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy

from dalembert.analysis.modes.pencil import Pencil
from dalembert.model.assembled.evaluation.eigenpairs import Solve
from dalembert.model.assembled.model import StructuralModel
from dalembert.sparse.eigenvalues import coinciding, residual
from dalembert.sparse.factorise import indefinite_factors

VANISHES = 1e-13
"""Threshold of an eigenvalue, relative to the magnitude of its terms, below which it is zero."""


@dataclass(eq=False)
class Spectrum:
    """Some eigenpairs.

    Attributes
    ----------
    pencil : Pencil
    matrices : its ``A`` and ``B``, of the free displacements (f)
    eigenvalues : (m,) ``λ``
    vectors : (f, m) shapes, ``φᵀ B φ = 1``
    count : number of wanted eigenpairs
    """

    pencil: Pencil
    matrices: tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]
    eigenvalues: np.ndarray
    vectors: np.ndarray
    count: int
    time: ClassVar[float] = 0.0
    residual: ClassVar[float | None] = None
    warnings: ClassVar[tuple[str, ...]] = ()
    _factors: dict[tuple[int, ...], tuple[np.ndarray, Solve]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        size = np.einsum("fk,fk->k", abs(self.vectors), abs(self.matrices[0]) @ abs(self.vectors))
        vanishing = np.abs(self.eigenvalues) <= VANISHES * size
        self.eigenvalues = np.where(vanishing, 0.0, self.eigenvalues)

    @property
    def model(self) -> StructuralModel:
        return self.pencil.model

    @property
    def p(self) -> np.ndarray:
        return self.pencil.left[0].state.p

    @property
    def statistics(self) -> dict[str, Any]:
        """Numbers of all and of free displacements."""
        return {"displacements": self.model.assembly.size, "free": int(self.pencil.free.size)}

    def displacements(self, positions: np.ndarray) -> np.ndarray:
        """(n, k) shapes."""
        return self.shapes[:, positions]

    def wanted(self) -> np.ndarray:
        """(k,) positions of the wanted eigenpairs, the first ones."""
        return np.arange(min(self.count, self.eigenvalues.size))

    def following(self, earlier: Spectrum, positions: np.ndarray) -> np.ndarray:
        """The same positions; signs of the shapes are chosen as in the earlier spectrum."""
        k = min(self.eigenvalues.size, earlier.eigenvalues.size)
        momenta = self.matrices[1] @ self.vectors[:, :k]
        signs = np.einsum("fk,fk->k", earlier.vectors[:, :k], momenta)
        self.vectors[:, :k] *= np.where(signs < 0, -1.0, 1.0)
        return positions[positions < self.eigenvalues.size]

    @cached_property
    def shapes(self) -> np.ndarray:
        """(n, m) shapes in all displacements."""
        shapes = np.zeros((self.pencil.model.assembly.size, self.eigenvalues.size))
        shapes[self.pencil.free] = self.vectors
        return shapes

    @cached_property
    def groups(self) -> list[list[int]]:
        """Positions of the eigenvalues, grouped by coincidence."""
        return coinciding(self.eigenvalues, np.abs(self.eigenvalues))

    def scaled(self, shapes: np.ndarray) -> np.ndarray:
        """(n, k) ``B φ`` of shapes (n, k), the free displacements only."""
        products = np.zeros_like(shapes)
        products[self.pencil.free] = self.matrices[1] @ shapes[self.pencil.free]
        return products

    def solve(self, group: list[int], rhs: np.ndarray) -> np.ndarray:
        """(n, k) solutions of ``(A − λ B) V = R`` for ``R`` (n, k) orthogonal to the group.

        As many entries as there are shapes in the group are fixed to zero, where the shapes differ
        most (Nelson, AIAA Journal 14, 1976); the factors are cached.
        """
        key = tuple(group)
        if key not in self._factors:
            self._factors[key] = self._reduced_system(group)
        rows, solve = self._factors[key]
        solution = np.zeros_like(rhs)
        numbers = self.pencil.free[rows]
        if rows.size:
            solution[numbers] = solve(rhs[numbers])
        return solution

    def _reduced_system(self, group: list[int]) -> tuple[np.ndarray, Solve]:
        a, b = self.matrices
        fixed = scipy.linalg.qr(self.vectors[:, group].T, pivoting=True, mode="r")[1][: len(group)]
        rows = np.setdiff1d(np.arange(a.shape[0]), fixed)
        matrix = (a - self.eigenvalues[group].mean() * b).tocsc()[rows][:, rows]
        if not rows.size:
            return rows, lambda rhs: rhs
        return rows, indefinite_factors(matrix).solve

    @property
    def left(self) -> float:
        """Residual of the equations of the eigenpairs."""
        return residual(*self.matrices, self.eigenvalues, self.vectors)
