"""What projective elimination needs of a constraint matrix: its null space and its range."""

from __future__ import annotations

import casadi as ca


class NullSpaceBasis:
    """Basis ``D`` (n, n − m) of the motions that a matrix ``C`` (m, n) of full row rank permits.

    Attributes
    ----------
    matrix : SX ``D``, ``C D = 0``
    """

    matrix: ca.SX

    def particular(self, rhs: ca.SX) -> ca.SX:
        """Some ``x`` with ``C x = rhs``."""
        raise NotImplementedError

    def multipliers(self, force: ca.SX) -> ca.SX:
        """``z`` with ``Cᵀ z = force``, for a force with ``Dᵀ force = 0``."""
        raise NotImplementedError
