"""What acts from a distance on only: stops, contacts, play, cables."""

from __future__ import annotations

import numpy as np

from dalembert import spatial
from spatial_registry.cases import case
from spatial_registry.twins import P, Q, angle_of, approach, opposite


def _stop(c):
    along, speed = approach(c)
    depth = np.linalg.norm(Q(c) - P(c)) - c.p.limit
    if depth <= 0:
        return []
    press = c.p.k * depth**c.p.power * max(0.0, 1 + c.p.d * speed)
    return opposite(-press * along, Q(c))


@case("stop", spatial.Stop, loads=_stop)
def _(q):
    i, j = q.points()
    gap = sum((getattr(j, s) - getattr(i, s)) ** 2 for s in "xyz") ** 0.5
    k, d, power = q.number("k", 80.0), q.number("d", 0.5), q.number("power", 1.5)
    limit = q.number("limit", 0.3)
    q.add(spatial.Stop("F", gap, upper=limit, stiffness=k, damping=d, exponent=power))


def _end(c):
    angle, rate, slope = angle_of(c)
    depth = angle - c.p.limit
    press = c.p.k * depth * max(0.0, 1 + c.p.d * rate) if depth > 0 else 0.0
    return opposite(np.zeros(3), c.b.r, -press * slope)


@case("stop in hinge", spatial.Stop, loads=_end)
def _(q):
    q.hinge()
    k, d, limit = q.number("k", 80.0), q.number("d", 0.5), q.number("limit", -0.4)
    q.add(spatial.Stop("F", q.system.formula("J.angle"), upper=limit, stiffness=k, damping=d))


def _touch(c):
    """Balls about P and Q that press and rub, with creeping Coulomb friction."""
    along, rate = approach(c)
    depth = c.p.radius_i + c.p.radius_j - np.linalg.norm(Q(c) - P(c))
    if depth <= 0:
        return []
    place = P(c) + along * (c.p.radius_i - depth / 2)
    moved = c.b.velocity_at(place) - c.a.velocity_at(place)
    slip = moved - (moved @ along) * along
    press = c.p.k * depth**c.p.power * max(0.0, 1 - c.p.d * rate)
    x = np.sqrt(slip @ slip / c.p.transition**2 + 1e-12)
    rub = press * c.p.dynamic * np.tanh(4 * x) * slip / c.p.transition / x
    return opposite(press * along - rub, place)


@case("contact", spatial.Contact, loads=_touch)
def _(q):
    (i, j), kit = q.points(), spatial.contact
    k, d, power = q.number("k", 80.0), q.number("d", 0.3), q.number("power", 1.5)
    law = kit.HuntCrossley(stiffness=k, damping=d, exponent=power)
    friction = kit.Coulomb(q.number("dynamic", 0.3), slip_speed=q.number("transition", 0.9))
    balls = (kit.Sphere(i, q.number("radius_i", 0.5)), kit.Sphere(j, q.number("radius_j", 0.4)))
    q.add(spatial.Contact("F", *balls, law=law, friction=friction))


def _play(c):
    """A ball about Q in a socket about P."""
    along, rate = approach(c)
    depth = np.linalg.norm(Q(c) - P(c)) - c.p.clearance
    press = max(0.0, c.p.k * depth + c.p.d * rate) if depth > 0 else 0.0
    return opposite(-press * along, Q(c))


@case("clearance", spatial.ClearanceSpherical, loads=_play)
def _(q):
    law = spatial.contact.KelvinVoigt(stiffness=q.number("k", 20.0), damping=q.number("d", 0.8))
    sizes = {"radius": q.number("radius", 0.5), "clearance": q.number("clearance", 0.1)}
    q.add(spatial.ClearanceSpherical("F", *q.points(), law=law, **sizes))


def _hoist(c):
    """A cable from P over a point of the ground to Q."""
    away = [P(c) - c.p.V, Q(c) - c.p.V]
    sizes = [np.linalg.norm(part) for part in away]
    parts = [part / size for part, size in zip(away, sizes, strict=True)]
    rate = parts[0] @ c.a.velocity_at(P(c)) + parts[1] @ c.b.velocity_at(Q(c))
    stretch = sum(sizes) - c.p.rope
    pull = max(0.0, c.p.k * stretch + c.p.d * rate) if stretch > 0 else 0.0
    nothing = np.zeros(3)
    return [("a", -pull * parts[0], P(c), nothing), ("b", -pull * parts[1], Q(c), nothing)]


@case("cable", spatial.Cable, loads=_hoist)
def _(q):
    (i, j), via = q.points(), q.system.ground.point(*q.vector("V", (0.4, 0.9, 0.2)))
    rope, k, d = q.number("rope", 0.6), q.number("k", 80.0), q.number("d", 0.3)
    q.add(spatial.Cable("F", (i, via, j), length=rope, stiffness=k, damping=d))
