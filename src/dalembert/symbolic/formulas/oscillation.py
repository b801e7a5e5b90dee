"""Formulas along a small oscillation, to second order in its amplitude.

``y = y₀ + s r + c i + s² R + 2 s c M + c² I``, in which ``s`` and ``c`` are an amplitude times the
sine and the cosine of a phase.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

PARTS = 5
"""Number of the vectors ``r, i, R, M, I``."""


def parts(size: int) -> list[ca.SX]:
    """Symbols of the vectors of an oscillation."""
    return [ca.SX.sym(f"oscillation_{k}", size) for k in range(PARTS)]


def oscillation(column: ca.SX, y: ca.SX, vectors: Sequence[ca.SX]) -> list[ca.SX]:
    """A column at rest, and its own five vectors.

    Parameters
    ----------
    column : (m,) formulas of ``y``
    y : (n,) symbols
    vectors : ``r, i, R, M, I``, each (n,)
    """
    first, second, *squares = vectors
    changes = [ca.jtimes(column, y, vector) for vector in (first, second)]
    pairs = ((changes[0], first), (changes[0], second), (changes[1], second))
    squares = [
        ca.jtimes(column, y, square) + ca.jtimes(change, y, vector) / 2
        for square, (change, vector) in zip(squares, pairs, strict=True)
    ]
    return [ca.densify(entry) for entry in (column, *changes, *squares)]
