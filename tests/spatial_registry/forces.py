"""Bodies, and forces, torques and springs between points."""

from __future__ import annotations

import functools

import numpy as np

from dalembert import cos, spatial, t
from spatial_registry.cases import case
from spatial_registry.twins import P, Q, approach, opposite


@case(
    "bodies",
    *(spatial.Body, spatial.Particle, spatial.Box, spatial.Cylinder, spatial.Sphere),
    *(spatial.Capsule, spatial.Bar),
)
def _(q):
    q.body("a", (0.3, -0.2, 0.1), (0.4, -0.3, 0.6), (0.5, -0.3, 0.2), (0.7, -0.4, 0.3))
    place, turn, speed, spin = (1.0, 0.3, 0.1), (0.1, 0.7, -0.2), (0.1, 0.2, 0.3), (0.3, 1.0, 0.2)
    free = functools.partial(q.solid, place=place, turn=turn, velocity=speed, spin=spin)
    rho = q.number("density", 1.4)
    free("box", kind=spatial.Box, size=q.vector("box", (0.5, 0.8, 0.7)), density=rho)
    sizes = {"radius": q.number("drum_radius", 0.4), "length": q.number("drum_length", 0.6)}
    bore = q.number("bore", 0.1)
    free("drum", kind=spatial.Cylinder, inner_radius=bore, density=rho, **sizes)
    free("ball", kind=spatial.Sphere, radius=q.number("ball_radius", 0.5), density=rho)
    sizes = {"radius": q.number("pill_radius", 0.4), "length": q.number("pill_length", 0.6)}
    free("pill", kind=spatial.Capsule, mass=q.number("pill_m", 0.9), **sizes)
    sizes = {"radius": q.number("rod_radius", 0.2), "length": q.number("rod_length", 1.1)}
    free("rod", kind=spatial.Bar, mass=q.number("rod_m", 0.9), **sizes)
    free("dot", kind=spatial.Particle, mass=q.number("dot_m", 0.7))


@case(
    "force",
    spatial.Force,
    conservative=False,
    loads=lambda c: [("a", c.p.F * [np.cos(3 * c.t), c.b.at((0, 0, 0))[0], 1], P(c), np.zeros(3))],
)
def _(q):
    i, j = q.points()
    x, y, z = q.vector("F", (3.0, -2.0, 1.0))
    q.add(spatial.Force("F", i, (x * cos(3 * t), y * j.body.x, z)))


@case(
    "following force",
    spatial.Force,
    conservative=False,
    loads=lambda c: [("a", c.b.R @ c.p.F, P(c), np.zeros(3))],
)
def _(q):
    i, j = q.points()
    q.add(spatial.Force("F", i, q.vector("F", (3.0, -2.0, 1.0)), follows=j.body))


@case(
    "torque",
    spatial.Torque,
    conservative=False,
    loads=lambda c: [("a", np.zeros(3), c.a.r, c.p.M * np.cos(2 * c.t) - c.p.drag * c.a.w)],
)
def _(q):
    a, _ = q.pair()
    drag, whole = q.number("drag", 0.3), q.vector("M", (0.7, -0.5, 0.9))
    spin = a.angular_velocity
    components = [m * cos(2 * t) - drag * spin[k] for k, m in enumerate(whole)]
    q.add(spatial.Torque("F", a, components))


@case(
    "torque with reaction",
    spatial.Torque,
    conservative=False,
    loads=lambda c: opposite(np.zeros(3), c.b.r, c.a.R @ c.p.M),
)
def _(q):
    a, b = q.pair()
    q.add(spatial.Torque("F", b, q.vector("M", (0.7, -0.5, 0.9)), reaction_on=a, follows=a))


def _tension(c):
    along, speed = approach(c)
    pull = c.p.k * (np.linalg.norm(Q(c) - P(c)) - c.p.l0) + c.p.d * speed
    return opposite(-pull * along, Q(c))


@case("spring", spatial.Spring, loads=_tension)
def _(q):
    k, d, l0 = q.number("k", 30.0), q.number("d", 1.5), q.number("l0", 0.5)
    q.add(spatial.Spring("F", *q.points(), stiffness=k, damping=d, free_length=l0))


@case(
    "hydraulic cylinder",
    spatial.HydraulicCylinder,
    conservative=False,
    loads=lambda c: opposite(
        (c.p.area * c.states[0] - c.p.rod * c.states[1] - c.p.rub * approach(c)[1])
        * approach(c)[0],
        Q(c),
    ),
)
def _(q):
    values = {"area": 0.02, "rod": 0.01, "rub": 0.5, "pa": 150.0, "pb": 80.0}
    area, rod, rub, a, b = (q.number(n, x) for n, x in values.items())
    numbers = {"area": area, "rod_side_area": rod, "damping": rub, "start_a": a, "start_b": b}
    oil = {
        "supply": 300.0,
        "bulk_modulus": 1e3,
        "dead_volume": 1.0,
        "rated_flow": 1e-2,
        "rated_pressure": 100.0,
    }
    q.add(spatial.HydraulicCylinder("F", *q.points(), 0.5 * cos(3 * t), **numbers, **oil))


@case(
    "actuator",
    spatial.Actuator,
    conservative=False,
    loads=lambda c: opposite(c.p.push * np.cos(4 * c.t) * approach(c)[0], Q(c)),
)
def _(q):
    q.add(spatial.Actuator("F", *q.points(), force=q.number("push", 6.0) * cos(4 * t)))
