"""Eigenpairs of symmetric matrices ``A φ = λ B φ``, and the singular systems about them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.linalg as dense
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

from dalembert.analysis.structural.pencil import Pencil
from dalembert.errors import AnalysisError

Solve = Callable[[np.ndarray], np.ndarray]
Pairs = tuple[np.ndarray, np.ndarray]

DENSE = 200
"""Displacements up to which all eigenpairs are found at once."""
COINCIDE = 1e-7
"""Relative distance below which eigenvalues cannot be told apart."""
VANISHES = 1e-13
"""An eigenvalue is zero where it is this share of what its terms would add up to, or less."""
NONE = 1e-11
"""Share of the largest one below which an eigenvalue of a matrix is round-off."""


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
    matrices: tuple[sparse.csc_matrix, sparse.csc_matrix]
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
        found: list[list[int]] = []
        for k in np.argsort(self.values):
            value = self.values[k]
            if found:
                last = self.values[found[-1][-1]]
                if abs(value - last) <= COINCIDE * max(abs(value), abs(last)):
                    found[-1].append(int(k))
                    continue
            found.append([int(k)])
        return [sorted(group) for group in found]

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
        held = dense.qr(self.vectors[:, group].T, pivoting=True, mode="r")[1][: len(group)]
        kept = np.setdiff1d(np.arange(a.shape[0]), held)
        matrix = (a - self.values[group].mean() * b).tocsc()[kept][:, kept]
        if not kept.size:
            return kept, lambda rhs: rhs
        return kept, linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A").solve

    def align(self, earlier: np.ndarray) -> None:
        """Turn shapes so that they point to the side where earlier ones (n, m) do."""
        k = min(self.values.size, earlier.shape[1])
        sides = np.einsum(
            "fk,fk->k", earlier[self.pencil.free][:, :k], self.matrices[1] @ self.vectors[:, :k]
        )
        self.vectors[:, :k] *= np.where(sides < 0, -1.0, 1.0)

    @property
    def residual(self) -> float:
        """Largest entry of ``A φ − λ B φ``, relative to what its terms would add up to."""
        (a, b), v = self.matrices, self.vectors
        left = np.abs(a @ v - (b @ v) * self.values).max(axis=0, initial=0.0)
        size = (abs(a) @ abs(v) + (abs(b) @ abs(v)) * abs(self.values)).max(axis=0, initial=1e-300)
        return float((left / size).max(initial=0.0))


def nearest(a, b, count: int, shift: float, solve: Solve) -> Pairs:
    """Eigenpairs nearest to a shift ``σ``, by increasing eigenvalue; ``B`` may be singular.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive semi-definite
    solve : of ``(A − σ B) x = y``

    Raises
    ------
    AnalysisError
        ``B`` is zero, or the iteration does not converge.
    """
    scale = np.sqrt(np.maximum(b.diagonal(), 0.0))
    if not scale.any():
        raise AnalysisError("nothing that can move has mass; give elements a density")
    if a.shape[0] <= DENSE:
        theta, vectors = _all_inverted(b, scale, solve)
    else:
        operator = linalg.LinearOperator(a.shape, solve, dtype=float)
        count = min(count, int((scale > 0).sum()) - 1)
        values, vectors = _iterated(a, count, M=b, sigma=shift, which="LM", OPinv=operator)
        theta, vectors = 1.0 / (values - shift), solve(b @ vectors)  # rids them of massless parts
    kept = np.argsort(-np.abs(theta), kind="stable")[:count]
    kept = kept[np.abs(theta[kept]) > NONE * np.abs(theta).max()]
    values = shift + 1.0 / theta[kept]
    order = np.argsort(values, kind="stable")
    return values[order], _normalised(vectors[:, kept[order]], b)


def _all_inverted(b, scale: np.ndarray, solve: Solve) -> Pairs:
    """All ``θ`` of ``(A − σ B)⁻¹ B`` that are not zero: with ``B = L Lᵀ`` those of
    ``Lᵀ (A − σ B)⁻¹ L``."""
    inverse = np.where(scale > 0, 1.0 / np.where(scale > 0, scale, 1.0), 0.0)
    squares, turned = np.linalg.eigh(inverse[:, None] * b.toarray() * inverse)
    some = squares > NONE * squares.max()
    root = scale[:, None] * turned[:, some] * np.sqrt(squares[some])
    flexible = solve(root)
    matrix = root.T @ flexible
    theta, y = np.linalg.eigh((matrix + matrix.T) / 2)
    if some.all():
        return theta, inverse[:, None] * turned / np.sqrt(squares) @ y
    return theta, flexible @ y


def largest(a, b, count: int, solve: Solve, both_signs: bool) -> Pairs:
    """Largest positive eigenvalues, falling; or the largest of both signs.

    Parameters
    ----------
    a, b : (f, f) sparse, symmetric; ``B`` positive definite
    solve : of ``B x = y``
    """
    if a.shape[0] <= DENSE:
        values, vectors = dense.eigh(a.toarray(), b.toarray())
    else:
        operator = linalg.LinearOperator(a.shape, solve, dtype=float)
        which = "LM" if both_signs else "LA"
        values, vectors = _iterated(a, min(count, a.shape[0] - 1), M=b, Minv=operator, which=which)
    kept = np.abs(values) > NONE * np.abs(values).max(initial=0.0)
    if not both_signs:
        kept &= values > 0
    order = np.flatnonzero(kept)
    order = order[np.argsort(-np.abs(values[order]), kind="stable")][:count]
    return values[order], _normalised(vectors[:, order], b)


def _iterated(a, count: int, **options) -> Pairs:
    start = np.random.default_rng(0).standard_normal(a.shape[0])
    try:
        return linalg.eigsh(a, count, v0=start, ncv=min(a.shape[0], 2 * count + 20), **options)
    except linalg.ArpackError as error:
        raise AnalysisError(f"the search for eigenvalues failed ({error}); ask for fewer") from None


def _normalised(vectors: np.ndarray, b) -> np.ndarray:
    """``φᵀ B φ = 1``, and the largest entry positive (the first one of equals)."""
    vectors = vectors / np.sqrt(np.einsum("fk,fk->k", vectors, b @ vectors))
    size = np.abs(vectors)
    first = np.argmax(size >= (1 - 1e-6) * size.max(axis=0), axis=0)
    return vectors * np.where(vectors[first, np.arange(first.size)] < 0, -1.0, 1.0)
