"""What acts in joints and between frames: torsion springs, bushings, friction, motors."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from dalembert import cos, spatial, t
from spatial_registry.cases import case
from spatial_registry.twins import P, Q, angle_of, frame_i, frame_j, opposite


def _torsion(law):
    def loads(c):
        angle, rate, slope = angle_of(c)
        moment = c.p.k * (angle - c.p.a0) + c.p.d * rate + law(c, angle - c.p.a0)
        return opposite(np.zeros(3), c.b.r, -moment * slope)

    return loads


@case("torsion spring", spatial.TorsionSpring, loads=_torsion(lambda c, e: 0))
def _(q):
    k, d, a0 = q.number("k", 4.0), q.number("d", 0.3), q.number("a0", -0.2)
    q.add(spatial.TorsionSpring("F", *q.frames(), stiffness=k, damping=d, free_angle=a0))


@case(
    "torsion spring with law",
    spatial.TorsionSpring,
    conservative=False,
    loads=_torsion(lambda c, e: c.p.k3 * e**3),
)
def _(q):
    k, d, a0, k3 = (q.number(n, x) for n, x in {"k": 4, "d": 0.3, "a0": -0.2, "k3": 2}.items())
    arguments = {"stiffness": k, "damping": d, "free_angle": a0}
    q.add(spatial.TorsionSpring("F", *q.frames(), **arguments, law=lambda e, rate: k3 * e**3))


def _bushing(c):
    axes = frame_i(c)
    d = axes.T @ (Q(c) - P(c))
    rate = axes.T @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c)))
    x, y, z, w = Rotation.from_matrix(axes.T @ frame_j(c)).as_quat(canonical=True)
    by_spin = w * np.eye(3) - np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turning = by_spin @ axes.T @ (c.b.w - c.a.w)
    force = -(c.p.k * d + c.p.c * rate)
    moment = -by_spin.T @ (c.p.kr * 2 * np.array([x, y, z]) + c.p.cr * turning)
    return opposite(axes @ force, Q(c), axes @ moment)


@case("bushing", spatial.Bushing, loads=_bushing)
def _(q):
    q.add(
        spatial.Bushing(
            "F",
            *q.frames(),
            stiffness=q.vector("k", (40.0, 25.0, 30.0)),
            damping=q.vector("c", (1.0, 0.6, 0.8)),
            rotational_stiffness=q.vector("kr", (3.0, 2.0, 4.0)),
            rotational_damping=q.vector("cr", (0.2, 0.1, 0.3)),
        )
    )


def _friction(c):
    _, rate, slope = angle_of(c)
    moment = -(c.p.coulomb * np.tanh(rate / c.p.transition) + c.p.viscous * rate)
    return opposite(np.zeros(3), c.b.r, moment * slope)


@case("friction in hinge", spatial.JointFriction, loads=_friction)
def _(q):
    values = {"coulomb": 0.4, "viscous": 0.1, "transition": 0.8}
    arguments = {name: q.number(name, value) for name, value in values.items()}
    q.add(spatial.JointFriction("F", q.hinge(), **arguments))


def _bristles(c):
    _, rate, slope = angle_of(c)
    small = 1e-6 * c.p.slow
    size = np.sqrt(rate**2 + small**2) - small
    bending = rate - size / c.p.coulomb * c.states[0]
    moment = -(c.states[0] + c.p.damping * bending + c.p.viscous * rate)
    return opposite(np.zeros(3), c.b.r, moment * slope)


@case("bristles in hinge", spatial.BristleFriction, conservative=False, loads=_bristles)
def _(q):
    values = {"coulomb": 0.4, "damping": 0.3, "viscous": 0.1}
    arguments = {name: q.number(name, value) for name, value in values.items()}
    slow = q.number("slow", 0.8)
    friction = {"stiffness": 20.0, "stribeck_speed": slow, **arguments}
    q.add(spatial.BristleFriction("F", q.hinge(), **friction))


def _dc_motor(c):
    _, rate, slope = angle_of(c)
    moment = c.p.ratio * (c.p.constant * c.states[0] - c.p.rub * c.p.ratio * rate)
    return opposite(np.zeros(3), c.b.r, moment * slope)


@case("dc motor in hinge", spatial.DCMotor, conservative=False, loads=_dc_motor)
def _(q):
    values = {"constant": 0.3, "ratio": 2.0, "rub": 0.1, "current": 1.5}
    k, n, b, i = (q.number(name, value) for name, value in values.items())
    numbers = {"constant": k, "ratio": n, "damping": b, "start": i, "inductance": 0.1}
    q.add(spatial.DCMotor("F", q.hinge(), 3 * cos(4 * t), **numbers))


@case(
    "motor in hinge",
    spatial.JointActuator,
    conservative=False,
    loads=lambda c: opposite(np.zeros(3), c.b.r, c.p.m0 * np.cos(2 * c.t) * angle_of(c)[2]),
)
def _(q):
    q.add(spatial.JointActuator("F", q.hinge(), q.number("m0", 2.0) * cos(2 * t)))


@case(
    "ram in slider",
    spatial.JointActuator,
    conservative=False,
    loads=lambda c: opposite(c.p.push * frame_i(c)[:, 2], Q(c)),
)
def _(q):
    joint = q.add(spatial.Cylindrical("J", *q.frames()))
    q.add(spatial.JointActuator("F", joint, q.number("push", 6.0), motion="displacement"))
