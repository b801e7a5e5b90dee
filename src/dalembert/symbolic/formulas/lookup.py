"""Piecewise polynomials with constant coefficients, evaluated by table lookup.

A graph of scalars has no arrays: written out, the choice of a piece costs operations for each row.
A lookup is one call, which finds the piece by bisection.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

SCALE = 2.0**600
"""Scale that makes all coefficients integers, which ``floor`` does not change. Coefficients have no
derivative, yet CasADi 3.8 returns NaN for that of a call; the derivative of ``floor`` is zero."""


class Lookup:
    """``x → (left end of its piece, coefficients there)``.

    Parameters
    ----------
    knots : n increasing numbers
    rows : (n − 1, order) coefficients of the polynomials in ``x − left``, lowest order first
    """

    def __init__(self, knots: Sequence[float], rows: np.ndarray):
        x = ca.MX.sym("x")
        table = np.column_stack([knots[:-1], rows])
        count = table.shape[1]
        piece = ca.low(ca.DM(list(knots)), x, {"lookup_mode": "binary"})
        row = ca.MX(ca.DM((table * SCALE).ravel()))[count * piece + ca.DM(range(count))]
        self.function = ca.Function("lookup", [x], [row], {"never_inline": True})

    @staticmethod
    def holds(knots: Sequence[float], rows: np.ndarray) -> bool:
        """Whether a ``Lookup`` reproduces the numbers exactly: all but extreme ones."""
        with np.errstate(over="ignore"):
            scaled = np.column_stack([knots[:-1], rows]) * SCALE
        return bool(np.all(np.isfinite(scaled)) and np.all(np.floor(scaled) == scaled))

    def __call__(self, x: ca.SX) -> ca.SX:
        """The value of the polynomial at x between the first and the last knot."""
        if x.is_constant():
            return self.value(x, ca.SX(self.function(float(x)) / SCALE))
        return self.value(x, ca.floor(self.function(x)) * (1 / SCALE))

    @staticmethod
    def value(x: ca.SX, row: ca.SX) -> ca.SX:
        """The polynomial by Horner's rule."""
        left, *coefficients = ca.vertsplit(row)
        value = ca.SX(0)
        for coefficient in reversed(coefficients):
            value = coefficient + (x - left) * value
        return value
