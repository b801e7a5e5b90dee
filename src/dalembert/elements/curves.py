"""Planar and spatial curves fixed in a body: cam profiles and guides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Rows, Scalar, option, quantity
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx
from dalembert.symbolic.formulas.spline import CubicSpline
from dalembert.text.spelling import Spelled

u = Expression(ca.SX.sym("u (of curves)"), "u", "")
"""Curve parameter, for curves written as formulas."""


class Curve(Spelled):
    """Point ``c(u)`` of a curve in the frame of its body."""

    closed: bool
    dimension = 2
    """Number of coordinates of its points."""

    def position(self, parameter: ca.SX) -> ca.SX:
        """``c(u)`` (2,) or (3,) [m]."""
        raise NotImplementedError

    def interval(self) -> tuple[float, float]:
        """Range of the parameter."""
        raise NotImplementedError

    def offset_position(self, parameter: ca.SX, distance: ca.SX) -> ca.SX:
        """A point to the right of a planar curve (outside, if it runs anticlockwise)."""
        symbol = ca.SX.sym("w")
        point = self.position(symbol)
        tangent = ca.jacobian(point, symbol)
        normal = ca.vertcat(tangent[1], -tangent[0]) / ca.sqrt(ca.sumsqr(tangent))
        return ca.substitute(point + distance * normal, symbol, parameter)


@dataclass(eq=False)
class SplineCurve(Curve):
    """C² cubic spline through points, parametrised by chord length (so ``|c'| ≈ 1``).

    Parameters
    ----------
    points : sequence of (x, y) or (x, y, z) in the body frame [m]; formulas are allowed
    closed : periodic; the first point need not be repeated
    ends : of an open curve: ``"not-a-knot"``, ``"clamped"`` or ``"natural"`` (no curvature there)

    Examples
    --------
    >>> import dalembert as da
    >>> corners = [(0.1, 0.0), (0.0, 0.08), (-0.1, 0.0), (0.0, -0.08)]
    >>> cam = da.SplineCurve(corners)
    >>> start, end = cam.interval()  # a closed curve
    >>> [[round(float(x), 6) + 0.0 for x in cam.position(u).elements()] for u in (start, end)]
    [[0.1, 0.0], [0.1, 0.0]]
    """

    points: Rows = option("points (x, y), in space (x, y, z), of the curve")
    closed: bool = option("the curve closes on itself", default=True)
    ends: str = option(
        "of an open curve: `not-a-knot`, `clamped` or `natural`", default="not-a-knot"
    )

    def __post_init__(self) -> None:
        if not isinstance(self.points, (Sequence, np.ndarray)):
            raise ModelError(f"points must be a list, got {self.points!r:.60}", "SplineCurve")
        self.dimension = 3 if len(self.points) and np.size(self.points[0]) == 3 else 2
        points = [
            as_expression(p, f"SplineCurve point {k + 1}", "m", self.dimension)
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
        else:  # knots must be constants: equal spacing, whatever the formulas
            chords = np.ones(len(columns) - 1)
        knots = np.concatenate([[0.0], np.cumsum(chords)])
        self._range = (0.0, float(knots[-1]))
        self._components = [
            CubicSpline(list(knots), [c[k] for c in columns], self.closed, "SplineCurve", self.ends)
            for k in range(self.dimension)
        ]

    def position(self, parameter: ca.SX) -> ca.SX:
        return ca.vertcat(*(component(parameter) for component in self._components))

    def interval(self) -> tuple[float, float]:
        return self._range


@dataclass(eq=False)
class FormulaCurve(Curve):
    """Curve ``(x(u), y(u))``, or ``(x, y, z)`` in space, from formulas in ``u`` and parameters.

    Parameters
    ----------
    x, y, z : formulas in ``u`` [m]; z in space only
    lower, upper : range of the parameter
    closed : the curve closes on itself

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> wheel = da.FormulaCurve(0.1 * da.cos(da.u), 0.1 * da.sin(da.u))
    >>> [round(float(x), 6) for x in wheel.position(math.pi / 2).elements()]
    [0.0, 0.1]
    >>> helix = da.FormulaCurve(da.cos(da.u), da.sin(da.u), closed=False, z=0.1 * da.u)
    >>> helix.dimension
    3
    """

    x: Scalar = quantity("m", "x(u)")
    y: Scalar = quantity("m", "y(u)")
    lower: float = option("start of the parameter", default=0.0)
    upper: float = option("end of the parameter", default=2 * np.pi)
    closed: bool = option("the curve closes on itself", default=True)
    z: Scalar = quantity("m", "z(u), of a curve in space", default=None)

    def __post_init__(self) -> None:
        self.x = as_expression(self.x, "FormulaCurve.x", "m")
        self.y = as_expression(self.y, "FormulaCurve.y", "m")
        self.dimension = 2 if self.z is None else 3
        if self.z is not None:
            self.z = as_expression(self.z, "FormulaCurve.z", "m")
        if not float(self.lower) < float(self.upper):
            raise ModelError(f"lower {self.lower} must be below upper {self.upper}", "FormulaCurve")

    def position(self, parameter: ca.SX) -> ca.SX:
        coordinates = (self.x, self.y) if self.z is None else (self.x, self.y, self.z)
        return ca.substitute(ca.vertcat(*(c.sx for c in coordinates)), u.sx, parameter)

    def interval(self) -> tuple[float, float]:
        return float(self.lower), float(self.upper)


def _same(a: ca.SX, b: ca.SX) -> bool:
    difference = as_sx(a) - as_sx(b)
    return bool(difference.is_constant() and float(ca.norm_inf(difference)) == 0.0)
