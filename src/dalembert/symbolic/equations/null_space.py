"""Null space and range of a constraint matrix, for projective elimination."""

from __future__ import annotations

import casadi as ca

from dalembert.symbolic.equations.factor import QrFactor


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
