"""Orthonormal bases of the null space: Householder reflections, Gram–Schmidt (5.13–5.14)."""

from __future__ import annotations

import casadi as ca

from dalembert.symbolic.equations.factor import cleared
from dalembert.symbolic.equations.null_space import NullSpaceBasis


class HouseholderBasis(NullSpaceBasis):
    """``Cᵀ = Q [R; 0]``: the last columns of Q, a product of sparse reflections."""

    def __init__(self, jacobian: ca.SX):
        m, n = jacobian.shape
        self.count, self.size = m, n
        if m:
            found = ca.qr_sparse(cleared(jacobian.T), True)
            self.vectors, r, self.beta, place, self.order = found
            self.r = r[:m, :]
            self.rows = [place.index(k) for k in range(n)]  # row of Cᵀ at each place in Q
            self.place = place
        self.matrix = ca.sparsify(self._turned(ca.SX.eye(n)[:, m:]))

    def _turned(self, x: ca.SX) -> ca.SX:
        """``Q x`` in the order of the speeds."""
        for k in reversed(range(self.count)):
            x = self._reflected(x, k)
        return x[self.place, :] if self.count else x

    def _turned_back(self, x: ca.SX) -> ca.SX:
        """``Qᵀ x``."""
        x = x[self.rows, :]
        for k in range(self.count):
            x = self._reflected(x, k)
        return x

    def _reflected(self, x: ca.SX, k: int) -> ca.SX:
        along = self.vectors[:, k]
        return x - ca.mtimes(self.beta[k] * along, ca.mtimes(along.T, x))

    def particular(self, rhs: ca.SX) -> ca.SX:
        if not self.count:
            return ca.SX.zeros(self.size, rhs.shape[1])
        first = ca.solve(self.r.T, rhs[self.order, :])
        return self._turned(ca.vertcat(first, ca.SX(self.size - self.count, rhs.shape[1])))

    def multipliers(self, force: ca.SX) -> ca.SX:
        if not self.count:
            return force[:0, :]
        solution = ca.SX.zeros(self.count, force.shape[1])
        solution[self.order, :] = ca.solve(self.r, self._turned_back(force)[: self.count, :])
        return solution


class GramSchmidtBasis(NullSpaceBasis):
    """Rows of C made orthonormal one after the other, then completed by unit vectors.

    Every vector is freed of the earlier ones twice, which keeps them orthogonal to round-off
    (Giraud, Langou and Rozložník 2005).

    Parameters
    ----------
    jacobian : SX ``C`` (m, n)
    independent : indices of the unit vectors
    """

    def __init__(self, jacobian: ca.SX, independent: tuple[int, ...]):
        m, n = jacobian.shape
        self.r = ca.SX(m, m)
        found: list[ca.SX] = []
        for j in range(m):
            rest, shares = _freed(ca.sparsify(jacobian[j, :]).T, found)
            for i, share in enumerate(shares):
                self.r[i, j] = share
            self.r[j, j] = ca.norm_2(rest)
            found.append(rest / self.r[j, j])
        self.range = ca.horzcat(ca.SX(n, 0), *found)
        self.r = ca.sparsify(self.r)
        for k in independent:
            rest, _ = _freed(ca.SX.eye(n)[:, k], found)
            found.append(rest / ca.norm_2(rest))
        self.matrix = ca.horzcat(ca.SX(n, 0), *found[m:])

    def particular(self, rhs: ca.SX) -> ca.SX:
        if not rhs.shape[0]:
            return ca.SX.zeros(self.range.shape[0], rhs.shape[1])
        return ca.mtimes(self.range, ca.solve(self.r.T, rhs))

    def multipliers(self, force: ca.SX) -> ca.SX:
        along = ca.mtimes(self.range.T, force)
        return ca.solve(self.r, along) if along.shape[0] else along


def _freed(vector: ca.SX, earlier: list[ca.SX]) -> tuple[ca.SX, list[ca.SX]]:
    """What is left of a vector, and its shares along earlier unit vectors."""
    shares = [ca.SX(0)] * len(earlier)
    for _ in range(2):
        for i, unit in enumerate(earlier):
            share = ca.dot(unit, vector)
            if share.is_zero():
                continue
            shares[i] += share
            vector = ca.sparsify(vector - share * unit)
    return vector, shares
