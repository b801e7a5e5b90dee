"""Point on a curve of another body, planar and spatial."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint, Look
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.curves import Curve
from dalembert.elements.look import Mark, Path
from dalembert.elements.pair import Pair, need_body, need_point, refuse_same_body
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


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
                f"{self.point_j.body.name} has {self.point_j.dimension}; give both as many",
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
