"""Mechanisms with modes of different kinds, for tests of their pages."""

from __future__ import annotations

import dalembert as da
from dalembert import planar, spatial


def carts() -> da.Model:
    """Three carts between walls; strong dampers overdamp the highest mode."""
    system = da.System("carts")
    stiffness = system.parameter("stiffness", 400.0, "N/m", bounds=(100.0, 1000.0))
    damping = system.parameter("damping", 2.0, "N s/m", bounds=(0.0, 50.0))
    mass = system.parameter("mass", 1.0, "kg", bounds=(0.5, 3.0))
    points = [system.ground.point(0, 0)]
    for k in range(3):
        place = {"position": (0.5 * (k + 1), 0.0)}
        cart = system.add(planar.Body(f"cart{k + 1}", mass=mass, inertia=0.01, **place))
        system.add(planar.Prismatic(f"rail{k + 1}", system.ground.point(0, 0), cart.center))
        points.append(cart.center)
    points.append(system.ground.point(2.0, 0))
    law = {"stiffness": stiffness, "damping": damping, "free_length": 0.5}
    for k in range(4):
        system.add(planar.Spring(f"spring{k + 1}", points[k], points[k + 1], **law))
    return system.build()


def double_pendulum(damping: float = 0.05) -> da.Model:
    """Two bars with a damper between them."""
    system = da.System("double pendulum", gravity=(0.0, -9.81))
    first = system.parameter("first", 1.0, "m", bounds=(0.5, 2.0))
    second = system.parameter("second", 0.8, "m", bounds=(0.3, 2.0))
    upper = system.add(planar.Bar("upper", length=first, mass=1.0, angle=-1.5))
    lower = system.add(planar.Bar("lower", length=second, mass=2.0, angle=-1.6))
    system.add(planar.Revolute("O", system.ground.center, upper.start))
    system.add(planar.Revolute("A", upper.end, lower.start))
    system.add(planar.TorsionSpring("damper", upper, lower, stiffness=0.0, damping=damping))
    return system.build()


def suspended_body() -> da.Model:
    """Spatial pendulum with a rotational spring."""
    system = da.System("suspended body", gravity=(0.0, 0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    width = system.parameter("width", 0.3, "m", bounds=(0.1, 0.4))
    inertia = (0.1, 0.1 + width**2, 0.2)
    body = system.add(spatial.Body("body", mass=2.0, inertia=inertia, position=(0, 0, -1)))
    pivot = system.ground.frame((0, 0, 0), axis=(1, 0, 0))
    system.add(spatial.Universal("O", pivot, body.frame((0, 0, length), axis=(0, 1, 0))))
    return system.build()


def spinning_rotor() -> da.Model:
    """Disc about a fixed point that spins on bearings of different stiffness."""
    system = da.System("spinning rotor", gravity=(0.0, 0.0, 0.0))
    spin = system.parameter("spin", 50.0, "rad/s", bounds=(0.0, 100.0))
    stiffness = system.parameter("stiffness", 500.0, "N/m", bounds=(200.0, 1000.0))
    start = {"mass": 2.0, "inertia": (0.02, 0.02, 0.035), "angular_velocity": (0, 0, spin)}
    disc = system.add(spatial.Body("disc", **start))
    system.add(spatial.Spherical("pivot", system.ground.frame((0, 0, 0)), disc.frame((0, 0, 0))))
    tip = disc.point(0, 0, 0.3)
    system.add(spatial.Force("bearing", tip, (-stiffness * tip.x, -900 * tip.y, 0)))
    return system.build()
