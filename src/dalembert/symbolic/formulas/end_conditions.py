"""Second derivatives of cubic splines at their knots, for several end conditions.

Continuity of the slope at the inner knots is a tridiagonal system (de Boor, *A practical guide to
splines*, 1978, chapter IV). Numbers and formulas alike.
"""

from __future__ import annotations

from typing import Any

Scalar = Any  # float, or casadi.SX for a formula
ENDS = ("not-a-knot", "clamped", "natural")
"""End conditions: one cubic across the first two pieces, zero slope, or zero second derivative."""


def second_derivatives(h: list[Scalar], v: list[Scalar], ends: str) -> list[Scalar]:
    """Second derivatives at the knots: continuity of the slope, and the end conditions."""
    rise = [(b - a) / step for a, b, step in zip(v, v[1:], h, strict=False)]
    n = len(h)
    if ends == "periodic":
        lower = [h[k - 1] / 6 for k in range(n)]  # of row 0: its last column
        diagonal = [(h[k - 1] + h[k]) / 3 for k in range(n)]
        upper = [h[k] / 6 for k in range(n)]  # of the last row: its first column
        change = [rise[k] - rise[k - 1] for k in range(n)]
        m = _cyclic(lower, diagonal, upper, change)
        return [*m, m[0]]
    rows = range(1, n)
    a = [h[k - 1] / 6 for k in rows]
    b = [(h[k - 1] + h[k]) / 3 for k in rows]
    c = [h[k] / 6 for k in rows]
    d = [rise[k] - rise[k - 1] for k in rows]
    if ends == "natural":
        return [0.0, *_tridiagonal(a, b, c, d), 0.0]
    if ends == "clamped":
        return _tridiagonal(
            [0.0, *a, h[-1] / 6],
            [h[0] / 3, *b, h[-1] / 3],
            [h[0] / 6, *c, 0.0],
            [rise[0], *d, -rise[-1]],
        )
    return _not_a_knot(h, a, b, c, d)


def _not_a_knot(h: list, a: list, b: list, c: list, d: list) -> list[Scalar]:
    """The first two pieces are one cubic, and the last two: ``(m₁ − m₀)/h₀ = (m₂ − m₁)/h₁``.

    Three knots define one parabola.
    """
    if len(h) == 2:
        return [2 * d[0] / (h[0] + h[1])] * 3
    first, last = h[0] / h[1], h[-1] / h[-2]
    b[0], c[0] = b[0] + a[0] * (1 + first), c[0] - a[0] * first
    b[-1], a[-1] = b[-1] + h[-1] / 6 * (1 + last), a[-1] - h[-1] / 6 * last
    inner = _tridiagonal(a, b, c, d)
    begin = inner[0] + first * (inner[0] - inner[1])
    end = inner[-1] + last * (inner[-1] - inner[-2])
    return [begin, *inner, end]


def _tridiagonal(a: list[Scalar], b: list[Scalar], c: list[Scalar], d: list[Scalar]) -> list:
    """``a_k x_{k−1} + b_k x_k + c_k x_{k+1} = d_k`` by elimination without pivots (Thomas)."""
    n, pivot, right = len(b), list(b), list(d)
    for k in range(1, n):
        factor = a[k] / pivot[k - 1]
        pivot[k] = b[k] - factor * c[k - 1]
        right[k] = d[k] - factor * right[k - 1]
    x = list(right)
    for k in reversed(range(n)):
        x[k] = (right[k] - (c[k] * x[k + 1] if k + 1 < n else 0.0)) / pivot[k]
    return x


def _cyclic(a: list[Scalar], b: list[Scalar], c: list[Scalar], d: list[Scalar]) -> list:
    """Cyclic system: ``a_0`` in the last column, ``c_{n−1}`` in the first (Sherman–Morrison)."""
    n = len(b)
    if n == 2:
        off0, off1 = a[0] + c[0], a[1] + c[1]
        size = b[0] * b[1] - off0 * off1
        return [(d[0] * b[1] - off0 * d[1]) / size, (b[0] * d[1] - off1 * d[0]) / size]
    modified = list(b)
    modified[0] = 2 * b[0]
    modified[-1] = b[-1] + a[0] * c[-1] / b[0]
    y = _tridiagonal(a, modified, c, d)
    z = _tridiagonal(a, modified, c, [-b[0], *([0.0] * (n - 2)), c[-1]])
    share = (y[0] - a[0] / b[0] * y[-1]) / (1 + z[0] - a[0] / b[0] * z[-1])
    return [p - share * q for p, q in zip(y, z, strict=True)]
