"""Forces, moments, springs, actuators and bushings."""

from __future__ import annotations

import numpy as np
from twins import length, turn

from dalembert import cos, planar, sin, t
from registry.cases import P, Q, case


def opposite(c, force, place_i, place_j, moment=0.0):
    """A force and moment on b, and their opposites on a."""
    return [("b", force, place_j, moment), ("a", -force, place_i, -moment)]


def approach(c):
    """Unit vector from P to Q and the rate of their distance."""
    between = Q(c) - P(c)
    along = between / length(between)
    return along, along @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)))


def _pull(tension):
    """Loads of an element that pulls P and Q together."""

    def loads(c):
        along, speed = approach(c)
        return opposite(c, -tension(c, length(Q(c) - P(c)), speed) * along, P(c), Q(c))

    return loads


def _force_at_p(c, force):
    return [("a", force, P(c), 0.0)]


@case(
    "force",
    planar.Force,
    objective=False,
    conservative=False,
    loads=lambda c: _force_at_p(c, np.array([c.p.fx * np.cos(3 * c.t), c.p.fy * c.b.r[0]])),
)
def _(q):
    a, b = q.pair()
    fx, fy = q.numbers(fx=3.0, fy=-2.0)
    q.add(planar.Force("F", q.point(a, "P", 0.31, 0.12), (fx * cos(3 * t), fy * b.x)))


@case(
    "following force",
    planar.Force,
    conservative=False,
    loads=lambda c: _force_at_p(c, c.a.vector(np.array([c.p.fx * np.cos(3 * c.t), c.p.fy]))),
)
def _(q):
    a, _ = q.pair()
    fx, fy = q.numbers(fx=3.0, fy=-2.0)
    q.add(planar.Force("F", q.point(a, "P", 0.31, 0.12), (fx * cos(3 * t), fy), following=True))


@case(
    "moment",
    planar.Torque,
    conservative=False,
    loads=lambda c: [("a", np.zeros(2), c.a.r, c.p.m0 * (1 - c.a.w / c.p.w0))],
)
def _(q):
    a, _ = q.pair()
    m0, w0 = q.numbers(m0=2.0, w0=5.0)
    q.add(planar.Torque("F", a, m0 * (1 - a.angular_velocity / w0)))


@case(
    "moment with reaction",
    planar.Torque,
    conservative=False,
    loads=lambda c: opposite(c, np.zeros(2), c.a.r, c.b.r, c.p.m0 * np.cos(2 * c.t)),
)
def _(q):
    a, b = q.pair()
    q.add(planar.Torque("F", b, q.number("m0", 2.0) * cos(2 * t), reaction_on=a))


@case(
    "spring",
    planar.Spring,
    loads=_pull(lambda c, s, rate: c.p.k * (s - c.p.l0) + c.p.d * rate),
)
def _(q):
    k, d, l0 = q.numbers(k=30.0, d=1.5, l0=0.5)
    q.add(planar.Spring("F", *q.points(), stiffness=k, damping=d, free_length=l0))


@case(
    "spring with law",
    planar.Spring,
    conservative=False,
    loads=_pull(
        lambda c, s, rate: (
            c.p.k * (s - c.p.l0) + c.p.d * rate + c.p.k3 * (s - c.p.l0) ** 3 + c.p.d3 * rate**3
        )
    ),
)
def _(q):
    k, d, l0, k3, d3 = q.numbers(k=30.0, d=1.5, l0=0.5, k3=200.0, d3=0.7)
    q.add(
        planar.Spring(
            "F",
            *q.points(),
            stiffness=k,
            damping=d,
            free_length=l0,
            law=lambda extension, rate: k3 * extension**3 + d3 * rate**3,
        )
    )


@case(
    "rotational spring",
    planar.TorsionSpring,
    loads=lambda c: opposite(
        c,
        np.zeros(2),
        c.a.r,
        c.b.r,
        -c.p.k * (c.b.phi - c.a.phi - c.p.a0) - c.p.d * (c.b.w - c.a.w),
    ),
)
def _(q):
    k, d, a0 = q.numbers(k=4.0, d=0.3, a0=-0.2)
    q.add(planar.TorsionSpring("F", *q.pair(), stiffness=k, damping=d, free_angle=a0))


@case(
    "rotational spring with law",
    planar.TorsionSpring,
    conservative=False,
    loads=lambda c: opposite(
        c,
        np.zeros(2),
        c.a.r,
        c.b.r,
        -c.p.k * np.sin(c.b.phi - c.a.phi - c.p.a0) - c.p.d * (c.b.w - c.a.w) ** 3,
    ),
)
def _(q):
    k, d, a0 = q.numbers(k=4.0, d=0.3, a0=-0.2)
    q.add(
        planar.TorsionSpring(
            "F",
            *q.pair(),
            free_angle=a0,
            law=lambda extension, rate: k * sin(extension) + d * rate**3,
        )
    )


@case(
    "actuator",
    planar.Actuator,
    conservative=False,
    loads=_pull(lambda c, s, rate: -c.p.push * np.cos(4 * c.t) * (1 + c.a.w)),
)
def _(q):
    i, j = q.points()
    push = q.number("push", 6.0) * cos(4 * t) * (1 + i.body.angular_velocity)
    q.add(planar.Actuator("F", i, j, force=push))


@case(
    "hydraulic cylinder",
    planar.HydraulicCylinder,
    conservative=False,
    loads=_pull(lambda c, s, rate: c.p.rod * c.states[1] - c.p.area * c.states[0] + c.p.rub * rate),
)
def _(q):
    area, rod, rub, a, b = q.numbers(area=0.02, rod=0.01, rub=0.5, pa=150.0, pb=80.0)
    numbers = {"area": area, "rod_side_area": rod, "damping": rub, "start_a": a, "start_b": b}
    oil = {
        "supply": 300.0,
        "bulk_modulus": 1e3,
        "dead_volume": 1.0,
        "rated_flow": 1e-2,
        "rated_pressure": 100.0,
    }
    q.add(planar.HydraulicCylinder("F", *q.points(), 0.5 * cos(3 * t), **numbers, **oil))


def _bushing(c):
    # force on b at Q by the deflection in the axes of a; a feels the opposite at the same place
    between = Q(c) - P(c)
    opening = c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c))
    local, speed = turn(-c.a.phi, between), turn(-c.a.phi, opening)
    force = -np.array(
        [c.p.kx * local[0] + c.p.cx * speed[0], c.p.ky * local[1] + c.p.cy * speed[1]]
    )
    moment = -c.p.kr * (c.b.phi - c.a.phi) - c.p.cr * (c.b.w - c.a.w)
    return opposite(c, c.a.vector(force), Q(c), Q(c), moment)


@case("bushing", planar.Bushing, loads=_bushing)
def _(q):
    kx, ky, cx, cy, kr, cr = q.numbers(kx=40.0, ky=25.0, cx=1.0, cy=0.6, kr=3.0, cr=0.2)
    q.add(
        planar.Bushing(
            "F",
            *q.points(),
            stiffness=(kx, ky),
            damping=(cx, cy),
            rotational_stiffness=kr,
            rotational_damping=cr,
        )
    )
