"""Cubic splines in the expression graph: C², with a choice of end conditions."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.checked import checked_expression
from dalembert.symbolic.formulas.end_conditions import ENDS, second_derivatives
from dalembert.symbolic.formulas.lookup import Lookup
from dalembert.text.wording import unknown

LARGE = 16
"""Rows beyond which a table of constants is looked up instead of written out: about as many cost
the virtual machine as much as a call."""

SLACK = 1e-9
"""Share of the range beyond its ends in which the first and last cubics go on."""
COARSE = 0.05
"""Change of the second derivative at an end without every second row, relative to its largest,
beyond which the rows do not determine it."""
ENOUGH = 9
"""Rows below which a table defines a curve rather than samples one."""

Scalar = Any  # a float where it is known, else a casadi.SX
Inside = Callable[[ca.SX], ca.SX]


class CubicSpline:
    """Interpolating cubic spline; knots and values may be formulas.

    Second derivatives at the knots solve a tridiagonal system, which stands in the graph where it
    has formulas: the spline is differentiable by its knots and values.

    Parameters
    ----------
    knots : n increasing numbers or formulas
    values : n numbers or formulas
    periodic : the last value equals the first and the spline repeats
    entity : name used in messages
    ends : end conditions of a spline that is not periodic, one of ``ENDS``. ``"not-a-knot"``
        reproduces cubics, its second derivative at an end is in error by ``O(h²)``, as between the
        knots; ``"natural"`` is in error there by the whole second derivative.

    Raises
    ------
    ModelError
        Fewer than three rows, numbers that are none, knots that do not increase, a periodic spline
        that does not close, unknown end conditions.
    """

    least = 3
    """Rows that it needs."""

    def __init__(
        self,
        knots: Sequence,
        values: Sequence,
        periodic: bool,
        entity: str,
        ends: str = "not-a-knot",
    ):
        if ends not in ENDS:
            raise ModelError(unknown("ends", ends, ENDS), entity)
        self.periodic, self.entity, self.ends = periodic, entity, ends
        self.knots = _scalars(knots, entity, "abscissa")
        self.values = _scalars(values, entity, "value")
        if len(self.knots) != len(self.values):
            text = f"{len(self.knots)} abscissae but {len(self.values)} values"
            raise ModelError(text, entity)
        if len(self.knots) < self.least:
            raise ModelError(
                f"a curve needs at least {self.least} rows, got {len(self.knots)}", entity
            )
        self.steps = [b - a for a, b in zip(self.knots, self.knots[1:], strict=False)]
        for k, step in enumerate(self.steps):
            if isinstance(step, float) and not step > 0:
                raise ModelError(
                    f"abscissae must increase, but row {k + 2} ({self.knots[k + 1]}) "
                    f"does not follow row {k + 1} ({self.knots[k]})",
                    entity,
                )
        if periodic:
            self._check_closed()
        self._inside, self._slopes = self._made()

    def _made(self) -> tuple[Inside, tuple[Scalar, Scalar]]:
        """The curve between its ends, and its slopes there."""
        h, v = self.steps, self.values
        m = self.second_derivatives = second_derivatives(
            h, v, "periodic" if self.periodic else self.ends
        )

        def slope(k: int, left: float, right: float) -> Scalar:
            return (v[k + 1] - v[k]) / h[k] + h[k] * (left * m[k] + right * m[k + 1]) / 6

        def rows() -> Iterator[tuple[float, ...]]:
            for k, step in enumerate(h):
                yield v[k], slope(k, -2, -1), m[k] / 2, (m[k + 1] - m[k]) / (6 * step)

        inside = self._looked_up(rows) or self._written_out(m)
        return inside, (slope(0, -2, -1), slope(len(h) - 1, 1, 2))

    def _looked_up(self, rows: Callable[[], Iterator[tuple[float, ...]]]) -> Inside | None:
        """The pieces looked up, where they are many and constant; else nothing."""
        constant = all(isinstance(x, float) for x in (*self.knots, *self.values))
        if not constant or len(self.knots) <= LARGE:
            return None
        found = np.array(list(rows()))
        return Lookup(self.knots, found) if Lookup.holds(self.knots, found) else None

    def conditions(self) -> list[tuple[ca.SX, str]]:
        """(formula that must not be negative, what is wrong if it is) of knots by formulas."""
        text = "abscissae must increase, but row {} does not follow row {} with these parameters"
        return [
            (step - 1e-12 * ca.fabs(self.knots[k + 1]) - 1e-100, text.format(k + 2, k + 1))
            for k, step in enumerate(self.steps)
            if not isinstance(step, float)
        ]

    def __call__(self, x: ca.SX) -> ca.SX:
        first, last = self.knots[0], self.knots[-1]
        if self.periodic:
            return self._inside(x - (last - first) * ca.floor((x - first) / (last - first)))
        slack = SLACK * (last - first)
        begun, over = reached(x, first - slack), reached(x, last + slack)
        before = self.values[0] + self._slopes[0] * (x - first)
        after = self.values[-1] + self._slopes[1] * (x - last)
        inside = self._inside(ca.if_else(begun, ca.if_else(over, last, x), first))
        return ca.if_else(begun, ca.if_else(over, after, inside), before)

    def end_doubt(self) -> str:
        """Why its second derivatives near the ends are not those of the sampled function.

        Empty where there is no such reason, rows are formulas, or few rows define the curve.
        """
        constant = all(isinstance(x, float) for x in (*self.knots, *self.values))
        if self.periodic or self.least < 3 or not constant or len(self.knots) < 4:
            return ""
        better = np.array(second_derivatives(self.steps, self.values, "not-a-knot"))
        largest = float(np.abs(better).max())
        if self.ends == "not-a-knot":
            return self._coarse(largest)
        first, last = np.array(self.second_derivatives)[[0, -1]]
        off = max(abs(first - better[0]), abs(last - better[-1]))
        if off <= {"natural": COARSE, "clamped": 0.5}[self.ends] * largest:
            return ""
        cure = ", or 'clamped' for motions from rest to rest" if self.ends == "natural" else ""
        return (
            f"{self.entity} has {self.ends} ends with the second derivatives {first:.4g} and "
            f"{last:.4g}; its rows suggest {better[0]:.4g} and {better[-1]:.4g}: use ends = "
            f"'not-a-knot'{cure}"
        )

    def _coarse(self, largest: float) -> str:
        """Doubt about a second derivative at an end that follows from too few rows."""
        if len(self.knots) < ENOUGH:
            return ""
        for side, label in ((1, "first"), (-1, "last")):
            knots = np.array(self.knots)[::side][::2] * side
            coarse = second_derivatives(
                list(np.diff(knots)), self.values[::side][::2], "not-a-knot"
            )
            value = self.second_derivatives[::side][0]
            change = abs(coarse[0] - value) / 3
            if change > COARSE * largest:
                return (
                    f"the second derivative of {self.entity} at its {label} row, {value:.4g}, "
                    f"is uncertain by about {change:.2g}: give more rows, or smooth measured ones"
                )
        return ""

    def _check_closed(self) -> None:
        gap = self.values[-1] - self.values[0]
        scale = max([1.0, *(abs(v) for v in self.values if isinstance(v, float))])
        if isinstance(gap, float) and abs(gap) > 1e-9 * scale:
            raise ModelError(
                f"a periodic spline must end where it begins; it misses by {gap}", self.entity
            )

    def _written_out(self, m: list[Scalar]) -> Inside:
        """The spline between its ends as a sum over its pieces."""

        def inside(x: ca.SX) -> ca.SX:
            beyond = [reached(x, knot) for knot in self.knots[1:-1]]
            v = self.values
            ends = (self.knots[:-1], self.knots[1:], v[:-1], v[1:], m[:-1], m[1:])
            left, right, v0, v1, m0, m1 = (self.pick(rows, beyond) for rows in ends)
            width, a, b = right - left, right - x, x - left
            return (
                (m0 * a**3 + m1 * b**3) / (6 * width)
                + (v0 / width - m0 * width / 6) * a
                + (v1 / width - m1 * width / 6) * b
            )

        return inside

    @staticmethod
    def pick(rows: list[Scalar], beyond: list[ca.SX]) -> ca.SX:
        """The row of the piece in which x lies, which is beyond some of the inner knots."""
        if all(isinstance(r, float) and r == rows[0] for r in rows):
            return ca.SX(rows[0])
        jumps = [b - a for a, b in itertools.pairwise(rows)]
        return ca.SX(rows[0]) + sum(j * r for j, r in zip(jumps, beyond, strict=True))


def reached(x: ca.SX, knot: Scalar) -> ca.SX:
    """1 from the knot on, else 0; no comparison, for at knots the spline is smooth."""
    return (1 + ca.copysign(1, x - knot)) / 2


def _scalars(given: Sequence, entity: str, what: str) -> list[Scalar]:
    """Floats, and formulas where there are some."""
    try:
        listed = list(given)
    except TypeError:
        raise ModelError(f"expected a list of numbers, got {given!r:.60}", entity) from None
    found: list[Scalar] = []
    for k, value in enumerate(listed):
        if isinstance(value, float) and 1e-100 < abs(value) < 1e100:
            found.append(float(value))
            continue
        try:
            sx = checked_expression(value, entity).sx
        except ExpressionError as error:
            raise type(error)(f"{what} in row {k + 1}: {error.message}", entity) from None
        found.append(float(sx) if sx.is_constant() else sx)
    return found
