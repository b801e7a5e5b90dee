"""What acts from a distance on only: stops, contacts, play, cables."""

from __future__ import annotations

import numpy as np
from twins import left, length

from dalembert import planar
from registry.cases import P, Q, case
from registry.forces import approach, opposite


def _stop(upper: bool):
    def loads(c):
        along, speed = approach(c)
        depth = length(Q(c) - P(c)) - c.p.limit if upper else c.p.limit - length(Q(c) - P(c))
        sense = 1 if upper else -1
        if np.real(depth) <= 0:
            return []
        press = c.p.k * depth**c.p.power * max(0.0, 1 + c.p.d * sense * speed)
        return opposite(c, -sense * press * along, P(c), Q(c))

    return loads


def _stopped(upper: bool):
    def build(q):
        i, j = q.points()
        gap = ((j.x - i.x) ** 2 + (j.y - i.y) ** 2) ** 0.5
        limit, k, d, power = q.numbers(limit=0.4 if upper else 1.4, k=80.0, d=0.5, power=1.5)
        q.add(
            planar.Stop(
                "F",
                gap,
                stiffness=k,
                damping=d,
                exponent=power,
                **{"upper" if upper else "lower": limit},
            )
        )

    return build


case("upper stop", planar.Stop, loads=_stop(True))(_stopped(True))
case("lower stop", planar.Stop, loads=_stop(False))(_stopped(False))


def _touch(c):
    """Discs about P and Q that press and rub, with creeping Coulomb friction."""
    along, _ = approach(c)
    depth = c.p.radius_i + c.p.radius_j - length(Q(c) - P(c))
    if np.real(depth) <= 0:
        return []
    place = P(c) + along * (c.p.radius_i - depth / 2)
    moved = c.b.velocity_at(place) - c.a.velocity_at(place)
    speed, slip = -along @ _approach_velocity(c), moved @ -left(along)
    factor = 1 + c.p.d * speed
    press = c.p.k * depth**c.p.power * (factor if np.real(factor) > 0 else 0.0)
    x = np.sqrt((slip / c.p.transition) ** 2 + 1e-12)
    bump = (c.p.static - c.p.dynamic) * x / (x**2 / 4 + 0.75) ** 2
    rub = press * (c.p.dynamic * np.tanh(4 * x) + bump) * slip / c.p.transition / x
    return opposite(c, press * along + rub * left(along), place, place)


def _approach_velocity(c):
    return c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c))


@case("contact", planar.Contact, loads=_touch)
def _(q):
    i, j = q.points()
    k, d, power = q.numbers(k=80.0, d=0.3, power=1.5)
    dynamic, static, transition = q.numbers(dynamic=0.3, static=0.5, transition=0.9)
    kit = planar.contact
    q.add(
        planar.Contact(
            "F",
            kit.Circle(i, q.number("radius_i", 0.7)),
            kit.Circle(j, q.number("radius_j", 0.5)),
            law=kit.HuntCrossley(stiffness=k, damping=d, exponent=power),
            friction=kit.Coulomb(dynamic, static, transition),
        )
    )


def _play(c):
    """A journal about Q in a bearing about P, with friction that falls."""
    along, rate = approach(c)
    depth = length(Q(c) - P(c)) - c.p.clearance
    if np.real(depth) <= 0:
        return []
    place = Q(c) + along * (c.p.radius - depth / 2)
    slip = (c.b.velocity_at(place) - c.a.velocity_at(place)) @ left(along)
    press = c.p.k * depth + c.p.d * rate
    press = press if np.real(press) > 0 else 0.0
    x = np.sqrt((slip / c.p.transition) ** 2 + 1e-12)
    falling = (c.p.static - c.p.dynamic) * np.exp(-((x * c.p.transition / c.p.fallen) ** 2))
    size = (c.p.dynamic + falling) * np.tanh(4 * x) + c.p.viscous * x * c.p.transition
    rub = press * size * slip / c.p.transition / x
    return opposite(c, -press * along - rub * left(along), place, place)


@case("clearance", planar.ClearanceRevolute, loads=_play)
def _(q):
    k, d = q.numbers(k=8.0, d=0.3)
    dynamic, static, transition = q.numbers(dynamic=0.3, static=0.5, transition=0.9)
    fallen, viscous = q.numbers(fallen=0.8, viscous=0.1)
    q.add(
        planar.ClearanceRevolute(
            "F",
            *q.points(),
            radius=q.number("radius", 0.5),
            clearance=q.number("clearance", 0.1),
            law=planar.contact.KelvinVoigt(stiffness=k, damping=d),
            friction=planar.contact.Stribeck(dynamic, static, transition, fallen, viscous),
        )
    )


def _hoist(c):
    """A cable from P over a point of the ground to Q."""
    via = np.array([c.p.V_x, c.p.V_y])
    parts = [(P(c) - via) / length(P(c) - via), (Q(c) - via) / length(Q(c) - via)]
    rate = parts[0] @ c.a.velocity_at(P(c)) + parts[1] @ c.b.velocity_at(Q(c))
    stretch = length(P(c) - via) + length(Q(c) - via) - c.p.rope
    pull = c.p.k * stretch + c.p.d * rate
    if np.real(stretch) <= 0 or np.real(pull) <= 0:
        return []
    return [("a", -pull * parts[0], P(c), 0.0), ("b", -pull * parts[1], Q(c), 0.0)]


@case("cable", planar.Cable, loads=_hoist, objective=False)
def _(q):
    i, j = q.points()
    via = q.point(q.ground, "V", 0.4, 0.9)
    rope, k, d = q.numbers(rope=0.6, k=80.0, d=0.3)
    q.add(planar.Cable("F", (i, via, j), length=rope, stiffness=k, damping=d))
