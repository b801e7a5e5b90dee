"""Points that follow curves."""

from __future__ import annotations

import numpy as np
from twins import cubic, left, length, turn

from dalembert import FormulaCurve, SplineCurve, cos, planar, sin
from dalembert.elements.curves import u
from registry.cases import Q, case

CORNERS = np.array(
    [(0.5, 0.0), (0.35, 0.4), (-0.1, 0.5), (-0.45, 0.1), (-0.3, -0.4), (0.25, -0.45)]
)


def _spline(c, derivative: bool):
    table = np.array([[getattr(c.p, f"c{k}_{w}") for w in "xy"] for k in range(len(CORNERS))])
    table = np.vstack([table, table[:1]])
    knots = np.arange(len(table), dtype=float)
    return np.array([cubic(c.u, knots, table[:, k], "periodic", derivative) for k in (0, 1)])


def _ellipse(c, derivative: bool):
    if derivative:
        return np.array([-c.p.major * np.sin(c.u), c.p.minor * np.cos(c.u)])
    return np.array([c.p.major * np.cos(c.u), c.p.minor * np.sin(c.u)])


def _follows(curve, roller: bool):
    """Body a carries the curve; Q follows at the roller's radius on the right of it."""

    def residual(c):
        tangent = curve(c, True)
        off = (c.p.roller if roller else 0.0) * -left(tangent) / length(tangent)
        return turn(-c.a.phi, Q(c) - c.a.r) - curve(c, False) - off

    return residual


@case(
    "point on spline curve",
    planar.PointOnCurve,
    SplineCurve,
    residual=_follows(_spline, True),
    place={"J": lambda c: c.a.at(_spline(c, False))},
)
def _(q):
    a, b = q.pair((0.87, 0.0, -0.6))
    corners = [q.numbers(**{f"c{k}_x": x, f"c{k}_y": y}) for k, (x, y) in enumerate(CORNERS)]
    q.add(
        planar.PointOnCurve(
            "J",
            a,
            q.point(b, "Q", -0.22, 0.17),
            SplineCurve(corners),
            radius=q.number("roller", 0.15),
            parameter=q.number("u0", 0.4),
        )
    )


@case(
    "point on formula curve",
    planar.PointOnCurve,
    FormulaCurve,
    residual=_follows(_ellipse, False),
    place={"J": lambda c: c.a.at(_ellipse(c, False))},
)
def _(q):
    a, b = q.pair()
    major, minor = q.numbers(major=0.8, minor=0.45)
    curve = FormulaCurve(major * cos(u), minor * sin(u))
    point = q.point(b, "Q", -0.22, 0.17)
    q.add(planar.PointOnCurve("J", a, point, curve, parameter=q.number("u0", 0.3)))
