"""Delassus operator of contacts in factors, ``H = W A⁻¹ Wᵀ``."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.integrators.contact.block_ordering import (
    ORDERING,
    BlockOrdering,
    BlockOrderings,
)
from dalembert.integrators.contact.compressed_rows import Rows
from dalembert.integrators.contact.system_pattern import SystemPattern
from dalembert.sparse.factorise import SuperLUFactors
from dalembert.symbolic.evaluation.kernel import Matrix, dense_array

DENSE = 100
"""Upper limit of rows below which the matrix itself is cheaper than its factors."""
SMALL = 20_000
"""Upper limit of entries below which products of dense matrices are cheaper than sparse ones."""
MULTIPLICATIONS = 200_000
"""Upper limit of multiplications in one product. BLAS computes larger ones in threads, whose start
takes milliseconds where other programs use the processor."""
SHARED = "_own", "product", "compressed"
"""Properties of an operator that do not depend on its shift; the last ones of arrays."""


@dataclass(frozen=True, eq=False)
class Delassus:
    """``H + diag(shift)``, stored by the bodies of each contact.

    Attributes
    ----------
    directions : (r, n) ``W``, compressed by rows; an array for up to ``DENSE`` rows and few speeds
    responses : (r, n) speeds by unit impulses, ``W A⁻ᵀ``, in the same form
    inertia : (n, n) ``A``
    joints : (m, n) constraints on the speeds
    shift : (r,) addition to the diagonal
    patterns : of Newton's method by the width of contacts, once they are known
    orderings : orders of elimination of free bodies; None for bodies with joints
    """

    directions: Matrix
    responses: Matrix
    inertia: Matrix
    joints: Matrix
    shift: np.ndarray
    patterns: dict[int, SystemPattern] = field(default_factory=dict, repr=False)
    orderings: BlockOrderings | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of ``H``."""
        return self.shift.size, self.shift.size

    @cached_property
    def dense(self) -> np.ndarray | None:
        """The matrix of few contacts; None for more."""
        if self.shift.size > DENSE:
            return None
        matrix = self.product.copy()
        matrix[np.diag_indices_from(matrix)] += self.shift
        return matrix

    @cached_property
    def product(self) -> np.ndarray:
        """(r, r) ``H``, without the shift."""
        if not self.is_dense:
            return dense_array(self.directions @ self.responses.T)
        rows = max(MULTIPLICATIONS // max(self.responses.size, 1), 1)
        starts = range(0, max(self.directions.shape[0], 1), rows)
        parts = [self.directions[k : k + rows] @ self.responses.T for k in starts]
        return np.concatenate(parts) if len(parts) > 1 else parts[0]

    @cached_property
    def compressed(self) -> tuple[Rows, Rows]:
        """Directions and responses compressed by rows."""
        if not self.is_dense:
            return self.directions, self.responses
        return Rows.of(self.directions), Rows.of(self.responses)

    @property
    def is_dense(self) -> bool:
        """Whether directions and responses are arrays."""
        return isinstance(self.directions, np.ndarray)

    def __matmul__(self, impulses: np.ndarray) -> np.ndarray:
        if self.is_dense:
            return np.asarray(self.product @ impulses + self.shift * impulses)
        return np.asarray(self.directions @ self.response(impulses) + self.shift * impulses)

    def response(self, impulses: np.ndarray) -> np.ndarray:
        """(n,) speeds of the bodies by impulses (r,)."""
        x = self.responses
        if self.is_dense:
            return np.asarray(impulses @ x)
        values = x.data * np.repeat(impulses, np.diff(x.indptr))
        return np.bincount(x.indices, values, x.shape[1])

    def diagonal(self) -> np.ndarray:
        """(r,) diagonal."""
        return self._own + self.shift

    @cached_property
    def _own(self) -> np.ndarray:
        """(r,) diagonal of ``H``."""
        w, x = self.directions, self.responses
        if self.is_dense:
            return self.product.diagonal()
        if np.array_equal(w.indices, x.indices):
            row = np.repeat(np.arange(self.shift.size), np.diff(w.indptr))
            return np.bincount(row, w.data * x.data, self.shift.size)
        if w.shape[0] * w.shape[1] <= SMALL:
            return np.einsum("ij,ij->i", w.toarray(), x.toarray())
        return np.asarray(w.multiply(x).sum(axis=1)).ravel()

    def shifted(self, diagonal: np.ndarray) -> Delassus:
        """The operator with an addition to its diagonal."""
        changed = replace(self, shift=self.shift + diagonal)
        for name in SHARED if self.is_dense else SHARED[:1]:
            changed.__dict__[name] = getattr(self, name)
        return changed

    def pattern(self, width: int) -> SystemPattern:
        """Pattern of the equations of Newton's method for contacts of ``width`` rows."""
        if width not in self.patterns:
            own = self.compressed[0], self.inertia, self.joints
            self.patterns[width] = SystemPattern.of(*own, width)
        return self.patterns[width]

    @property
    def by_blocks(self) -> bool:
        """Whether bodies are free and contacts many, so that blocks of bodies are eliminated."""
        return self.orderings is not None and self.shift.size > DENSE

    def ordering(self, width: int) -> BlockOrdering | None:
        """Order of elimination for contacts of ``width`` rows; None without blocks."""
        if self.orderings is None or not self.by_blocks:
            return None
        return self.orderings(self.directions, width)

    def active_impulses(
        self, rows: np.ndarray, own: np.ndarray, coupled: np.ndarray, right: np.ndarray
    ) -> np.ndarray:
        """``(own + coupled H) P = right`` for contacts ``rows`` (n, k), with blocks (n, k, k).

        The impulses are eliminated, so that speeds ``x`` and multipliers are the unknowns:

            (A + Wᵀ B⁻¹ coupled W) x + Cᵀ λ = Wᵀ B⁻¹ right,    C x = 0,    B = own + coupled shift

        Raises
        ------
        numpy.linalg.LinAlgError
            A matrix is singular.
        """
        w = self.directions[rows.ravel()]
        inverse = np.linalg.inv(own + coupled * self.shift[rows][:, None, :])
        gains = scipy.sparse.bsr_array(
            (inverse @ coupled, np.arange(rows.shape[0]), np.arange(rows.shape[0] + 1))
        )
        free = (inverse @ right[:, :, None]).ravel()
        across = w.T.tocsr()
        system = self.inertia + across @ (gains @ w)
        m = self.joints.shape[0]
        if m:
            system = scipy.sparse.block_array([[system, self.joints.T], [self.joints, None]])
        push = np.concatenate([across @ free, np.zeros(m)])
        options = {} if m else ORDERING
        speeds = SuperLUFactors(system, **options).solve(push)[: w.shape[1]]
        return (free - gains @ (w @ speeds)).reshape(rows.shape)
