"""Friction and actuators in joints."""

from __future__ import annotations

import numpy as np

from dalembert import cos, planar, t
from registry.cases import CASES, P, Q, case
from registry.forces import opposite
from registry.joints import sliding_axis


def _friction(c, speed):
    return -(c.p.coulomb * np.tanh(speed / c.p.transition) + c.p.viscous * speed)


@case(
    "friction in revolute",
    planar.JointFriction,
    residual=lambda c: Q(c) - P(c),
    loads=lambda c: opposite(c, np.zeros(2), c.a.r, c.b.r, _friction(c, c.b.w - c.a.w)),
)
def _(q):
    joint = q.add(planar.Revolute("J", *q.points()))
    f, v, w = q.numbers(coulomb=0.4, viscous=0.1, transition=0.8)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))


def _sliding_friction(c):
    sliding = sliding_axis(c) @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c)))
    return opposite(c, _friction(c, sliding) * sliding_axis(c), Q(c), Q(c))


@case(
    "friction in slider",
    planar.JointFriction,
    residual=CASES["translational"].residual,
    loads=_sliding_friction,
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.Prismatic("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))
    f, v, w = q.numbers(coulomb=2.0, viscous=0.5, transition=0.8)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))


@case(
    "friction in slot",
    planar.JointFriction,
    residual=CASES["pin in slot"].residual,
    loads=lambda c: (
        _sliding_friction(c) + opposite(c, np.zeros(2), c.a.r, c.b.r, -c.p.spin * (c.b.w - c.a.w))
    ),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.PinInSlot("J", *q.points(), axis=axis))
    f, v, w, spin = q.numbers(coulomb=2.0, viscous=0.5, transition=0.8, spin=0.3)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))
    q.add(planar.JointFriction("G", joint, viscous=spin, motion="angle"))


@case(
    "actuator in slider",
    planar.JointActuator,
    residual=CASES["translational"].residual,
    conservative=False,
    loads=lambda c: opposite(c, c.p.push * np.cos(4 * c.t) * sliding_axis(c), Q(c), Q(c)),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.Prismatic("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))
    q.add(planar.JointActuator("F", joint, q.number("push", 6.0) * cos(4 * t)))


@case(
    "motor in slot",
    planar.JointActuator,
    residual=CASES["pin in slot"].residual,
    conservative=False,
    loads=lambda c: opposite(c, np.zeros(2), c.a.r, c.b.r, c.p.m0 * (1 - c.b.w / c.p.w0)),
)
def _(q):
    joint = q.add(planar.PinInSlot("J", *q.points(), axis=q.numbers(axis_x=1.2, axis_y=0.9)))
    m0, w0 = q.numbers(m0=2.0, w0=5.0)
    value = m0 * (1 - joint.point_j.body.angular_velocity / w0)
    q.add(planar.JointActuator("F", joint, value, motion="angle"))


def _bristles(c):
    speed = c.b.w - c.a.w
    decay = np.exp(-((speed / c.p.slow) ** 2))
    small = 1e-6 * c.p.slow
    size = np.sqrt(speed**2 + small**2) - small
    bending = speed - size / (c.p.coulomb + c.p.excess * decay) * c.states[0]
    moment = -(c.states[0] + c.p.damping * bending + c.p.viscous * speed)
    return opposite(c, np.zeros(2), c.a.r, c.b.r, moment)


@case(
    "bristles in revolute",
    planar.BristleFriction,
    residual=lambda c: Q(c) - P(c),
    conservative=False,
    loads=_bristles,
)
def _(q):
    joint = q.add(planar.Revolute("J", *q.points()))
    f, more, c, v, w = q.numbers(coulomb=0.4, excess=0.2, damping=0.3, viscous=0.1, slow=0.8)
    numbers = {"coulomb": f, "static": f + more, "stiffness": 20.0, "damping": c, "viscous": v}
    q.add(planar.BristleFriction("F", joint, **numbers, stribeck_speed=w))


@case(
    "dc motor in revolute",
    planar.DCMotor,
    residual=lambda c: Q(c) - P(c),
    conservative=False,
    loads=lambda c: opposite(
        c,
        np.zeros(2),
        c.a.r,
        c.b.r,
        c.p.ratio * (c.p.constant * c.states[0] - c.p.rub * c.p.ratio * (c.b.w - c.a.w)),
    ),
)
def _(q):
    joint = q.add(planar.Revolute("J", *q.points()))
    k, n, b, i = q.numbers(constant=0.3, ratio=2.0, rub=0.1, current=1.5)
    numbers = {"constant": k, "ratio": n, "damping": b, "start": i, "inductance": 0.1}
    q.add(planar.DCMotor("F", joint, 3 * cos(4 * t), **numbers))
