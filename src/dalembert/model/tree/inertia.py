"""Mass matrix of a tree of bodies in joint coordinates, ``M̄ = Dᵀ M D`` (6.2).

It is full, but a product and a solve pass only once up and down the tree: ``M̄ = L D̄ Lᵀ`` is
eliminated from the leaves to the root without being formed, each body seeing what hangs on it as
its articulated inertia (Featherstone, *Rigid Body Dynamics Algorithms*, 2008).
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.model.inertia import Inertia
from dalembert.model.tree.basis import TreeBasis
from dalembert.symbolic.equations.factor import block_inverse


class TreeInertia(Inertia):
    """``Dᵀ M D`` of a tree.

    Parameters
    ----------
    basis : TreeBasis, ``D``
    masses : SX ``M_i`` of each branch's body
    """

    def __init__(self, basis: TreeBasis, masses: list[ca.SX]):
        self.basis, self.masses = basis, masses

    @cached_property
    def _bodies(self) -> list[ca.SX]:
        """``M_i`` for the twists of the recursion."""
        pairs = zip(self.basis.branches, self.masses, strict=True)
        return [_congruent(mass, b.seen) for b, mass in pairs]

    @property
    def size(self) -> int:
        branches = self.basis.branches
        return branches[-1].columns.stop if branches else 0

    @cached_property
    def matrix(self) -> ca.SX:
        """Composite bodies: what hangs on a joint moves as one, ``M̄_ji = S_jᵀ X…ᵀ I_i S_i``."""
        branches, n = self.basis.branches, self.size
        composite = list(self._bodies)
        result = ca.SX(n, n)
        for k, b in reversed(list(enumerate(branches))):
            if b.parent is not None:
                composite[b.parent] += _congruent(composite[k], b.across)
            momentum, at = ca.mtimes(composite[k], b.moved), k
            result[b.columns, b.columns] = ca.mtimes(b.moved.T, momentum)
            parent = b.parent
            while parent is not None:
                momentum = ca.mtimes(branches[at].across.T, momentum)
                block = ca.mtimes(branches[parent].moved.T, momentum)
                result[branches[parent].columns, b.columns] = block
                result[b.columns, branches[parent].columns] = block.T
                at, parent = parent, branches[parent].parent
        return ca.sparsify(result)

    def times(self, x: ca.SX) -> ca.SX:
        moved = self.basis.times(x)
        product = ca.SX(*moved.shape)
        for b, mass in zip(self.basis.branches, self.masses, strict=True):
            product[b.rows, :] = ca.mtimes(mass, moved[b.rows, :])
        return ca.densify(self.basis.transposed(product))

    @cached_property
    def _elimination(self) -> tuple[list[ca.SX], list[ca.SX]]:
        """``(Sᵀ I S)⁻¹`` and ``I S (Sᵀ I S)⁻¹`` of every joint, I the articulated inertia."""
        articulated = list(self._bodies)
        inverses: list[ca.SX] = []
        gains: list[ca.SX] = []
        for k, b in reversed(list(enumerate(self.basis.branches))):
            momentum = ca.mtimes(articulated[k], b.moved)
            inverse = block_inverse(ca.mtimes(b.moved.T, momentum))
            gain = ca.mtimes(momentum, inverse)
            inverses.insert(0, inverse)
            gains.insert(0, gain)
            if b.parent is not None:  # what the joint lets go does not see S N
                left = articulated[k] - ca.mtimes(gain, momentum.T)
                articulated[b.parent] += _congruent(left, b.carried)
        return inverses, gains

    def solve(self, rhs: ca.SX) -> ca.SX:
        inverses, gains = self._elimination
        branches, columns = self.basis.branches, rhs.shape[1]
        passed = [ca.SX(b.moved.shape[0], columns) for b in branches]
        left: list[ca.SX] = [ca.SX()] * len(branches)
        for k, b in reversed(list(enumerate(branches))):
            left[k] = rhs[b.columns, :] - ca.mtimes(b.moved.T, passed[k])
            if b.parent is not None:
                through = passed[k] + ca.mtimes(gains[k], left[k])
                passed[b.parent] += ca.mtimes(b.carried.T, through)
                passed[b.parent] += ca.mtimes(b.turned.T, rhs[b.columns, :])
        found: list[ca.SX] = []
        result = ca.SX(self.size, columns)
        for k, b in enumerate(branches):
            own = ca.mtimes(inverses[k], left[k])
            twist, turned = ca.SX(b.moved.shape[0], columns), ca.SX(own.shape[0], columns)
            if b.parent is not None:
                twist = ca.mtimes(b.carried, found[b.parent])
                turned = ca.mtimes(b.turned, found[b.parent])
                own = own - ca.mtimes(gains[k].T, twist)
            found.append(twist + ca.mtimes(b.moved, own))
            result[b.columns, :] = own - turned
        return result if columns > 1 else ca.densify(result)  # zero columns stay cheap

    def substitute(self, symbols: ca.SX, values: ca.SX) -> TreeInertia:
        masses = [ca.substitute(mass, symbols, values) for mass in self.masses]
        return TreeInertia(self.basis.substitute(symbols, values), masses)


def _congruent(matrix: ca.SX, x: ca.SX) -> ca.SX:
    """``Xᵀ A X`` of a symmetric A; one triangle is computed and mirrored."""
    return ca.triu2symm(ca.triu(ca.mtimes(x.T, ca.mtimes(ca.triu2symm(ca.triu(matrix)), x))))
