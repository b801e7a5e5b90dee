"""Orthonormal bases of the null space: Householder, Gram–Schmidt, Jacobi SVD (5.13–5.14)."""

from __future__ import annotations

import casadi as ca

from dalembert.symbolic.equations.factor import NullSpaceBasis, cleared


class HouseholderBasis(NullSpaceBasis):
    """``Cᵀ = Q [R; 0]``: the last columns of Q, a product of sparse reflections."""

    def __init__(self, jacobian: ca.SX):
        m, n = jacobian.shape
        self.count, self.size = m, n
        if m:
            factors = ca.qr_sparse(cleared(jacobian.T), True)
            self.vectors, r, self.beta, permutation, self.order = factors
            self.r = r[:m, :]
            self.permutation = permutation
            self.rows = [permutation.index(k) for k in range(n)]  # row of Cᵀ at each row of Q
        self.matrix = ca.sparsify(self._times_q(ca.SX.eye(n)[:, m:]))

    def _times_q(self, x: ca.SX) -> ca.SX:
        """``Q x`` in the order of the speeds."""
        for k in reversed(range(self.count)):
            x = self._reflected(x, k)
        return x[self.permutation, :] if self.count else x

    def _times_q_transposed(self, x: ca.SX) -> ca.SX:
        """``Qᵀ x``."""
        x = x[self.rows, :]
        for k in range(self.count):
            x = self._reflected(x, k)
        return x

    def _reflected(self, x: ca.SX, k: int) -> ca.SX:
        vector = self.vectors[:, k]
        return x - ca.mtimes(self.beta[k] * vector, ca.mtimes(vector.T, x))

    def particular(self, rhs: ca.SX) -> ca.SX:
        if not self.count:
            return ca.SX.zeros(self.size, rhs.shape[1])
        first = ca.solve(self.r.T, rhs[self.order, :])
        return self._times_q(ca.vertcat(first, ca.SX(self.size - self.count, rhs.shape[1])))

    def multipliers(self, force: ca.SX) -> ca.SX:
        if not self.count:
            return force[:0, :]
        solution = ca.SX.zeros(self.count, force.shape[1])
        solution[self.order, :] = ca.solve(self.r, self._times_q_transposed(force)[: self.count, :])
        return solution


class GramSchmidtBasis(NullSpaceBasis):
    """Rows of C orthonormalised in sequence, then completed by unit vectors.

    Every vector is orthogonalised twice, which keeps the basis orthogonal to round-off
    (Giraud, Langou and Rozložník 2005).

    Parameters
    ----------
    jacobian : SX ``C`` (m, n)
    independent : indices of the unit vectors
    """

    def __init__(self, jacobian: ca.SX, independent: tuple[int, ...]):
        m, n = jacobian.shape
        self.r = ca.SX(m, m)
        columns: list[ca.SX] = []
        for j in range(m):
            remainder, components = _orthogonalized(ca.sparsify(jacobian[j, :]).T, columns)
            for i, component in enumerate(components):
                self.r[i, j] = component
            self.r[j, j] = ca.norm_2(remainder)
            columns.append(remainder / self.r[j, j])
        self.range = ca.horzcat(ca.SX(n, 0), *columns)
        self.r = ca.sparsify(self.r)
        for k in independent:
            remainder, _ = _orthogonalized(ca.SX.eye(n)[:, k], columns)
            columns.append(remainder / ca.norm_2(remainder))
        self.matrix = ca.horzcat(ca.SX(n, 0), *columns[m:])

    def particular(self, rhs: ca.SX) -> ca.SX:
        if not rhs.shape[0]:
            return ca.SX.zeros(self.range.shape[0], rhs.shape[1])
        return ca.mtimes(self.range, ca.solve(self.r.T, rhs))

    def multipliers(self, force: ca.SX) -> ca.SX:
        components = ca.mtimes(self.range.T, force)
        return ca.solve(self.r, components) if components.shape[0] else components


def _orthogonalized(vector: ca.SX, earlier: list[ca.SX]) -> tuple[ca.SX, list[ca.SX]]:
    """Remainder of a vector orthogonal to earlier unit vectors, and its components along them."""
    components = [ca.SX(0)] * len(earlier)
    for _ in range(2):
        for i, unit in enumerate(earlier):
            component = ca.dot(unit, vector)
            if component.is_zero():
                continue
            components[i] += component
            vector = ca.sparsify(vector - component * unit)
    return vector, components


SWEEPS = 7
"""Number of Jacobi sweeps; five suffice for random matrices of 12 columns, users check it."""


class SingularValueBasis(NullSpaceBasis):
    """``C = U Σ Vᵀ``: the last columns of V (Hestenes 1958).

    Every rotation makes two columns of ``C V`` orthogonal and puts the longer one first, so that
    the vanishing columns, which span the null space, are the last.
    """

    def __init__(self, jacobian: ca.SX):
        m, n = jacobian.shape
        rotated = [ca.densify(column) for column in ca.horzsplit(jacobian)]
        v = ca.horzsplit(ca.SX.eye(n))
        for _ in range(SWEEPS if m else 0):
            for i in range(min(m, n)):  # the remaining columns vanish with the first m
                for j in range(i + 1, n):
                    difference = ca.sumsqr(rotated[i]) - ca.sumsqr(rotated[j])
                    product = 2 * ca.dot(rotated[i], rotated[j])
                    both_zero = ca.logic_and(product == 0, difference == 0)  # no slope at (0, 0)
                    angle = ca.atan2(product, ca.if_else(both_zero, 1, difference)) / 2
                    c, s = ca.cos(angle), ca.sin(angle)
                    for columns in (rotated, v):
                        columns[i], columns[j] = (
                            c * columns[i] + s * columns[j],
                            c * columns[j] - s * columns[i],
                        )
        self.size = n
        self.values = [ca.norm_2(column) for column in rotated[:m]]
        left_columns = [column / value for column, value in zip(rotated, self.values, strict=False)]
        self.left = ca.horzcat(ca.SX(m, 0), *left_columns)
        self.right = ca.horzcat(ca.SX(n, 0), *v[:m])
        self.matrix = ca.horzcat(ca.SX(n, 0), *v[m:])

    def _scaled(self, x: ca.SX) -> ca.SX:
        return x / ca.repmat(ca.vertcat(*self.values), 1, x.shape[1]) if self.values else x

    def particular(self, rhs: ca.SX) -> ca.SX:
        return ca.mtimes(self.right, self._scaled(ca.mtimes(self.left.T, rhs)))

    def multipliers(self, force: ca.SX) -> ca.SX:
        return ca.mtimes(self.left, self._scaled(ca.mtimes(self.right.T, force)))
