"""Symbolic factorisations and null spaces, written into the graph once and shared by all solves."""

from __future__ import annotations

from itertools import pairwise
from typing import TypeAlias

import casadi as ca
import numpy as np

Sizes: TypeAlias = np.ndarray | None
LARGE = 12
"""Rows of a block above which its factors are stored instead of its inverse."""


class LdlFactor:
    """Sparse ``L D Lᵀ`` of a symmetric positive definite matrix, without pivoting."""

    def __init__(self, matrix: ca.SX):
        self.size = matrix.shape[0]
        if self.size:
            self.d, self.lt, self.order = ca.ldl(symmetric(ca.sparsify(matrix)), True)

    def solve(self, rhs: ca.SX) -> ca.SX:
        return ca.ldl_solve(ca.densify(rhs), self.d, self.lt, self.order) if self.size else rhs

    solve_transposed = solve


def symmetric(matrix: ca.SX) -> ca.SX:
    """The matrix with a symmetric sparsity pattern.

    An entry of a product such as ``Dᵀ M D`` may cancel in its expression while its transpose, equal
    in value, does not. Then the lower triangle stands for both.
    """
    return matrix if matrix.sparsity().is_symmetric() else ca.tril2symm(ca.tril(matrix))


class QrFactor:
    """Sparse Householder ``Q R`` of a square matrix; needs no pivoting to be stable.

    Entries of different dimension, such as metres and radians or masses and lengths, are scaled by
    ``rows`` and ``columns``: natural sizes of the equations and of the unknowns.
    """

    def __init__(self, matrix: ca.SX, rows: Sizes = None, columns: Sizes = None):
        self.size = matrix.shape[0]
        self.rows, self.columns = _column(rows), _column(columns)
        if self.size:
            scaled = ca.sparsify(matrix)
            if self.rows is not None:
                scaled = ca.mtimes(ca.diag(1 / self.rows), scaled)
            if self.columns is not None:
                scaled = ca.mtimes(scaled, ca.diag(self.columns))
            self.parts = ca.qr_sparse(cleared(scaled), True)

    def solve(self, rhs: ca.SX) -> ca.SX:
        return self._solve(rhs, self.rows, self.columns, False)

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        return self._solve(rhs, _inverse(self.columns), _inverse(self.rows), True)

    def _solve(self, rhs: ca.SX, equations, unknowns, transposed: bool) -> ca.SX:
        if not self.size:
            return rhs
        if equations is not None:
            rhs = rhs / ca.repmat(equations, 1, rhs.shape[1])
        solution = ca.qr_solve(ca.densify(rhs), *self.parts, transposed)
        return solution if unknowns is None else solution * ca.repmat(unknowns, 1, rhs.shape[1])

    @property
    def pivots(self) -> ca.SX:
        return ca.diag(self.parts[1])[: self.size] if self.size else ca.SX.ones(1)


def cleared(matrix: ca.SX) -> ca.SX:
    """The matrix without entries below the round-off of their column, safe for reflections.

    The remainder of an angle that Newton's method drives to zero, 1e-21, is 1e-160 after a few
    products, and its square underflows: a reflection by it is not orthogonal, or NaN.
    """
    matrix = ca.sparsify(matrix)
    unit = ca.densify(ca.sum1(ca.fabs(matrix)))[matrix.sparsity().get_col()].T / 8
    entries = matrix.nz[:]
    doubled = 2 * (entries + unit) - 2 * unit  # CasADi would simplify (x + u) − u
    return ca.SX(matrix.sparsity(), doubled / 2)


def _column(sizes: Sizes) -> ca.DM | None:
    """Sizes as a column; None if all are one."""
    return None if sizes is None or np.all(np.asarray(sizes) == 1) else ca.DM(sizes)


def _inverse(sizes: ca.DM | None) -> ca.DM | None:
    return None if sizes is None else 1 / sizes


