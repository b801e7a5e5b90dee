"""Plane curves fixed in a body: cam profiles and guides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Rows, Scalar, option, quantity
from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression, as_expression, as_sx
from dalembert.symbolic.spline import CubicSpline

u = Expression(ca.SX.sym("u"), "u", "")
"""Curve parameter, for curves written as formulas."""


class Curve:
    """Point ``c(u)`` of a curve in the frame of its body."""

    closed: bool

    def position(self, parameter: ca.SX) -> ca.SX:
        """``c(u)`` (2,) [m]."""
        raise NotImplementedError

    def interval(self) -> tuple[float, float]:
        """Range of the parameter."""
        raise NotImplementedError

    def offset_position(self, parameter: ca.SX, distance: ca.SX) -> ca.SX:
        """Point at a distance to the right of the curve (outside, if it runs anticlockwise)."""
        symbol = ca.SX.sym("w")
        point = self.position(symbol)
        tangent = ca.jacobian(point, symbol)
        normal = ca.vertcat(tangent[1], -tangent[0]) / ca.sqrt(ca.sumsqr(tangent))
        return ca.substitute(point + distance * normal, symbol, parameter)


@dataclass(eq=False)
class SplineCurve(Curve):
    """C² cubic spline through points, by chord length (so ``|c'| ≈ 1``).

    Parameters
    ----------
    points : sequence of (x, y) in the body frame [m]; formulas are allowed
    closed : periodic; the first point need not be repeated
    """

    points: Rows = option("points (x, y) of the curve")
    closed: bool = option("the curve closes on itself", default=True)

    def __post_init__(self) -> None:
        if not isinstance(self.points, (Sequence, np.ndarray)):
            raise ModelError(f"points must be a list, got {self.points!r:.60}", "SplineCurve")
        points = [
            as_expression(p, f"SplineCurve point {k + 1}", "m", 2)
            for k, p in enumerate(self.points)
        ]
        if len(points) < 3:
            raise ModelError(f"needs at least 3 points, got {len(points)}", "SplineCurve")
        columns = [p.sx for p in points]
        if self.closed and not _same(columns[0], columns[-1]):
            columns.append(columns[0])
        numeric = all(c.is_constant() for c in columns)
        if numeric:
            table = np.array([np.asarray(ca.DM(c)).ravel() for c in columns])
            chords = np.linalg.norm(np.diff(table, axis=0), axis=1)
            if np.any(chords <= 0):
                k = int(np.argmax(chords <= 0))
                raise ModelError(f"points {k + 1} and {k + 2} coincide", "SplineCurve")
        else:  # knots must be constants; equal spacing leaves the shape free
            chords = np.ones(len(columns) - 1)
        knots = np.concatenate([[0.0], np.cumsum(chords)])
        self._range = (0.0, float(knots[-1]))
        self._x, self._y = (
            CubicSpline(list(knots), [c[k] for c in columns], self.closed, "SplineCurve")
            for k in (0, 1)
        )

    def position(self, parameter: ca.SX) -> ca.SX:
        return ca.vertcat(self._x(parameter), self._y(parameter))

    def interval(self) -> tuple[float, float]:
        return self._range


@dataclass(eq=False)
class FormulaCurve(Curve):
    """Curve ``(x(u), y(u))`` by formulas in ``u`` and parameters.

    Parameters
    ----------
    x, y : formulas in ``u`` [m]
    lower, upper : range of the parameter
    closed : the curve closes on itself
    """

    x: Scalar = quantity("m", "x(u)")
    y: Scalar = quantity("m", "y(u)")
    lower: float = option("start of the parameter", default=0.0)
    upper: float = option("end of the parameter", default=2 * np.pi)
    closed: bool = option("the curve closes on itself", default=True)

    def __post_init__(self) -> None:
        self.x = as_expression(self.x, "FormulaCurve.x", "m")
        self.y = as_expression(self.y, "FormulaCurve.y", "m")
        if not float(self.lower) < float(self.upper):
            raise ModelError(f"lower {self.lower} must be below upper {self.upper}", "FormulaCurve")

    def position(self, parameter: ca.SX) -> ca.SX:
        return ca.substitute(ca.vertcat(self.x.sx, self.y.sx), u.sx, parameter)

    def interval(self) -> tuple[float, float]:
        return float(self.lower), float(self.upper)


def _same(a: ca.SX, b: ca.SX) -> bool:
    difference = as_sx(a) - as_sx(b)
    return bool(difference.is_constant() and float(ca.norm_inf(difference)) == 0.0)
