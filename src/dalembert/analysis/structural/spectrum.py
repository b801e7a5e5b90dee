"""Eigenpairs of symmetric matrices ``A φ = λ B φ``, and the singular systems about them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy

from dalembert.analysis.structural.pencil import Pencil
from dalembert.sparse.eigenvalues import coinciding, residual
from dalembert.sparse.factorise import indefinite_factors
from dalembert.structures.evaluation.eigenpairs import Solve
from dalembert.structures.model import StructuralModel

VANISHES = 1e-13
"""An eigenvalue is zero where it is this share of what its terms would add up to, or less."""


@dataclass(eq=False)
class Spectrum:
    """Some eigenpairs.

    Attributes
    ----------
    pencil : Pencil
    matrices : its ``A`` and ``B``, of the free displacements (f)
    eigenvalues : (m,) ``λ``
    vectors : (f, m) shapes, ``φᵀ B φ = 1``
    count : of those that are wanted
    """

    pencil: Pencil
    matrices: tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]
    eigenvalues: np.ndarray
    vectors: np.ndarray
    count: int
    time: ClassVar[float] = 0.0
    residual: ClassVar[float | None] = None
    doubts: ClassVar[tuple[str, ...]] = ()
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
        """How many displacements there are, and how many can move."""
        return {"displacements": self.model.assembly.size, "free": int(self.pencil.free.size)}

    def displacements(self, positions: np.ndarray) -> np.ndarray:
        """(n, k) shapes."""
        return self.shapes[:, positions]

    def wanted(self) -> np.ndarray:
        """(k,) the first ones."""
        return np.arange(min(self.count, self.eigenvalues.size))

    def following(self, earlier: Spectrum, positions: np.ndarray) -> np.ndarray:
        """The same places, with shapes turned to the side to which those of earlier ones point."""
        k = min(self.eigenvalues.size, earlier.eigenvalues.size)
        heavy = self.matrices[1] @ self.vectors[:, :k]
        sides = np.einsum("fk,fk->k", earlier.vectors[:, :k], heavy)
        self.vectors[:, :k] *= np.where(sides < 0, -1.0, 1.0)
        return positions[positions < self.eigenvalues.size]

    @cached_property
    def shapes(self) -> np.ndarray:
        """(n, m) of all displacements."""
        found = np.zeros((self.pencil.model.assembly.size, self.eigenvalues.size))
        found[self.pencil.free] = self.vectors
        return found

    @cached_property
    def groups(self) -> list[list[int]]:
        """Positions of eigenvalues, those together that coincide."""
        return coinciding(self.eigenvalues, np.abs(self.eigenvalues))

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
        matrix = (a - self.eigenvalues[group].mean() * b).tocsc()[kept][:, kept]
        if not kept.size:
            return kept, lambda rhs: rhs
        return kept, indefinite_factors(matrix).solve

    @property
    def left(self) -> float:
        """What is left of the equation of the pairs."""
        return residual(*self.matrices, self.eigenvalues, self.vectors)
