"""What moves by a law of time."""

from __future__ import annotations

import numpy as np
from twins import length

from dalembert import planar
from dalembert.elements.laws import (
    Harmonic,
)
from registry.cases import CASES, P, Q, case
from registry.joints import sliding_axis
from registry.motion_laws import LAWS, LawCase


def _driven_turn(law: LawCase):
    def build(q):
        q.add(planar.RotationalDriver("J", *q.pair(), law.make(q)))

    return build


for _name, _law in LAWS.items():
    case(
        f"rotational driver {_name}",
        planar.RotationalDriver,
        _law.kind,
        scleronomic=False,
        residual=lambda c, law=_law: c.b.phi - c.a.phi - law.twin(c.p, c.t),
    )(_driven_turn(_law))


def _wave(q, mean: float):
    return Harmonic(*q.numbers(amplitude=0.2, frequency=3.0, mean=mean, phase=0.5))


@case(
    "translational driver",
    planar.TranslationalDriver,
    scleronomic=False,
    residual=lambda c: sliding_axis(c) @ (Q(c) - P(c)) - LAWS["Harmonic"].twin(c.p, c.t),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    q.add(planar.TranslationalDriver("J", *q.points(), axis=axis, law=_wave(q, 0.3)))


def _slot(q) -> planar.PinInSlot:
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    return q.add(planar.PinInSlot("J", *q.points(), axis=axis))


def _with_slot(equation):
    """Twin of a slot and of a driver of it."""
    return lambda c: np.array([CASES["pin in slot"].residual(c), equation(c)])


@case(
    "rotational driver of a joint",
    planar.RotationalDriver,
    scleronomic=False,
    residual=_with_slot(lambda c: c.b.phi - c.a.phi - LAWS["Harmonic"].twin(c.p, c.t)),
)
def _(q):
    q.add(planar.RotationalDriver("D", _slot(q), _wave(q, 0.3)))


@case(
    "translational driver of a joint",
    planar.TranslationalDriver,
    scleronomic=False,
    residual=_with_slot(
        lambda c: sliding_axis(c) @ (Q(c) - P(c)) - LAWS["Harmonic"].twin(c.p, c.t)
    ),
)
def _(q):
    q.add(planar.TranslationalDriver("D", _slot(q), _wave(q, 0.3)))


@case(
    "distance driver",
    planar.DistanceDriver,
    scleronomic=False,
    residual=lambda c: length(Q(c) - P(c)) - LAWS["Harmonic"].twin(c.p, c.t),
)
def _(q):
    q.add(planar.DistanceDriver("J", *q.points(), _wave(q, 0.8)))


@case(
    "coordinate driver",
    planar.CoordinateDriver,
    scleronomic=False,
    objective=False,
    residual=lambda c: (
        np.array([c.p.to_x, c.p.to_y])
        @ c.a.at((c.p.P_x, c.p.P_y))
        / np.sqrt(c.p.to_x**2 + c.p.to_y**2)
        - LAWS["Harmonic"].twin(c.p, c.t)
    ),
)
def _(q):
    a, _ = q.pair()
    point = q.point(a, "P", 0.31, 0.12)
    q.add(
        planar.CoordinateDriver("J", point, _wave(q, 0.3), direction=q.numbers(to_x=0.6, to_y=1.1))
    )
