"""What meshes, rolls or turns together without slip."""

from __future__ import annotations

import numpy as np
from twins import cross, direction, left, length

from dalembert import planar
from registry.cases import P, Q, case
from registry.joints import sliding_axis


def _start(c, name):
    """The given initial pose of a body, as a frame."""
    from twins import Frame

    return Frame(np.array([getattr(c.p, f"{name}_{w}") for w in ("x0", "y0", "angle0")]))


def _meshed(internal: bool, on_arm: bool):
    """Arc rolled off gear a equals the arc rolled off gear b, seen from the line of centres."""

    def rolled(a, b, p):
        line = direction(b.at((p.Q_x, p.Q_y)) - a.at((p.P_x, p.P_y)))
        inside = -1 if internal else 1
        return p.ra * (a.phi - line) + inside * p.rb * (b.phi - line)

    def residual(c):
        gear = np.atleast_1d(rolled(c.a, c.b, c.p) - rolled(_start(c, "a"), _start(c, "b"), c.p))
        if not on_arm:
            return gear
        pins = [P(c) - c.arm.at((c.p.A_x, c.p.A_y)), Q(c) - c.arm.at((c.p.B_x, c.p.B_y))]
        return np.concatenate([*pins, gear])

    return residual


def _gears(internal: bool):
    def build(q):
        i, j = q.points()
        ra, rb = q.numbers(ra=0.2, rb=0.5)
        q.add(planar.GearPair("J", i, j, radius_i=ra, radius_j=rb, internal=internal))

    return build


def _planetary(internal: bool):
    def build(q):
        arm = q.body("arm", (0.7, 0.2, 0.6), (0.1, 0.2, 0.9), 0.6, 0.1)
        i, j = q.points()
        q.add(planar.Revolute("A", q.point(arm, "A", -0.3, 0.05), i))
        q.add(planar.Revolute("B", q.point(arm, "B", 0.35, -0.02), j))
        ra, rb = q.numbers(ra=0.2, rb=0.5)
        q.add(planar.GearPair("J", i, j, radius_i=ra, radius_j=rb, internal=internal))

    return build


for _internal in (False, True):
    _kind_name = "internal" if _internal else "external"
    case(f"{_kind_name} gears", planar.GearPair, residual=_meshed(_internal, False))(
        _gears(_internal)
    )
    case(f"{_kind_name} gears on an arm", planar.GearPair, residual=_meshed(_internal, True))(
        _planetary(_internal)
    )


def _rack_slip(side: int):
    def travelled(a, b, p):
        axis = np.array([p.axis_x, p.axis_y])
        axis = a.vector(axis / length(axis))
        between = b.at((p.Q_x, p.Q_y)) - a.at((p.P_x, p.P_y))
        return axis @ between + side * p.radius * (b.phi - a.phi)

    return lambda c: travelled(c.a, c.b, c.p) - travelled(_start(c, "a"), _start(c, "b"), c.p)


def _pitch_point(side: int):
    return {"J": lambda c: Q(c) - side * c.p.radius * left(sliding_axis(c))}


def _on_line(kind, side: int):
    def build(q):
        q.add(
            kind(
                "J",
                *q.points(),
                axis=q.numbers(axis_x=1.2, axis_y=0.9),
                radius=q.number("radius", 0.3),
                side=side,
            )
        )

    return build


def _rolling(side: int):
    slip = _rack_slip(side)
    return lambda c: np.array([cross(sliding_axis(c), Q(c) - P(c)) - side * c.p.radius, slip(c)])


for _side, _where in ((1, "left"), (-1, "right")):
    case(
        f"rack and pinion {_where}",
        planar.RackAndPinion,
        residual=_rack_slip(_side),
        place=_pitch_point(_side),
    )(_on_line(planar.RackAndPinion, _side))
    case(
        f"rolling disc {_where}",
        planar.RollingDisc,
        residual=_rolling(_side),
        place=_pitch_point(_side),
    )(_on_line(planar.RollingDisc, _side))


def _coupled(carrier: bool):
    def ratio(a, b, base, p):
        return (b.phi - base) - p.ratio * (a.phi - base)

    def residual(c):
        now = ratio(c.a, c.b, c.arm.phi if carrier else 0.0, c.p)
        base = c.p.arm_angle0 if carrier else 0.0
        return now - ratio(_start(c, "a"), _start(c, "b"), base, c.p)

    return residual


@case("coupling", planar.Coupling, residual=_coupled(False))
def _(q):
    q.add(planar.Coupling("J", *q.pair(), ratio=q.number("ratio", -1.7)))


@case("coupling on carrier", planar.Coupling, residual=_coupled(True))
def _(q):
    arm = q.body("arm", (0.7, 0.2, 0.6), (0.1, 0.2, 0.9), 0.6, 0.1)
    q.add(planar.Coupling("J", *q.pair(), ratio=q.number("ratio", -1.7), carrier=arm))
