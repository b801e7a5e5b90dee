"""The mass matrix as what it does: multiply, and be inverted.

Absolute coordinates have a block diagonal matrix; a tree of joints has a full one that is never
formed to be inverted. Formulations ask for the matrix, a product or a solve, and need not know.
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
        """``M`` itself."""
        raise NotImplementedError

    def times(self, x: ca.SX) -> ca.SX:
        """``M x``."""
        raise NotImplementedError

    def solve(self, rhs: ca.SX) -> ca.SX:
        """``M⁻¹ rhs`` for one or several columns."""
        raise NotImplementedError

    def substitute(self, symbols: ca.SX, values: ca.SX) -> Inertia:
        """The same at other values of some symbols."""
        raise NotImplementedError


class BlockInertia(Inertia):
    """A matrix of connected blocks, solved with block by block.

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
