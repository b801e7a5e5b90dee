"""Bodies and the joints between them."""

from __future__ import annotations

import numpy as np
from twins import cross, length

from dalembert import cos, planar, t
from registry.cases import P, Q, case


@case("free bodies", planar.Body, planar.Bar, planar.Particle)
def _(q):
    q.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7))
    q.body(
        "rod",
        (1.0, 0.3, -0.2),
        (0.1, 0.2, 0.3),
        inertia=None,
        kind=planar.Bar,
        length=q.number("rod_length", 0.7),
    )
    q.body("dot", (-1.0, 0.3), (0.1, 0.2), kind=planar.Particle)


@case("revolute", planar.Revolute, residual=lambda c: Q(c) - P(c))
def _(q):
    q.add(planar.Revolute("J", *q.points()))


@case(
    "revolute on ground",
    planar.Revolute,
    planar.Ground,
    objective=False,
    residual=lambda c: c.a.at((c.p.A_x, c.p.A_y)) - np.array([c.p.O_x, c.p.O_y]),
)
def _(q):
    a = q.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7))
    q.add(planar.Revolute("J", q.point(q.ground, "O", 0.1, 0.1), q.point(a, "A", -0.2, 0.3)))


def sliding_axis(c):
    axis = np.array([c.p.axis_x, c.p.axis_y])
    return c.a.vector(axis / length(axis))


@case(
    "translational",
    planar.Prismatic,
    residual=lambda c: np.array(
        [cross(sliding_axis(c), Q(c) - P(c)), c.b.phi - c.a.phi - c.p.angle]
    ),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    q.add(planar.Prismatic("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))


@case("pin in slot", planar.PinInSlot, residual=lambda c: cross(sliding_axis(c), Q(c) - P(c)))
def _(q):
    q.add(planar.PinInSlot("J", *q.points(), axis=q.numbers(axis_x=1.2, axis_y=0.9)))


@case(
    "weld",
    planar.Weld,
    residual=lambda c: np.append(Q(c) - P(c), c.b.phi - c.a.phi - c.p.angle),
)
def _(q):
    q.add(planar.Weld("J", *q.points(), angle=q.number("angle", -0.8)))


@case("rigid link", planar.RigidLink, residual=lambda c: length(Q(c) - P(c)) - c.p.link)
def _(q):
    q.add(planar.RigidLink("J", *q.points(), length=q.number("link", 0.8)))


@case(
    "rigid link between particles",
    planar.RigidLink,
    planar.Particle,
    residual=lambda c: length(c.b.r - c.a.r) - c.p.link,
)
def _(q):
    a = q.body("a", (0.3, -0.2), (0.5, -0.3), kind=planar.Particle)
    b = q.body("b", (1.1, 0.5), (-0.2, 0.4), 0.8, kind=planar.Particle)
    q.add(planar.RigidLink("J", a.center, b.center, length=q.number("link", 1.05)))


@case(
    "user constraint",
    planar.UserConstraint,
    objective=False,
    scleronomic=False,
    residual=lambda c: c.p.k * c.a.r[0] * np.cos(c.b.phi) + c.b.r[1] ** 2 - c.p.h - c.p.s * c.t**2,
)
def _(q):
    a, b = q.pair()
    k, h, s = q.numbers(k=1.4, h=0.55, s=0.6)
    q.add(planar.UserConstraint("J", k * a.x * cos(b.angle) + b.y**2 - h - s * t**2))
