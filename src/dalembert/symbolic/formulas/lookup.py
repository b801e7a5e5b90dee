"""Coefficients of the piece in which a number lies, looked up in a table of constants.

A graph of scalars has no arrays: written out, the choice of a piece costs operations for each row.
Here it is one call, whose numbers are found by bisection.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

SCALE = 2.0**600
"""Coefficients have no derivative, yet CasADi 3.8 makes NaN of that of a call; of ``floor`` it
knows that there is none. Numbers times this are whole, and ``floor`` leaves them as they are."""


class Lookup:
    """``x → (left end of its piece, coefficients there)``.

    Parameters
    ----------
    knots : n increasing numbers
    rows : of each of n − 1 pieces the coefficients of its polynomial in ``x − left``, lowest first
    """

    def __init__(self, knots: Sequence[float], rows: np.ndarray):
        x = ca.MX.sym("x")
        table = np.column_stack([knots[:-1], rows])
        count = table.shape[1]
        piece = ca.low(ca.DM(list(knots)), x, {"lookup_mode": "binary"})
        found = ca.MX(ca.DM((table * SCALE).ravel()))[count * piece + ca.DM(range(count))]
        self.function = ca.Function("lookup", [x], [found], {"never_inline": True})

    @staticmethod
    def holds(knots: Sequence[float], rows: np.ndarray) -> bool:
        """Whether the numbers pass through a ``Lookup`` unchanged: all but absurd ones do."""
        with np.errstate(over="ignore"):
            scaled = np.column_stack([knots[:-1], rows]) * SCALE
        return bool(np.all(np.isfinite(scaled)) and np.all(np.floor(scaled) == scaled))

    def __call__(self, x: ca.SX) -> ca.SX:
        """The value of the polynomial at x between the first and the last knot."""
        if x.is_constant():
            return self.value(x, ca.SX(self.function(float(x)) / SCALE))
        return self.value(x, ca.floor(self.function(x)) * (1 / SCALE))

    @staticmethod
    def value(x: ca.SX, found: ca.SX) -> ca.SX:
        """By Horner's rule."""
        left, *coefficients = ca.vertsplit(found)
        value = ca.SX(0)
        for coefficient in reversed(coefficients):
            value = coefficient + (x - left) * value
        return value
