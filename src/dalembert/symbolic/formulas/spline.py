"""Cubic splines in the expression graph, with a choice of end conditions."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.checked import checked_expression
from dalembert.symbolic.formulas.end_conditions import ENDS, second_derivatives
from dalembert.text.wording import unknown

LOOKUP_ROWS = 16
"""Threshold for table lookup instead of a written-out sum, where both cost about the same."""

SLACK = 1e-9
"""Extension of the first and last cubic beyond the ends, relative to the range."""
COARSE = 0.05
"""Threshold for a warning: change of the second derivative at an end without every second row,
relative to the largest one."""
SAMPLED_ROWS = 9
"""Rows below which a table defines a curve instead of sampling one."""

SCALE = 2.0**600
"""Scale that makes all coefficients integers, which ``floor`` does not change. Coefficients have no
derivative, yet CasADi 3.8 returns NaN for that of a call; the derivative of ``floor`` is zero."""

Scalar = Any  # float, or casadi.SX for a formula
Inside = Callable[[ca.SX], ca.SX]


class Lookup:
    """Piecewise polynomials with constant coefficients: ``x → (left end of a piece, its numbers)``.

    A graph of scalars has no arrays: written out, the choice of a piece costs operations for each
    row. A lookup is one call, which finds the piece by bisection.

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


class CubicSpline:
    """Interpolating cubic spline; knots and values may be formulas.

    Second derivatives at the knots solve a tridiagonal system, which is part of the graph if it
    has formulas: the spline is differentiable by its knots and values.

    Parameters
    ----------
    knots : n increasing numbers or formulas
    values : n numbers or formulas
    periodic : the last value equals the first and the spline repeats
    entity : name used in messages
    ends : end conditions of a spline that is not periodic, one of ``ENDS``. ``"not-a-knot"``
        reproduces cubics; its second derivative at an end has an error of ``O(h²)``, as between
        the knots; with ``"natural"`` the error there is the whole second derivative.

    Raises
    ------
    ModelError
        Fewer than three rows, entries that are not numbers, knots that do not increase, a periodic
        spline that does not close, unknown end conditions.
    """

    min_rows = 3
    """Smallest number of rows."""

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
        if len(self.knots) < self.min_rows:
            raise ModelError(
                f"a curve needs at least {self.min_rows} rows, got {len(self.knots)}", entity
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
        self._inside, self._slopes = self._curve()

    def _curve(self) -> tuple[Inside, tuple[Scalar, Scalar]]:
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

        inside = self._lookup(rows) or self._sum_of_pieces(m)
        return inside, (slope(0, -2, -1), slope(len(h) - 1, 1, 2))

    def _lookup(self, rows: Callable[[], Iterator[tuple[float, ...]]]) -> Inside | None:
        """Table lookup, for many constant pieces; else None."""
        constant = all(isinstance(x, float) for x in (*self.knots, *self.values))
        if not constant or len(self.knots) <= LOOKUP_ROWS:
            return None
        coefficients = np.array(list(rows()))
        exact = Lookup.holds(self.knots, coefficients)
        return Lookup(self.knots, coefficients) if exact else None

    def conditions(self) -> list[tuple[ca.SX, str]]:
        """(formula that must not be negative, message otherwise) for knots given by formulas."""
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

    def end_warning(self) -> str:
        """Warning about second derivatives near the ends that differ from the sampled function.

        Empty without a reason for one, for rows with formulas, and for few rows.
        """
        constant = all(isinstance(x, float) for x in (*self.knots, *self.values))
        if self.periodic or self.min_rows < 3 or not constant or len(self.knots) < 4:
            return ""
        reference = np.array(second_derivatives(self.steps, self.values, "not-a-knot"))
        largest = float(np.abs(reference).max())
        if self.ends == "not-a-knot":
            return self._coarse(largest)
        first, last = np.array(self.second_derivatives)[[0, -1]]
        off = max(abs(first - reference[0]), abs(last - reference[-1]))
        if off <= {"natural": COARSE, "clamped": 0.5}[self.ends] * largest:
            return ""
        cure = ", or 'clamped' for motions from rest to rest" if self.ends == "natural" else ""
        return (
            f"{self.entity} has {self.ends} ends with the second derivatives {first:.4g} and "
            f"{last:.4g}; its rows suggest {reference[0]:.4g} and {reference[-1]:.4g}: use ends = "
            f"'not-a-knot'{cure}"
        )

    def _coarse(self, largest: float) -> str:
        """Warning about a second derivative at an end that is not resolved by the rows."""
        if len(self.knots) < SAMPLED_ROWS:
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

    def _sum_of_pieces(self, m: list[Scalar]) -> Inside:
        """The spline between its ends as a written-out sum over its pieces."""

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
        """The row of the piece that contains x; ``beyond``: 1 for the inner knots below x."""
        if all(isinstance(r, float) and r == rows[0] for r in rows):
            return ca.SX(rows[0])
        jumps = [b - a for a, b in itertools.pairwise(rows)]
        return ca.SX(rows[0]) + sum(j * r for j, r in zip(jumps, beyond, strict=True))


def reached(x: ca.SX, knot: Scalar) -> ca.SX:
    """1 at and above the knot, else 0; without a switch, as the spline is smooth at knots."""
    return (1 + ca.copysign(1, x - knot)) / 2


def _scalars(column: Sequence, entity: str, quantity: str) -> list[Scalar]:
    """Constants of a column as floats, formulas as SX."""
    try:
        rows = list(column)
    except TypeError:
        raise ModelError(f"expected a list of numbers, got {column!r:.60}", entity) from None
    scalars: list[Scalar] = []
    for k, value in enumerate(rows):
        if isinstance(value, float) and 1e-100 < abs(value) < 1e100:
            scalars.append(float(value))
            continue
        try:
            sx = checked_expression(value, entity).sx
        except ExpressionError as error:
            raise type(error)(f"{quantity} in row {k + 1}: {error.message}", entity) from None
        scalars.append(float(sx) if sx.is_constant() else sx)
    return scalars
