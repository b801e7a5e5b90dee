"""Point on a curve: cam and follower, guided point."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates, Look, Scalar, option, quantity
from dalembert.elements.curves import Curve
from dalembert.elements.look import Disc, Mark, Path
from dalembert.elements.pair import Pair, need_body, need_point, refuse_same_body
from dalembert.elements.planar.body import Body, rotation
from dalembert.elements.point import Point
from dalembert.errors import ModelError


class CurveParameter(Coordinates):
    """The place of the contact on a curve: one coordinate without mass."""

    def __init__(self, name: str, curve: Curve, guess: ca.SX | None):
        self.name = f"{name}.contact"
        self.interval = curve.interval()
        self.guess = guess
        self.make_symbols(("u",), ("",))

    def guesses(self) -> tuple[list, list]:
        return [self.guess], [None]


@dataclass(eq=False)
class PointOnCurve(Pair, Constraint):
    """A point of body j stays on a curve of body i.

    ``Φ = A_iᵀ (r_jP − r_i) − c(u) − radius · n(u) = 0`` with the curve parameter ``u`` as an
    additional coordinate without mass, so that the contact transmits no force along the curve.

    Parameters
    ----------
    body_i : body that carries the curve
    point_j : the following point (centre of the roller)
    curve : Curve in the frame of body i
    radius : of a roller on the right of the curve (outside, if it runs anticlockwise) [m]
    parameter : initial guess of ``u``; the nearest point if not given
    """

    body_i: Body
    point_j: Point
    curve: Curve = option("the curve", default=None)
    radius: Scalar = quantity("m", "roller radius", default=0.0, minimum=0.0)
    parameter: Scalar = quantity("", "initial guess of the curve parameter", default=None)

    def __post_init__(self) -> None:
        self.body_i = need_body(self.body_i, self.name, "body_i")
        self.point_j = need_point(self.point_j, self.name, "point_j")
        refuse_same_body(self.body_i, self.point_j.body, self.name)
        if not isinstance(self.curve, Curve):
            raise ModelError(f"curve must be a Curve, got {self.curve!r}", self.name)
        guess = self.parameter
        self._contact = CurveParameter(
            self.name,
            self.curve,
            None if guess is None else ca.SX(guess.sx if hasattr(guess, "sx") else guess),
        )
        super().__post_init__()

    def residual(self) -> ca.SX:
        local = ca.mtimes(
            rotation(self.body_i.pose_angle).T,
            self.point_j.position.sx - self.body_i.pose_position,
        )
        return local - self.curve.offset_position(self._contact.pose[0], self.radius.sx)

    def own_coordinates(self) -> list[Coordinates]:
        return [self._contact]

    def look(self) -> list[Look]:
        curve, roller = self.curve, self.radius.sx
        path = Path(self.body_i, curve.position, curve.interval(), curve.closed)
        wheel = [] if roller.is_zero() else [Disc(self.point_j, roller)]
        return [path, *wheel, Mark(self.point_j, self.body_i)]

    def ends(self) -> tuple[Body, Body]:
        return self.body_i, self.point_j.body

    def parts(self) -> list[Coordinates]:
        return [*self.ends(), self._contact]

    def place(self) -> ca.SX:
        point = self.curve.position(self._contact.pose[0])
        return self.body_i.pose_position + ca.mtimes(rotation(self.body_i.pose_angle), point)
