"""Butcher tableaux, checked when they are made."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from dalembert.errors import UnsupportedError


@dataclass(frozen=True)
class ButcherTableau:
    """Explicit Runge–Kutta method.

    Attributes
    ----------
    a : rows of the strictly lower triangle
    b, c : weights and nodes
    order : of the solution that is carried on
    b_error : weights of the error estimate (solution minus embedded solution), if any
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    order: int
    b_error: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        rows = [sum(row) for row in self.a]
        if not np.allclose(rows, self.c[1:], atol=1e-14) or self.c[0] != 0.0:
            raise UnsupportedError(f"tableau: row sums {rows} differ from nodes {self.c[1:]}")
        if not np.isclose(sum(self.b), 1.0, atol=1e-14):
            raise UnsupportedError(f"tableau: weights sum to {sum(self.b)}, not 1")
        if self.b_error is not None and not np.isclose(sum(self.b_error), 0.0, atol=1e-14):
            raise UnsupportedError("tableau: error weights do not sum to 0")

    @property
    def stages(self) -> int:
        return len(self.b)


CLASSICAL = ButcherTableau(
    a=((1 / 2,), (0, 1 / 2), (0, 0, 1)),
    b=(1 / 6, 1 / 3, 1 / 3, 1 / 6),
    c=(0, 1 / 2, 1 / 2, 1),
    order=4,
)
"""Kutta (1901)."""

_R = sqrt(2)
GILL = ButcherTableau(
    a=((1 / 2,), ((_R - 1) / 2, (2 - _R) / 2), (0, -_R / 2, (2 + _R) / 2)),
    b=(1 / 6, (2 - _R) / 6, (2 + _R) / 6, 1 / 6),
    c=(0, 1 / 2, 1 / 2, 1),
    order=4,
)
"""Gill (1951)."""

_B5 = (35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0)
_B4 = (5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40)
DORMAND_PRINCE = ButcherTableau(
    a=(
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        _B5[:6],
    ),
    b=_B5,
    c=(0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1),
    order=5,
    b_error=tuple(x - y for x, y in zip(_B5, _B4, strict=True)),
)
"""Dormand and Prince (1980), 5(4)."""
