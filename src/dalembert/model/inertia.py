"""Mass matrix as a linear operator with products and solves.

Absolute coordinates have a block diagonal matrix; a tree of joints has a full one, which is never
formed for a solve. Formulations use the same interface for both.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.symbolic.equations.factor import BlockFactor


class Inertia:
    """Mass matrix ``M`` (n, n), symmetric positive semidefinite."""

    @property
    def size(self) -> int:
        raise NotImplementedError

    @property
    def matrix(self) -> ca.SX:
        """``M`` as a matrix."""
        raise NotImplementedError

    def times(self, x: ca.SX) -> ca.SX:
        """``M x``."""
        raise NotImplementedError

    def solve(self, rhs: ca.SX) -> ca.SX:
        """``M⁻¹ rhs`` for one or several columns."""
        raise NotImplementedError

    def substitute(self, symbols: ca.SX, values: ca.SX) -> Inertia:
        """The matrix with some symbols replaced."""
        raise NotImplementedError


class BlockInertia(Inertia):
    """A matrix of connected blocks, factorised block by block.

    Parameters
    ----------
    matrix : SX (n, n)
    """

    def __init__(self, matrix: ca.SX):
        self._matrix = ca.sparsify(matrix)

    @property
    def size(self) -> int:
        return self._matrix.shape[0]

    @property
    def matrix(self) -> ca.SX:
        return self._matrix

    @cached_property
    def _factor(self) -> BlockFactor:
        return BlockFactor(self._matrix)

    def times(self, x: ca.SX) -> ca.SX:
        return ca.mtimes(self._matrix, x)

    def solve(self, rhs: ca.SX) -> ca.SX:
        return self._factor.solve(rhs)

    def substitute(self, symbols: ca.SX, values: ca.SX) -> BlockInertia:
        return BlockInertia(ca.substitute(self._matrix, symbols, values))