class BlockFactor:
    """Solves with a symmetric positive definite matrix, block by connected block.

    Small blocks are inverted, which is faster for many right-hand sides. Larger blocks, such as
    the mass of a beam, have sparse factors and a full inverse, and are factorised.
    """

    def __init__(self, matrix: ca.SX):
        n = matrix.shape[0]
        matrix = ca.sparsify(matrix)
        self.inverse = ca.SX(n, n)
        self.large: list[tuple[list[int], LdlFactor]] = []
        for block in _connected_blocks(matrix.sparsity()):
            if len(block) == 1:
                self.inverse[block[0], block[0]] = 1 / matrix[block[0], block[0]]
                continue
            factor = LdlFactor(matrix[block, block])
            if len(block) > LARGE:
                self.large.append((block, factor))
            else:
                self.inverse[block, block] = factor.solve(ca.SX.eye(len(block)))

    def solve(self, rhs: ca.SX) -> ca.SX:
        """``M⁻¹ rhs`` for one or several columns."""
        solution = ca.mtimes(self.inverse, rhs)
        for block, factor in self.large:
            for k in range(rhs.shape[1]):
                if rhs[block, k].nnz():
                    solution[block, k] = factor.solve(rhs[block, k])
        return solution


def block_inverse(matrix: ca.SX) -> ca.SX:
    """Inverse of a symmetric positive definite matrix, block by connected block."""
    return ca.sparsify(BlockFactor(matrix).solve(ca.SX.eye(matrix.shape[0])))


def _connected_blocks(sparsity: ca.Sparsity) -> list[list[int]]:
    _, order, edges = (sparsity + ca.Sparsity.diag(sparsity.size1())).scc()
    return [sorted(order[a:b]) for a, b in pairwise(edges)]


class NullSpaceBasis:
    """Basis ``D`` (n, n − m) of the null space of a matrix ``C`` (m, n) of full row rank.

    Attributes
    ----------
    matrix : SX ``D``, ``C D = 0``
    """

    matrix: ca.SX

    def particular(self, rhs: ca.SX) -> ca.SX:
        """A particular solution ``x`` of ``C x = rhs``."""
        raise NotImplementedError

    def multipliers(self, force: ca.SX) -> ca.SX:
        """``z`` with ``Cᵀ z = force``, for a force with ``Dᵀ force = 0``."""
        raise NotImplementedError


class PartitionBasis(NullSpaceBasis):
    """``C = [U W]``, ``D = [I; −W⁻¹U]`` (6.4) by sparse QR of W.

    Parameters
    ----------
    jacobian : SX ``C`` (m, n)
    independent : indices of the columns U
    """

    def __init__(self, jacobian: ca.SX, independent: tuple[int, ...]):
        n = jacobian.shape[1]
        self.independent = list(independent)
        self.dependent = [k for k in range(n) if k not in independent]
        self.u = jacobian[:, self.independent]
        self.w = QrFactor(jacobian[:, self.dependent])
        self.matrix = ca.SX(n, len(independent))
        self.matrix[self.independent, :] = ca.SX.eye(len(independent))
        self.matrix[self.dependent, :] = -self.ratio
        self.matrix = ca.sparsify(self.matrix)

    @property
    def ratio(self) -> ca.SX:
        """``W⁻¹ U``."""
        return self.w.solve(self.u)

    def particular(self, rhs: ca.SX) -> ca.SX:
        return self.completed(ca.SX.zeros(len(self.independent), rhs.shape[1]), rhs)

    def completed(self, u: ca.SX, rhs: ca.SX) -> ca.SX:
        """``v`` with ``C v = rhs`` and the independent entries ``u``."""
        v = ca.SX.zeros(len(self.independent) + len(self.dependent), rhs.shape[1])
        v[self.independent, :] = u
        v[self.dependent, :] = self.w.solve(rhs - ca.mtimes(self.u, u))
        return v

    def multipliers(self, force: ca.SX) -> ca.SX:
        return self.w.solve_transposed(force[self.dependent, :])
