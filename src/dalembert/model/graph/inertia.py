"""Mass matrix as a linear operator with products and solves.

Absolute coordinates have a block diagonal matrix; a tree of joints has a full one, which is never
formed for a solve. Formulations use the same interface for both.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.model.graph.tree.motion import TreeBasis
from dalembert.symbolic.equations.factor import BlockFactor, block_inverse


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


class TreeInertia(Inertia):
    """Mass matrix of a tree of bodies and rotors in joint coordinates, ``M̄ = Dᵀ M D + J`` (6.2).

    A product and a solve pass only once up and down the tree: ``M̄ = L D̄ Lᵀ`` is eliminated from
    the leaves to the root without being formed, with the articulated inertia of each body
    (Featherstone, *Rigid Body Dynamics Algorithms*, 2008).

    Parameters
    ----------
    basis : TreeBasis, ``D``
    masses : SX ``M_i`` of each branch's body
    rotors : SX ``J_i``, a diagonal matrix for the speeds of each branch
    """

    def __init__(self, basis: TreeBasis, masses: list[ca.SX], rotors: list[ca.SX]):
        self.basis = basis.relative([not rotor.is_zero() for rotor in rotors])
        self.masses, self.rotors = masses, rotors

    @cached_property
    def _bodies(self) -> list[ca.SX]:
        """``M_i`` for the twists of the recursion."""
        pairs = zip(self.basis.branches, self.masses, strict=True)
        return [_congruent(mass, b.projection) for b, mass in pairs]

    @property
    def size(self) -> int:
        branches = self.basis.branches
        return branches[-1].columns.stop if branches else 0

    @cached_property
    def matrix(self) -> ca.SX:
        """``M̄_ji = S_jᵀ X…ᵀ I_i S_i`` with the inertia ``I_i`` of composite bodies."""
        branches, n = self.basis.branches, self.size
        composite = list(self._bodies)
        result = ca.SX(n, n)
        for k, b in reversed(list(enumerate(branches))):
            if b.parent is not None:
                composite[b.parent] += _congruent(composite[k], b.propagation)
            momentum, at = ca.mtimes(composite[k], b.subspace), k
            result[b.columns, b.columns] = ca.mtimes(b.subspace.T, momentum) + self.rotors[k]
            parent = b.parent
            while parent is not None:
                momentum = ca.mtimes(branches[at].propagation.T, momentum)
                block = ca.mtimes(branches[parent].subspace.T, momentum)
                result[branches[parent].columns, b.columns] = block
                result[b.columns, branches[parent].columns] = block.T
                at, parent = parent, branches[parent].parent
        return ca.sparsify(result)

    def times(self, x: ca.SX) -> ca.SX:
        speeds = self.basis.times(x)
        product = ca.SX(*speeds.shape)
        for b, mass in zip(self.basis.branches, self.masses, strict=True):
            product[b.rows, :] = ca.mtimes(mass, speeds[b.rows, :])
        rotors = ca.diagcat(*self.rotors)
        return ca.densify(self.basis.transposed(product) + ca.mtimes(rotors, x))

    @cached_property
    def _elimination(self) -> tuple[list[ca.SX], list[ca.SX]]:
        """``N = (Sᵀ I S + J)⁻¹`` and ``I S N`` of every joint, I the articulated inertia."""
        articulated = list(self._bodies)
        inverses: list[ca.SX] = []
        gains: list[ca.SX] = []
        for k, b in reversed(list(enumerate(self.basis.branches))):
            momentum = ca.mtimes(articulated[k], b.subspace)
            inverse = block_inverse(ca.mtimes(b.subspace.T, momentum) + self.rotors[k])
            gain = ca.mtimes(momentum, inverse)
            inverses.insert(0, inverse)
            gains.insert(0, gain)
            if b.parent is not None:  # S N drops out of the projected inertia
                projected = articulated[k] - ca.mtimes(gain, momentum.T)
                articulated[b.parent] += _congruent(projected, b.transport)
        return inverses, gains

    def solve(self, rhs: ca.SX) -> ca.SX:
        inverses, gains = self._elimination
        branches, columns = self.basis.branches, rhs.shape[1]
        wrenches = [ca.SX(b.subspace.shape[0], columns) for b in branches]
        residuals: list[ca.SX] = [ca.SX()] * len(branches)
        for k, b in reversed(list(enumerate(branches))):
            residuals[k] = rhs[b.columns, :] - ca.mtimes(b.subspace.T, wrenches[k])
            if b.parent is not None:
                through = wrenches[k] + ca.mtimes(gains[k], residuals[k])
                wrenches[b.parent] += ca.mtimes(b.transport.T, through)
                wrenches[b.parent] += ca.mtimes(b.coupling.T, rhs[b.columns, :])
        twists: list[ca.SX] = []
        result = ca.SX(self.size, columns)
        for k, b in enumerate(branches):
            joint_rates = ca.mtimes(inverses[k], residuals[k])
            twist, coupled = (
                ca.SX(b.subspace.shape[0], columns),
                ca.SX(joint_rates.shape[0], columns),
            )
            if b.parent is not None:
                twist = ca.mtimes(b.transport, twists[b.parent])
                coupled = ca.mtimes(b.coupling, twists[b.parent])
                joint_rates = joint_rates - ca.mtimes(gains[k].T, twist)
            twists.append(twist + ca.mtimes(b.subspace, joint_rates))
            result[b.columns, :] = joint_rates - coupled
        return result if columns > 1 else ca.densify(result)  # zero columns stay cheap

    def substitute(self, symbols: ca.SX, values: ca.SX) -> TreeInertia:
        masses, rotors = (
            [ca.substitute(matrix, symbols, values) for matrix in matrices]
            for matrices in (self.masses, self.rotors)
        )
        return TreeInertia(self.basis.substitute(symbols, values), masses, rotors)


def _congruent(matrix: ca.SX, x: ca.SX) -> ca.SX:
    """``Xᵀ A X`` of a symmetric A; one triangle is computed and mirrored."""
    return ca.triu2symm(ca.triu(ca.mtimes(x.T, ca.mtimes(ca.triu2symm(ca.triu(matrix)), x))))
