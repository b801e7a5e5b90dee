"""Planar and spatial curves fixed in a body, and points that follow them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, Look, Rows, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Mark, Path
from dalembert.elements.pair import Pair, need_body, need_point, refuse_same_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx
from dalembert.symbolic.formulas.spline import CubicSpline
from dalembert.text.arguments import CheckedArguments

u = Expression(ca.SX.sym("u (of curves)"), "u", "")
"""Curve parameter, for curves written as formulas."""


class Curve(CheckedArguments):
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
            as_expression(p, f"SplineCurve points[{k}]", "m", self.dimension)
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
                raise ModelError(f"points[{k}] and points[{k + 1}] coincide", "SplineCurve")
        else:  # knots must be constants: equal spacing for all formulas
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
    >>> wheel = da.FormulaCurve(0.1 * da.cos(da.curves.u), 0.1 * da.sin(da.curves.u))
    >>> [round(float(x), 6) for x in wheel.position(math.pi / 2).elements()]
    [0.0, 0.1]
    >>> u = da.curves.u
    >>> helix = da.FormulaCurve(da.cos(u), da.sin(u), closed=False, z=0.1 * u)
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


class CurveParameter(Coordinates):
    """Parameter of the contact point on a curve: one massless coordinate."""

    def __init__(self, name: str, curve: Curve, guess: Expression | None):
        self.name = f"{name}.contact"
        self.interval = curve.interval()
        self.guess = None if guess is None else guess.sx
        self.make_symbols(("u",), ("",))

    def guesses(self) -> tuple[list, list]:
        return [self.guess], [None]


class OnCurve(Pair, Constraint):
    """Point of body j on a curve of body i, ``Φ = A_iᵀ (r_jP − r_i) − c(u) = 0``.

    The curve parameter ``u`` is an additional massless coordinate, so that the contact transmits
    no force along the curve.
    """

    name: str
    body_i: Any
    point_j: Point
    curve: Curve
    parameter: Any

    def __post_init__(self) -> None:
        self.body_i = need_body(self.body_i, self.name, "body_i")
        self.point_j = need_point(self.point_j, self.name, "point_j")
        refuse_same_body(self.body_i, self.point_j.body, self.name)
        if not isinstance(self.curve, Curve):
            raise ModelError(f"curve must be a Curve, got {self.curve!r}", self.name)
        if self.curve.dimension != self.point_j.dimension:
            raise ModelError(
                f"points of the curve have {self.curve.dimension} coordinates, and the point of "
                f"{self.point_j.body.name} has {self.point_j.dimension}; use the same number",
                self.name,
            )
        self._contact = CurveParameter(self.name, self.curve, self._guess())
        super().__post_init__()

    def _guess(self) -> Expression | None:
        guess = self.parameter
        return guess if guess is None or isinstance(guess, Expression) else Expression(guess)

    @property
    def contact(self) -> ca.SX:
        """The curve parameter."""
        return self._contact.pose[0]

    def target(self) -> ca.SX:
        """Prescribed position of the point, in the axes of body i."""
        return self.curve.position(self.contact)

    def residual(self) -> ca.SX:
        n = self.curve.dimension
        axes = ca.horzcat(*(self.body_i.turned(ca.SX.eye(n)[:, k]) for k in range(n)))
        relative = self.point_j.position.sx - self.body_i.locate(ca.SX.zeros(n))
        return ca.mtimes(axes.T, relative) - self.target()

    def own_coordinates(self) -> list[Coordinates]:
        return [self._contact]

    def look(self) -> list[Look]:
        curve = self.curve
        path = Path(self.body_i, curve.position, curve.interval(), curve.closed)
        return [path, Mark(self.point_j, self.body_i)]

    def ends(self) -> tuple[Any, Any]:
        return self.body_i, self.point_j.body

    def parts(self) -> list[Coordinates]:
        return [*self.ends(), self._contact]

    def place(self) -> ca.SX:
        """The contact point on the curve."""
        return self.body_i.locate(self.curve.position(self.contact))
