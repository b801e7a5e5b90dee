"""Interpolation of tables, usable in formulas."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.checked import checked_expression
from dalembert.symbolic.formulas.end_conditions import ENDS
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.spline import SLACK, CubicSpline, reached
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import unknown
from dalembert.units.amounts import check_unit
from dalembert.units.unit import unit

KINDS = ("spline", "linear")
OUTSIDE = ("error", "extrapolate", "clamp")
TABLE_ENDS = (*ENDS, "periodic")
MAX_ROWS = 1000
"""Upper limit of rows; longer tables are usually noise or the wrong file."""


class Interpolation(CheckedArguments):
    """A function ``y(x)`` through the rows of a table, with exact derivatives.

    Call it with a number or an expression: ``gas(piston.x)``; in the text of a formula write
    ``interp(piston.x, gas)``.

    Parameters
    ----------
    x : increasing numbers, with formulas or texts such as ``"10 mm"`` among them
    y : as many values
    kind : ``"spline"``, cubic, with two continuous derivatives, or ``"linear"``
    outside : beyond the first and last row: ``"error"``, the run ends there with a message;
        ``"extrapolate"`` along the slopes at the ends; ``"clamp"``, the values at the ends
    units : of x and y given as plain numbers, such as ``("mm", "kN")``; SI units by default
    name : in messages
    ends : of a spline: ``"not-a-knot"``, one cubic across the first two pieces; ``"clamped"``,
        zero slopes, for motions from rest to rest; ``"natural"``, zero second derivatives, which
        falsify accelerations near the ends; ``"periodic"``

    Raises
    ------
    ModelError
        Rows that do not increase, too few or too many rows, entries that are not numbers, unknown
        units or choices.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("gas spring")
    >>> piston = system.add(planar.Particle("piston", mass=0.5, position=(0.01, 0)))
    >>> gas = da.Interpolation(["0 mm", "10 mm", "30 mm"], [2000.0, 1500.0, 300.0])
    >>> pressure = system.add(planar.Force("gas", piston.center, (gas(piston.x), 0)))
    >>> motion = da.solve_dynamics(system.build(), 1e-3, step=1e-3)
    >>> round(motion["piston.ax"][0].item(), 6)  # 1500 N by the mass
    3000.0
    """

    def __init__(
        self,
        x: Sequence[Any] | np.ndarray,
        y: Sequence[Any] | np.ndarray,
        kind: str = "spline",
        outside: str = "error",
        units: tuple[str, str] = ("", ""),
        name: str = "",
        ends: str = "not-a-knot",
    ):
        self.name, entity = name, f"table {name}".rstrip()
        choices = {"kind": (kind, KINDS), "outside": (outside, OUTSIDE), "ends": (ends, TABLE_ENDS)}
        for option, (choice, choices_of_option) in choices.items():
            if choice not in choices_of_option:
                raise ModelError(unknown(option, choice, choices_of_option), entity)
        self.kind, self.outside, self.ends = kind, outside, ends
        periodic = ends == "periodic"
        si_units = []
        for text in units:
            try:
                si_units.append(unit(text))
            except ExpressionError as error:
                raise ModelError(error.message, entity) from None
        if len(x) > MAX_ROWS:
            raise ModelError(f"has {len(x)} rows; thin it out to {MAX_ROWS} or fewer", entity)
        knots, values = (
            [
                _in_si(value, si_unit.factor, f"{entity}, row {k + 1}")
                for k, value in enumerate(column)
            ]
            for column, si_unit in zip((x, y), si_units, strict=True)
        )
        self.units = (si_units[0].si or _unit_of(x), si_units[1].si or _unit_of(y))
        if kind == "linear":
            self._curve: Any = Polyline(knots, values, periodic, entity)
        else:
            condition = "not-a-knot" if periodic else ends
            self._curve = CubicSpline(knots, values, periodic, entity, condition)
        self.uses: list[ca.SX] = []

    @property
    def range(self) -> tuple[Any, Any]:
        """First and last x, in SI units; numbers or formulas."""
        return self._curve.knots[0], self._curve.knots[-1]

    def __call__(self, x: Any) -> Expression:
        """``y(x)``."""
        entity = f"table {self.name}".rstrip()
        if isinstance(x, Expression) and x.unit and self.units[0]:
            check_unit(x.unit, self.units[0], entity, f"{x.name or 'its argument'} [{x.unit}]")
        at = checked_expression(x, entity, self.units[0] or None).sx
        first, last = self.range
        slack, splines = SLACK * (last - first), (self._curve,)
        if self.ends == "periodic":
            return Expression(self._curve(at), splines=splines)
        if self.outside == "error":
            self.uses.append(at)
            inside = reached(at, first - slack) * (1 - reached(at, last + slack))
            value = ca.if_else(inside, self._curve(at), ca.SX.nan())
            return Expression(value, splines=splines)
        if self.outside == "clamp":
            at = self._clamped(at)
        return Expression(self._curve(at), splines=splines)

    def _clamped(self, x: ca.SX) -> ca.SX:
        first, last = self.range
        return ca.if_else(reached(x, first), ca.if_else(reached(last, x), x, last), first)

    def is_left_at(self, value: float) -> bool:
        """Whether a value lies outside the range, if its ends are numbers."""
        ends = [end for end in self.range if isinstance(end, float)]
        return len(ends) == 2 and not ends[0] <= value <= ends[1]

    def __repr__(self) -> str:
        return f"<table {self.name or ''} of {len(self._curve.knots)} rows, {self.kind}>"


class Polyline(CubicSpline):
    """Piecewise linear curve; the slope jumps at each row."""

    min_rows = 2

    def _curve(self) -> Any:
        slopes = [
            (b - a) / h
            for (a, b), h in zip(itertools.pairwise(self.values), self.steps, strict=True)
        ]

        ends = slopes[0], slopes[-1]
        if lookup := self._lookup(lambda: zip(self.values, slopes, strict=False)):
            return lookup, ends

        def inside(x: ca.SX) -> ca.SX:
            beyond = [reached(x, knot) for knot in self.knots[1:-1]]
            left, value, slope = (
                self.pick(rows, beyond) for rows in (self.knots[:-1], self.values[:-1], slopes)
            )
            return value + slope * (x - left)

        return inside, ends


def interp(x: Any, curve: Any) -> Expression:
    """The value of a table at x, in formulas."""
    if not isinstance(curve, Interpolation):
        raise ExpressionError("interp takes a value and the name of a table: interp(x, gas)")
    return curve(x)


def _unit_of(column: Sequence[Any] | np.ndarray) -> str:
    """The SI unit of the first text among the rows."""
    units = (checked_expression(value, "row").unit for value in column if isinstance(value, str))
    return next(units, "")


def _in_si(value: Any, factor: float, entity: str) -> Any:
    if isinstance(value, (Expression, str)):
        return checked_expression(value, entity)
    try:
        return float(value) * factor
    except (TypeError, ValueError):
        return value  # the curve raises the error
