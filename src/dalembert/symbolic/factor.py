"""Symbolic factorisations, written once into the graph and shared by all who solve with them."""

from __future__ import annotations

from itertools import pairwise

import casadi as ca


class LdlFactor:
    """Sparse ``L D Lᵀ`` of a symmetric positive definite matrix, without pivoting."""

    def __init__(self, matrix: ca.SX):
        self.size = matrix.shape[0]
        if self.size:
            self.d, self.lt, self.order = ca.ldl(ca.sparsify(matrix), True)

    def solve(self, rhs: ca.SX) -> ca.SX:
        return ca.ldl_solve(ca.densify(rhs), self.d, self.lt, self.order) if self.size else rhs

    solve_transposed = solve


class QrFactor:
    """Sparse Householder ``Q R`` of a square matrix; needs no pivoting to be stable."""

    def __init__(self, matrix: ca.SX):
        self.size = matrix.shape[0]
        if self.size:
            self.parts = ca.qr_sparse(ca.sparsify(matrix), True)

    def solve(self, rhs: ca.SX) -> ca.SX:
        return ca.qr_solve(ca.densify(rhs), *self.parts) if self.size else rhs

    def solve_transposed(self, rhs: ca.SX) -> ca.SX:
        return ca.qr_solve(ca.densify(rhs), *self.parts, True) if self.size else rhs

    @property
    def pivots(self) -> ca.SX:
        return ca.diag(self.parts[1])[: self.size] if self.size else ca.SX.ones(1)


def block_inverse(matrix: ca.SX) -> ca.SX:
    """Inverse of a symmetric positive definite matrix, block by connected block."""
    n = matrix.shape[0]
    matrix = ca.sparsify(matrix)
    inverse = ca.SX(n, n)
    for block in _connected_blocks(matrix.sparsity()):
        if len(block) == 1:
            inverse[block[0], block[0]] = 1 / matrix[block[0], block[0]]
            continue
        factor = LdlFactor(matrix[block, block])
        inverse[block, block] = factor.solve(ca.SX.eye(len(block)))
    return inverse


def _connected_blocks(sparsity: ca.Sparsity) -> list[list[int]]:
    _, order, edges = (sparsity + ca.Sparsity.diag(sparsity.size1())).scc()
    return [sorted(order[a:b]) for a, b in pairwise(edges)]
