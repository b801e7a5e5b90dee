"""Singular values by one-sided Jacobi rotations, written out in the graph (5.13–5.14)."""

from __future__ import annotations

import casadi as ca

from dalembert.symbolic.equations.null_space import NullSpaceBasis

SWEEPS = 7
"""Five are enough for random matrices of 12 columns; convergence is checked where it is used."""


class SingularValueBasis(NullSpaceBasis):
    """``C = U Σ Vᵀ``: the last columns of V (Hestenes 1958).

    Every rotation makes two columns of ``C V`` orthogonal, the longer one first, so that the
    columns that vanish, the null space, gather at the end.
    """

    def __init__(self, jacobian: ca.SX):
        m, n = jacobian.shape
        turned = [ca.densify(column) for column in ca.horzsplit(jacobian)]
        v = ca.horzsplit(ca.SX.eye(n))
        for _ in range(SWEEPS if m else 0):
            for i in range(min(m, n)):  # the others vanish with the first m
                for j in range(i + 1, n):
                    difference = ca.sumsqr(turned[i]) - ca.sumsqr(turned[j])
                    product = 2 * ca.dot(turned[i], turned[j])
                    nothing = ca.logic_and(product == 0, difference == 0)  # no slope at (0, 0)
                    angle = ca.atan2(product, ca.if_else(nothing, 1, difference)) / 2
                    c, s = ca.cos(angle), ca.sin(angle)
                    for columns in (turned, v):
                        columns[i], columns[j] = (
                            c * columns[i] + s * columns[j],
                            c * columns[j] - s * columns[i],
                        )
        self.size = n
        self.values = [ca.norm_2(column) for column in turned[:m]]
        left = [column / value for column, value in zip(turned, self.values, strict=False)]
        self.left = ca.horzcat(ca.SX(m, 0), *left)
        self.right = ca.horzcat(ca.SX(n, 0), *v[:m])
        self.matrix = ca.horzcat(ca.SX(n, 0), *v[m:])

    def _scaled(self, x: ca.SX) -> ca.SX:
        return x / ca.repmat(ca.vertcat(*self.values), 1, x.shape[1]) if self.values else x

    def particular(self, rhs: ca.SX) -> ca.SX:
        return ca.mtimes(self.right, self._scaled(ca.mtimes(self.left.T, rhs)))

    def multipliers(self, force: ca.SX) -> ca.SX:
        return ca.mtimes(self.left, self._scaled(ca.mtimes(self.right.T, force)))
